/// @file polach.h  Polach's closed form (1999, 2005) for large creepage. With kA = kS = 1 and no spin it equals
/// converged FASTSIM on the elliptic bound. The spin part follows Polach 1999; published transcriptions of it differ:
/// flagged with spin.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

#include "laws/wheel_rail/rolling.h"
#include "laws/wheel_rail/tangential/kalker_table.h"

namespace epafi {

/// Reduction factors of the stiffness in the stick and slip zones; 0 < kS <= kA <= 1. Friction that falls with slip
/// velocity w: mu = mu0 ((1 - A) exp(-B w) + A); dry rail kA = 1, kS = 0.4, A = 0.4, B = 0.6 s/m (Polach 2005).
struct PolachFactors {
  double stick = 1.0;  ///< kA
  double slip = 1.0;   ///< kS
};

inline double falling_friction(double static_friction, double ratio, double decay, double slip_velocity) {
  return static_friction * ((1.0 - ratio) * std::exp(-decay * slip_velocity) + ratio);
}

/// Lateral force of pure spin over mu N, for creepage share phi / nu_c taken by the caller (Polach 1999, eqs. 9 to 14).
inline double polach_spin_share(const RollingCase& c, const KalkerCoefficients& k, double lateral_with_spin) {
  const double a = c.ellipse.a, b = c.ellipse.b, bound = c.bound();
  const double form = 1.0 + 6.3 * (1.0 - std::exp(-a / b));
  const double eps =
      8.0 / 3.0 * c.elastic.shear_modulus * b * std::sqrt(a * b) / bound * k.c23 * std::abs(lateral_with_spin) / form;
  const double d = (eps * eps - 1.0) / (eps * eps + 1.0);
  const double KM = eps * (d * d * d / 3.0 - d * d / 2.0 + 1.0 / 6.0) - std::pow(1.0 - d * d, 1.5) / 3.0;
  return 9.0 / 16.0 * a * KM * form;
}

inline PatchForce polach(const RollingCase& c, const PolachFactors& factors = {}) {
  using std::numbers::pi;
  const KalkerCoefficients k = kalker_coefficients(c.ellipse.a / c.ellipse.b, c.elastic.poissons_ratio);
  const Creepage& s = c.creepage;
  const double bound = c.bound();
  if (!(bound > 0.0)) return {};
  const double with_spin = s.lateral + s.spin * c.ellipse.a;
  const double lateral = std::abs(with_spin) > std::abs(s.lateral) ? with_spin : s.lateral;
  const double creep = std::hypot(s.longitudinal, s.lateral), corrected = std::hypot(s.longitudinal, lateral);
  if (!(corrected > 0.0)) return {};
  // c_j of the translational creepage; of pure spin the lateral one
  const double cj = creep > 0.0 ? std::hypot(k.c11 * s.longitudinal, k.c22 * s.lateral) / creep : k.c22;
  const double eps = 0.25 * pi * c.elastic.shear_modulus * c.ellipse.a * c.ellipse.b * cj * creep / bound;
  const double eA = factors.stick * eps, eS = factors.slip * eps;
  const double F = 2.0 * bound / pi * (eA / (1.0 + eA * eA) + std::atan(eS));
  const double spin_force = s.spin != 0.0 ? polach_spin_share(c, k, lateral) * bound * s.spin / corrected : 0.0;
  return {-F * s.longitudinal / corrected, -F * s.lateral / corrected + spin_force, 0.0};
}

}  // namespace epafi
