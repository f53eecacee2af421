/// @file power_law.h  N = k delta^n with n in [1, 3]: Hertz for 3/2, a linear spring for 1, virtual penetration of
/// profiles between. Stiffness is given, or fitted to measured pairs of overlap and force.
/// Two dampers: by default c ~ delta^((n-1)/2), whose restitution is exact and independent of speed (with
/// y ~ delta^((n+1)/2) the motion is that of the linear law); with `damping` a plain dashpot c delta_dot, whose
/// restitution depends on the speed and is not asked for.
#pragma once
#include <algorithm>
#include <cmath>

#include "laws/contact_law.h"
#include "laws/smooth/restitution.h"

namespace epafi {

/// N = max(0, k delta^n + 2 zeta sqrt((n+1)/2 m* k) delta^((n-1)/2) delta_dot), or max(0, k delta^n + c delta_dot)
struct PowerLaw {
  static constexpr const char* name = "power-law";
  static constexpr Needs needs{};
  static constexpr bool is_hertzian = false;
  template <class Real>
  struct ParametersOf {
    Real stiffness;      ///< k [N/m^n], > 0
    Real exponent;       ///< n [-], in [1, 3]
    Real damping_ratio;  ///< 2 zeta sqrt((n+1)/2) [-], >= 0
    Real dashpot;        ///< c [N s/m], >= 0
  };
  using Parameters = ParametersOf<double>;

  static Entry entry() {
    const Range exponents{1, 3, false, false};
    return {
        name,
        "k delta^n with exact restitution, or with a plain dashpot",
        {{"exponent", "n", "", Kind::number, {}, exponents, "power of the overlap"},
         optional_field("stiffness", "k", "N/m^n", Kind::number, positive,
                        "normal stiffness; or fitted to the data below"),
         optional_field("calibration_overlap", "", "m", Kind::numbers, positive,
                        "measured overlaps to fit the stiffness to"),
         optional_field("calibration_force", "", "N", Kind::numbers, positive, "forces measured at these overlaps"),
         optional_field("damping", "c", "N s/m", Kind::number, not_negative,
                        "plain dashpot instead of the one set by restitution; restitution then depends on the speed")},
        needs,
        "Flores and Lankarani 2016; damping by Schwager and Poeschel 2007"};
  }
  /// k of the least squares of N - k delta^n [N/m^n].
  static double fit(const std::vector<double>& overlap, const std::vector<double>& force, double exponent) {
    double top = 0.0, bottom = 0.0;
    for (std::size_t i = 0; i < overlap.size(); ++i) {
      const double power = std::pow(overlap[i], exponent);
      top += force[i] * power;
      bottom += power * power;
    }
    return top / bottom;
  }
  static Missing missing(const MaterialPair& pair) {
    Missing out;
    const auto& p = pair.parameters;
    if (!p.has("exponent")) out.push_back("exponent of the contact");
    const bool data = p.has("calibration_overlap") && p.has("calibration_force");
    if (!p.has("stiffness") && !data)
      out.push_back("stiffness [N/m^n], or calibration_overlap [m] and calibration_force [N], of the contact");
    if (data && (p.numbers("calibration_overlap").size() != p.numbers("calibration_force").size() ||
                 p.numbers("calibration_overlap").empty()))
      out.push_back("as many values in calibration_force as in calibration_overlap, at least one");
    return out;
  }
  static Parameters parameters(const MaterialPair& pair) {
    const auto& given = pair.parameters;
    const double n = given.number("exponent");
    const double k = given.has("stiffness")
                         ? given.number("stiffness")
                         : fit(given.numbers("calibration_overlap"), given.numbers("calibration_force"), n);
    if (given.has("damping")) return {k, n, 0.0, given.number("damping")};
    return {k, n, 2.0 * std::sqrt(0.5 * (n + 1.0)) * damping_ratio_for(pair.restitution), 0.0};
  }
  static bool is_damped(const Parameters& p) { return p.damping_ratio > 0.0 || p.dashpot > 0.0; }
  /// delta^(n-1): roots where they will do, the library's power else.
  static double power_below(double overlap, double n) {
    if (n == 1.5) return std::sqrt(overlap);
    if (n == 1.0) return 1.0;
    if (n == 2.0) return overlap;
    return std::pow(overlap, n - 1.0);
  }
  template <LaneVector V>
  EPAFI_LANES static V power_below(const V& overlap, const V& n) {
    V out{};
    for (std::size_t l = 0; l < sizeof(V) / sizeof(double); ++l) out[l] = power_below(double{overlap[l]}, double{n[l]});
    return out;
  }
  static double elastic_power(const Parameters& p) { return p.exponent; }
  template <class Real>
  EPAFI_LANES static ResponseOf<Real> respond(const ParametersOf<Real>& p, const KinematicsOf<Real>& c) {
    const Real below = p.stiffness * power_below(c.overlap, p.exponent);  // k delta^(n-1)
    const Real elastic = below * c.overlap;
    const Real dashpot = p.dashpot + p.damping_ratio * sqrt(c.effective_mass * below);
    const Real growth = select(p.dashpot > Real{}, Real{}, 0.5 * (p.exponent - 1.0));
    const Real force = max(Real{}, elastic + c.viscous(dashpot, p.exponent * below, growth));
    return {.force = force,
            .elastic_force = elastic,
            .stiffness = p.exponent * below,
            .energy = elastic * c.overlap / (p.exponent + 1.0),
            .dashpot = dashpot,
            .growth = growth};
  }
};
static_assert(LaneLaw<PowerLaw>);

}  // namespace epafi
