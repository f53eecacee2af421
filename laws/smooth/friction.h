/// @file friction.h  Tangential parts: none, a spring of given ratio to the normal stiffness, Mindlin's stiffness, and
/// the full history of partial slip (laws/smooth/bristles.h). All are incremental and slide at mu N. Without dashpot: a
/// sticking contact keeps its shear energy; laws/smooth/dashpot.h has the springs with one.
#pragma once
#include "laws/smooth/bristles.h"
#include "laws/smooth/hertz.h"
#include "laws/smooth/spring.h"

namespace epafi {

/// Frictionless: no rotation, no memory.
struct NoFriction {
  static constexpr const char* name = "none";
  static constexpr Needs needs{};
  static constexpr bool is_present = false;
  template <class N>
  static constexpr bool fits = true;
  struct Parameters {};
  using Memory = Nothing<1>;

  static Entry entry() { return {name, "frictionless", {}, needs, ""}; }
  static Missing missing(const MaterialPair&) { return {}; }
  static Parameters parameters(const MaterialPair&) { return {}; }
  static double stiffness(const Parameters&, double) { return 0.0; }
  static FrictionResponse pull(const Parameters&, const SlipStep&, const Memory&, Memory&) { return {}; }
};
static_assert(TangentialLaw<NoFriction>);

/// k_t = ratio k_n; 2/7 makes the tangential period of a solid sphere twice its contact time.
struct CoulombSpring {
  static constexpr const char* name = "coulomb-spring";
  static constexpr Needs needs{.rotation = true, .slip_velocity = true, .memory = true};
  static constexpr bool is_present = true;
  template <class N>
  static constexpr bool fits = true;
  template <class Real>
  struct ParametersOf {
    Real friction;   ///< mu [-], >= 0
    Real ratio;      ///< k_t / k_n [-], > 0
    Real damping{};  ///< of critical [-], >= 0
  };
  using Parameters = ParametersOf<double>;
  using Memory = Spring;

  static Entry entry() {
    return {name,
            "tangential spring of fixed ratio to the normal stiffness, sliding at mu N",
            {{"tangential_ratio",
              "k_t/k_n",
              "",
              Kind::number,
              Value{2.0 / 7.0},
              {0, 2, true, false},
              "tangential over normal stiffness"}},
            needs,
            "Cundall and Strack 1979"};
  }
  static Missing missing(const MaterialPair&) { return {}; }
  static Parameters parameters(const MaterialPair& pair) {
    return {pair.friction, number_or_default(pair.parameters, entry(), "tangential_ratio")};
  }
  template <class Real>
  EPAFI_LANES static Real stiffness(const ParametersOf<Real>& p, Real normal_stiffness) {
    return p.ratio * normal_stiffness;
  }
  static FrictionResponse pull(const Parameters& p, const SlipStep& step, const Memory& before, Memory& now) {
    return pull_spring(step, p.ratio * step.normal_stiffness, p.friction * step.normal_force, before, now);
  }
};
static_assert(TangentialLaw<CoulombSpring>);

/// Elastic constants of the tangential parts of Mindlin's theory.
inline double mindlin_ratio(const MaterialPair& pair) {
  return 4.0 * pair.effective_shear_modulus() / pair.effective_modulus();
}

/// k_t = 8 G* sqrt(R* delta) (Mindlin 1949, no slip), the simplified law: within mu N the true compliance of partial
/// slip is larger (10 % at half the limit, case A12). As k_n = 2 E* sqrt(R* delta), k_t = 4 G*/E* k_n.
struct Mindlin : CoulombSpring {  // ratio 4 G*/E*
  static constexpr const char* name = "mindlin";
  static constexpr Needs needs{.rotation = true, .slip_velocity = true, .memory = true, .curvature = true};
  template <class N>
  static constexpr bool fits = N::is_hertzian;
  using Loop = CoulombSpring;

  static Entry entry() {
    return {name,
            "incremental no-slip stiffness of Mindlin, rescaled on unloading, sliding at mu N",
            {},
            needs,
            "Mindlin 1949; rescaling: Walton and Braun 1986"};
  }
  static Missing missing(const MaterialPair& pair) { return missing_elasticity(pair); }
  static Parameters parameters(const MaterialPair& pair) { return {pair.friction, mindlin_ratio(pair)}; }
};
static_assert(TangentialLaw<Mindlin>);

/// Partial slip from the edge inwards and its whole history: what Mindlin and Deresiewicz solved case by case.
struct MindlinDeresiewicz {
  static constexpr const char* name = "mindlin-deresiewicz";
  static constexpr Needs needs{.rotation = true, .slip_velocity = true, .memory = true, .curvature = true};
  static constexpr bool is_present = true;
  template <class N>
  static constexpr bool fits = N::is_hertzian;
  struct Parameters {
    double friction;  ///< mu [-], >= 0
    double ratio;     ///< 4 G*/E* [-]
  };
  using Memory = Bristles;

  static Entry entry() {
    return {name,
            "partial slip with its whole history, by a row of bristles",
            {},
            needs,
            "Mindlin and Deresiewicz 1953; by the method of dimensionality reduction, Popov and Hess 2015"};
  }
  static Missing missing(const MaterialPair& pair) { return missing_elasticity(pair); }
  static Parameters parameters(const MaterialPair& pair) { return {pair.friction, mindlin_ratio(pair)}; }
  static double stiffness(const Parameters& p, double normal_stiffness) { return p.ratio * normal_stiffness; }
  static FrictionResponse pull(const Parameters& p, const SlipStep& step, const Memory& before, Memory& now) {
    return pull_bristles(step, p.ratio * step.normal_stiffness, p.friction * step.normal_force, before, now);
  }
};
static_assert(TangentialLaw<MindlinDeresiewicz>);

}  // namespace epafi
