/// @file linear.h  Linear spring and dashpot in the normal direction (Cundall and Strack 1979) that never pulls.
/// Contact time is independent of impact speed. The stiffness is a number of the scene, not of the material.
#pragma once
#include <algorithm>
#include <cmath>

#include "laws/contact_law.h"
#include "laws/smooth/restitution.h"

namespace epafi {

/// N = max(0, k delta + 2 zeta sqrt(m* k) delta_dot), zeta from the restitution
struct Linear {
  static constexpr const char* name = "linear";
  static constexpr Needs needs{};
  static constexpr bool is_hertzian = false;
  template <class Real>
  struct ParametersOf {
    Real stiffness;      ///< k [N/m], > 0
    Real damping_ratio;  ///< zeta [-], >= 0; 0 is elastic
  };
  using Parameters = ParametersOf<double>;

  static Entry entry() {
    return {name,
            "linear spring and dashpot, never pulls",
            {{"stiffness", "k_n", "N/m", Kind::number, {}, positive, "normal stiffness of the contact"}},
            needs,
            "Cundall and Strack 1979; damping by Schwager and Poeschel 2007"};
  }
  static Missing missing(const MaterialPair& pair) {
    return pair.parameters.has("stiffness") ? Missing{} : Missing{"stiffness [N/m] of the contact"};
  }
  static Parameters parameters(const MaterialPair& pair) {
    return {pair.parameters.number("stiffness"), damping_ratio_for(pair.restitution)};
  }
  static bool is_damped(const Parameters& p) { return p.damping_ratio > 0.0; }
  static double elastic_power(const Parameters&) { return 1.0; }
  template <class Real>
  EPAFI_LANES static ResponseOf<Real> respond(const ParametersOf<Real>& p, const KinematicsOf<Real>& c) {
    const Real elastic = p.stiffness * c.overlap;
    const Real dashpot = 2.0 * p.damping_ratio * sqrt(c.effective_mass * p.stiffness);
    const Real force = max(Real{}, elastic + c.viscous(dashpot, p.stiffness, Real{}));
    return {.force = force,
            .elastic_force = elastic,
            .stiffness = p.stiffness,
            .energy = 0.5 * elastic * c.overlap,
            .dashpot = dashpot};
  }
};
static_assert(LaneLaw<Linear>);

}  // namespace epafi
