/// @file hunt_crossley.h  Hertz with damping proportional to the elastic force (Hunt and Crossley 1975).
/// The force starts and ends at zero without a jump. Its restitution falls with the impact speed: the one the scene
/// asks for comes out exactly at `reference_speed`, more below, less above.
#pragma once
#include "laws/smooth/hertz.h"

namespace epafi {

/// N = 4/3 E* sqrt(R*) delta^(3/2) (1 + chi delta_dot), chi = X(e) / reference_speed
struct HuntCrossley {
  static constexpr const char* name = "hunt-crossley";
  static constexpr Needs needs{.curvature = true};
  static constexpr bool is_hertzian = true;
  struct Parameters {
    double modulus;  ///< E* of the pair [Pa], > 0
    double chi;      ///< [s/m], >= 0
  };

  static Entry entry() {
    return {name, "Hertz with damping proportional to the elastic force",
            {{"reference_speed", "v_0", "m/s", Kind::number, {}, positive,
              "impact speed at which the restitution asked for comes out; it is larger below and smaller above"}},
            needs, "Hunt and Crossley 1975; factor by Gonthier et al. 2004, Zhang and Sharf 2009"};
  }
  static Missing missing(const MaterialPair& pair) {
    Missing out = missing_elasticity(pair);
    if (!pair.parameters.has("reference_speed"))
      out.push_back("reference_speed [m/s] of the contact (the restitution of this law depends on the impact speed)");
    return out;
  }
  static Parameters parameters(const MaterialPair& pair) {
    return {pair.effective_modulus(),
            hunt_crossley_factor(pair.restitution) / pair.parameters.number("reference_speed")};
  }
  static bool is_damped(const Parameters& p) { return p.chi > 0.0; }
  static NormalResponse respond(const Parameters& p, const ContactKinematics& c) {
    const double stiffness = 2.0 * p.modulus * std::sqrt(c.effective_radius * c.overlap);
    const double elastic = 2.0 / 3.0 * stiffness * c.overlap;
    return {std::max(0.0, elastic + elastic * p.chi * c.approach_velocity), elastic, stiffness, 0.4 * elastic * c.overlap};
  }
};
static_assert(NormalLaw<HuntCrossley>);

}  // namespace epafi
