/// @file kuwabara_kono.h  Viscoelastic spheres (Kuwabara and Kono 1987; Brilliantov, Spahn, Hertzsch and Poeschel
/// 1996). Damping follows from the material: restitution is 1 for slow impacts and falls with v^(1/5) (case A07). The
/// scene's `restitution` is not used; the relaxation time is required instead.
#pragma once
#include "laws/smooth/hertz.h"

namespace epafi {

/// N = max(0, k delta^(3/2) + 3/2 A k sqrt(delta) delta_dot), k = 4/3 E* sqrt(R*)
struct KuwabaraKono {
  static constexpr const char* name = "kuwabara-kono";
  static constexpr Needs needs{.curvature = true};
  static constexpr bool is_hertzian = true;
  static constexpr bool uses_restitution = false;
  template <class Real>
  struct ParametersOf {
    Real modulus;     ///< E* of the pair [Pa], > 0
    Real relaxation;  ///< A [s], >= 0
  };
  using Parameters = ParametersOf<double>;

  static Entry entry() {
    return {name,
            "viscoelastic spheres: restitution falls with the impact speed",
            {{"relaxation_time", "A", "s", Kind::number, {}, not_negative, "dissipative constant of the material"}},
            needs,
            "Kuwabara and Kono 1987; Brilliantov et al. 1996"};
  }
  static Missing missing(const MaterialPair& pair) {
    Missing out = missing_elasticity(pair);
    if (!pair.parameters.has("relaxation_time"))
      out.push_back("relaxation_time [s] of the contact (it stands in for restitution, which depends on the speed)");
    return out;
  }
  static Parameters parameters(const MaterialPair& pair) {
    return {pair.effective_modulus(), pair.parameters.number("relaxation_time")};
  }
  static bool is_damped(const Parameters& p) { return p.relaxation > 0.0; }
  static double elastic_power(const Parameters&) { return 1.5; }
  static constexpr double growth = 0.5;  ///< q of c ~ overlap^q
  template <class Real>
  EPAFI_LANES static ResponseOf<Real> respond(const ParametersOf<Real>& p, const KinematicsOf<Real>& c) {
    const Real stiffness = hertz_stiffness(p.modulus, c), elastic = 2.0 / 3.0 * stiffness * c.overlap;
    return hertz_response<Real>(c, stiffness, elastic, p.relaxation * stiffness, growth);
  }
};
static_assert(LaneLaw<KuwabaraKono>);

}  // namespace epafi
