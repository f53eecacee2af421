/// @file hertz.h  Normal law of Hertz (1882) with the damping of Tsuji et al. (1992), never pulling.
/// Restitution is independent of speed, mass and modulus. Valid for small contact area, delta << R*; overlap beyond
/// a few percent of R* is outside the theory.
#pragma once
#include <algorithm>
#include <cmath>

#include "laws/smooth/hertz_spring.h"
#include "laws/smooth/restitution.h"

namespace epafi {

/// Elastic constants every Hertzian law needs.
inline Missing missing_elasticity(const MaterialPair& pair) {
  Missing out;
  for (const Material* m : {&pair.a, &pair.b}) {
    if (std::isnan(m->youngs_modulus)) out.push_back("youngs_modulus [Pa] of material '" + m->name + "'");
    if (std::isnan(m->poissons_ratio) && !m->is_rigid()) out.push_back("poissons_ratio of material '" + m->name + "'");
  }
  if (pair.a.is_rigid() && pair.b.is_rigid())
    out.push_back("a finite youngs_modulus of '" + pair.a.name + "' or '" + pair.b.name + "' (both are rigid)");
  return out;
}

/// N = 4/3 E* sqrt(R*) delta^(3/2) + alpha sqrt(m* k) delta^(1/4) delta_dot, k = 4/3 E* sqrt(R*), alpha = sqrt(5) zeta
struct Hertz {
  static constexpr const char* name = "hertz";
  static constexpr Needs needs{.curvature = true};
  static constexpr bool is_hertzian = true;
  template <class Real>
  struct ParametersOf {
    Real modulus;  ///< E* of the pair [Pa], > 0
    Real damping;  ///< 2 sqrt(5/6) zeta [-]: the viscous force is damping sqrt(m* k_n) delta_dot
  };
  using Parameters = ParametersOf<double>;

  static Entry entry() {
    return {name,
            "Hertz with Tsuji damping, never pulls",
            {},
            needs,
            "Hertz 1882; Tsuji, Tanaka and Ishida 1992; damping by Schwager and Poeschel 2007"};
  }
  static Missing missing(const MaterialPair& pair) { return missing_elasticity(pair); }
  static Parameters parameters(const MaterialPair& pair) {
    return {pair.effective_modulus(), 2.0 * std::sqrt(5.0 / 6.0) * damping_ratio_for(pair.restitution)};
  }
  static bool is_damped(const Parameters& p) { return p.damping > 0.0; }
  static double elastic_power(const Parameters&) { return 1.5; }
  static constexpr double growth = 0.25;                                      ///< q of c ~ overlap^q
  static double stiffness(const Parameters& p, const ContactKinematics& c) {  // dN/d(delta)
    return hertz_stiffness(p.modulus, c);
  }
  template <class Real>
  EPAFI_LANES static ResponseOf<Real> respond(const ParametersOf<Real>& p, const KinematicsOf<Real>& c) {
    const Real stiffness = hertz_stiffness(p.modulus, c), elastic = 2.0 / 3.0 * stiffness * c.overlap;
    return hertz_response<Real>(c, stiffness, elastic, p.damping * sqrt(c.effective_mass * stiffness), growth);
  }
};
static_assert(LaneLaw<Hertz>);

}  // namespace epafi
