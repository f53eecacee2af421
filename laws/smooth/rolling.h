/// @file rolling.h  Rolling parts: none, and the elastic-plastic spring with dashpot (type C of Ai et al. 2011).
/// The spring holds a body at rest without creep. The limit holds for spring and dashpot together: with the dashpot
/// outside it, as published, a rolling sphere that touches down gets a moment of 60 to 260 times the limit for a step.
#pragma once
#include <cmath>

#include "laws/contact_law.h"

namespace epafi {

struct NoRolling {
  static constexpr const char* name = "none";
  static constexpr Needs needs{};
  static constexpr bool is_present = false;
  struct Parameters {};

  static Entry entry() { return {name, "no resistance to rolling", {}, needs, ""}; }
  static Missing missing(const MaterialPair&) { return {}; }
  static Parameters parameters(const MaterialPair&) { return {}; }
  static double stiffness(const Parameters&, double, double) { return 0.0; }
  static double limit(const Parameters&, double, double) { return 0.0; }
  static double damping(const Parameters&, double, double) { return 0.0; }
};
static_assert(RollingLaw<NoRolling>);

/// M = k_r theta + C_r theta_dot, |M| <= mu_r R* N, k_r = 9/4 k_n (mu_r R*)^2, C_r = 2 eta sqrt(I_r k_r)
struct RollingSpring {
  static constexpr const char* name = "spring";
  static constexpr Needs needs{.rotation = true, .memory = true, .curvature = true, .contact_moment = true};
  static constexpr bool is_present = true;
  struct Parameters {
    double friction;  ///< mu_r [-], >= 0
    double damping;   ///< eta, of critical [-], >= 0
  };

  static Entry entry() {
    return {name, "elastic-plastic rolling spring with dashpot (type C)",
            {{"rolling_damping", "eta_r", "", Kind::number, Value{0.3}, not_negative,
              "damping of the rolling spring as a part of the critical"}},
            needs, "Ai, Chen, Rotter and Ooi 2011"};
  }
  static Missing missing(const MaterialPair&) { return {}; }
  static Parameters parameters(const MaterialPair& pair) {
    return {pair.rolling_friction, number_or_default(pair.parameters, entry(), "rolling_damping")};
  }
  static double stiffness(const Parameters& p, double normal_stiffness, double radius) {
    const double arm = p.friction * radius;
    return 2.25 * normal_stiffness * arm * arm;
  }
  static double limit(const Parameters& p, double normal_force, double radius) {
    return p.friction * radius * normal_force;
  }
  static double damping(const Parameters& p, double rolling_stiffness, double rolling_inertia) {
    return 2.0 * p.damping * std::sqrt(rolling_inertia * rolling_stiffness);
  }
};
static_assert(RollingLaw<RollingSpring>);

}  // namespace epafi
