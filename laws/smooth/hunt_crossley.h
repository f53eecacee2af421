/// @file hunt_crossley.h  Hertz with damping proportional to the elastic force (Hunt and Crossley 1975), and its
/// family: published factors that answer the same force differently. The force starts and ends at zero without a jump.
/// Restitution falls with the impact speed: the given value holds at `reference_speed`, more below, less above.
/// Only "hunt-crossley" inverts the exact relation; the others are approximations kept for comparison: they return
/// their own restitution (hunt_crossley_restitution), said by `check`.
#pragma once
#include "laws/smooth/hertz.h"

namespace epafi {

/// N = 4/3 E* sqrt(R*) delta^(3/2) (1 + chi delta_dot), chi = X(e) / reference_speed
struct HuntCrossley {
  static constexpr const char* name = "hunt-crossley";
  static constexpr Needs needs{.curvature = true};
  static constexpr bool is_hertzian = true;
  template <class Real>
  struct ParametersOf {
    Real modulus;  ///< E* of the pair [Pa], > 0
    Real chi;      ///< [s/m], >= 0
  };
  using Parameters = ParametersOf<double>;

  static Entry entry_of(const char* name, const char* summary, const char* source) {
    return {name,
            summary,
            {{"reference_speed",
              "v_0",
              "m/s",
              Kind::number,
              {},
              positive,
              "impact speed at which the restitution holds; it is larger below and smaller above"}},
            needs,
            source};
  }
  static Entry entry() {
    return entry_of(name, "Hertz with damping proportional to the elastic force, exact restitution",
                    "Hunt and Crossley 1975; factor by Gonthier et al. 2004, Zhang and Sharf 2009");
  }
  static Missing missing(const MaterialPair& pair) {
    Missing out = missing_elasticity(pair);
    if (!pair.parameters.has("reference_speed"))
      out.push_back("reference_speed [m/s] of the contact (the restitution of this law depends on the impact speed)");
    return out;
  }
  static Parameters parameters_of(const MaterialPair& pair, double factor) {
    return {pair.effective_modulus(), factor / pair.parameters.number("reference_speed")};
  }
  static double factor(double e) { return hunt_crossley_factor(e); }
  static Parameters parameters(const MaterialPair& pair) { return parameters_of(pair, factor(pair.restitution)); }
  static bool is_damped(const Parameters& p) { return p.chi > 0.0; }
  static double elastic_power(const Parameters&) { return 1.5; }
  static constexpr double growth = 1.5;  ///< q of c ~ overlap^q
  template <class Real>
  EPAFI_LANES static ResponseOf<Real> respond(const ParametersOf<Real>& p, const KinematicsOf<Real>& c) {
    const Real stiffness = hertz_stiffness(p.modulus, c), elastic = 2.0 / 3.0 * stiffness * c.overlap;
    return hertz_response<Real>(c, stiffness, elastic, elastic * p.chi, growth);
  }
};
static_assert(LaneLaw<HuntCrossley>);

/// A member of the family: the same force, its own factor X(e) = chi v0.
template <class Member>
struct HuntCrossleyFamily : HuntCrossley {
  using Loop = HuntCrossley;  ///< evaluated by the same loop
  static Entry entry() { return entry_of(Member::name, Member::summary, Member::source); }
  static Parameters parameters(const MaterialPair& pair) {
    return parameters_of(pair, Member::factor(pair.restitution));
  }
  /// Resulting coefficient of restitution for a requested e.
  static double restitution(double e) { return hunt_crossley_restitution(Member::factor(e)); }
};

struct HuntCrossley1975 : HuntCrossleyFamily<HuntCrossley1975> {
  static constexpr const char* name = "hunt-crossley-1975";
  static constexpr const char* summary = "Hunt-Crossley with the factor first published, 3/2 (1 - e)";
  static constexpr const char* source = "Hunt and Crossley 1975";
  static double factor(double e) { return 1.5 * (1.0 - e); }
};
struct HerbertMcWhannell : HuntCrossleyFamily<HerbertMcWhannell> {
  static constexpr const char* name = "herbert-mcwhannell";
  static constexpr const char* summary = "Hunt-Crossley with factor 6 (1 - e)/((2 e - 1)^2 + 3)";
  static constexpr const char* source = "Herbert and McWhannell 1977";
  static double factor(double e) { return 6.0 * (1.0 - e) / ((2.0 * e - 1.0) * (2.0 * e - 1.0) + 3.0); }
};
struct LeeWang : HuntCrossleyFamily<LeeWang> {
  static constexpr const char* name = "lee-wang";
  static constexpr const char* summary = "Hunt-Crossley with factor 3/4 (1 - e)";
  static constexpr const char* source = "Lee and Wang 1983";
  static double factor(double e) { return 0.75 * (1.0 - e); }
};
struct LankaraniNikravesh : HuntCrossleyFamily<LankaraniNikravesh> {
  static constexpr const char* name = "lankarani-nikravesh";
  static constexpr const char* summary = "Hunt-Crossley with factor 3/4 (1 - e^2)";
  static constexpr const char* source = "Lankarani and Nikravesh 1990";
  static double factor(double e) { return 0.75 * (1.0 - e * e); }
};
struct Flores : HuntCrossleyFamily<Flores> {
  static constexpr const char* name = "flores";
  static constexpr const char* summary = "Hunt-Crossley with factor 8 (1 - e)/(5 e)";
  static constexpr const char* source = "Flores, Machado, Silva and Martins 2011";
  static double factor(double e) { return 1.6 * (1.0 - e) / std::max(e, minimum_restitution); }
};
struct Gonthier : HuntCrossleyFamily<Gonthier> {
  static constexpr const char* name = "gonthier";
  static constexpr const char* summary = "Hunt-Crossley with factor (1 - e^2)/e";
  static constexpr const char* source = "Gonthier, McPhee, Lange and Piedboeuf 2004";
  static double factor(double e) { return (1.0 - e * e) / std::max(e, minimum_restitution); }
};
static_assert(NormalLaw<LankaraniNikravesh>);

}  // namespace epafi
