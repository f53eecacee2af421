/// @file rolling.h  Rolling parts: none, and types A, B and C of Ai et al. 2011.
/// A is a constant moment against rolling, B a viscous one, C an elastic-plastic spring with dashpot. Only C holds a
/// body at rest without creep. The limit of C applies to spring and dashpot together: with the dashpot outside it, as
/// published, a rolling sphere that touches down has a moment of 60 to 260 times the limit for a step.
#pragma once
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
};
static_assert(RollingLaw<NoRolling>);

/// The three types in one loop; the type is a parameter.
struct AnyRolling {
  static constexpr const char* name = "any";
  static constexpr Needs needs{.rotation = true, .memory = true, .curvature = true, .contact_moment = true};
  static constexpr bool is_present = true;
  enum class Type { constant, viscous, spring };
  template <class Real>
  struct ParametersOf {
    Type type = Type::spring;  ///< one for all pairs of a scene
    Real friction{};           ///< mu_r [-], >= 0
    Real damping{};            ///< C: eta, of critical [-]; B: 1/v_0 [s/m]
  };
  using Parameters = ParametersOf<double>;

  static Entry entry() { return {name, "", {}, needs, "Ai, Chen, Rotter and Ooi 2011"}; }
  static Missing missing(const MaterialPair&) { return {}; }
  static Parameters parameters(const MaterialPair&) { return {}; }
  template <class Real>
  EPAFI_LANES static Real stiffness(const ParametersOf<Real>& p, const RollingStepOf<Real>& s) {
    const Real arm = p.friction * s.radius;
    return p.type == Type::spring ? 2.25 * s.normal_stiffness * arm * arm : Real{};
  }
  template <class Real>
  EPAFI_LANES static Real limit(const ParametersOf<Real>& p, const RollingStepOf<Real>& s) {
    return p.type == Type::viscous ? Real{} + infinity : p.friction * s.radius * s.normal_force;
  }
  /// Its dashpot is chosen by what would stop the spin within some steps.
  template <class Real>
  static bool stops_at_once(const ParametersOf<Real>& p) {
    return p.type == Type::constant;
  }
  template <class Real>
  EPAFI_LANES static Real damping(const ParametersOf<Real>& p, const RollingStepOf<Real>& s) {
    const Real moment = p.friction * s.radius * s.normal_force;
    switch (p.type) {
      // The moment is limited so that it cannot reverse the spin within the step. It depends on the spin half a step
      // ahead, so the sum over all contacts of a sphere must stay below its angular momentum over the step (w' = w + dt
      // M'/I, M' = -g I/dt (w + dt M/(2 I)) has the root -1 at g = 1): enough for ten neighbours that rotate against
      // it, or twenty at rest. With the inertia about the contact, 3.5 times as large, moments of packings at rest
      // would alternate.
      case Type::constant: {
        const auto turns = s.spin > Real{};
        const Real stop = s.dt > 0.0 ? 0.1 * s.spin_inertia / s.dt : Real{} + infinity;
        const Real spin = turns ? s.spin : Real{} + 1.0;
        return turns ? min(moment / spin, stop) : Real{};
      }
      case Type::viscous:
        return moment * s.radius * p.damping;
      default:
        return 2.0 * p.damping * sqrt(s.inertia * stiffness(p, s));
    }
  }
};
static_assert(RollingLaw<AnyRolling>);

/// M = k_r theta + C_r theta_dot, |M| <= mu_r R* N, k_r = 9/4 k_n (mu_r R*)^2, C_r = 2 eta sqrt(I_r k_r)
struct RollingSpring : AnyRolling {
  static constexpr const char* name = "spring";
  using Loop = AnyRolling;
  static Entry entry() {
    return {name,
            "elastic-plastic rolling spring with dashpot (type C)",
            {{"rolling_damping", "eta_r", "", Kind::number, Value{0.3}, not_negative,
              "damping of the rolling spring over the critical"}},
            needs,
            "Ai, Chen, Rotter and Ooi 2011"};
  }
  static Parameters parameters(const MaterialPair& pair) {
    return {Type::spring, pair.rolling_friction, number_or_default(pair.parameters, entry(), "rolling_damping")};
  }
};
static_assert(RollingLaw<RollingSpring>);

/// M = mu_r R* N against the rolling velocity, whatever its size
struct RollingConstant : AnyRolling {
  static constexpr const char* name = "constant";
  using Loop = AnyRolling;
  static Entry entry() {
    return {name,
            "moment mu_r R* N against rolling (type A)",
            {},
            needs,
            "Ai, Chen, Rotter and Ooi 2011; Zhou et al. 1999"};
  }
  static Parameters parameters(const MaterialPair& pair) { return {Type::constant, pair.rolling_friction, 0.0}; }
};

/// M = mu_r R* N (R* theta_dot/v_0), v_0 the rolling speed at which it equals type A
struct RollingViscous : AnyRolling {
  static constexpr const char* name = "viscous";
  using Loop = AnyRolling;
  static Entry entry() {
    return {name,
            "moment proportional to the rolling velocity (type B)",
            {{"rolling_speed", "v_0", "m/s", Kind::number, Value{1.0}, positive,
              "rolling speed at which the moment is mu_r R* N"}},
            needs,
            "Ai, Chen, Rotter and Ooi 2011; Zhou et al. 1999"};
  }
  static Parameters parameters(const MaterialPair& pair) {
    return {Type::viscous, pair.rolling_friction, 1.0 / number_or_default(pair.parameters, entry(), "rolling_speed")};
  }
};

}  // namespace epafi
