/// @file contact_law.h  Interface of smooth contact laws: their input, and the concepts of the normal, tangential and
/// rolling parts. A part is a set of static functions of the plain parameters of a material pair. Formulas may be
/// templates over the number of contacts at a time: `ParametersOf<Real>`, `StateOf<Real>` and `respond` with Real =
/// double or SIMD lanes. A law written for double alone is evaluated lane by lane.
#pragma once
#include <concepts>

#include "engine/lanes/lanes.h"
#include "engine/state/types.h"
#include "engine/units/registry.h"
#include "laws/material.h"
#include "laws/smooth/damper.h"

namespace epafi {

/// One contact at one instant, in SI, or as many as Real has lanes. overlap > 0 where bodies interpenetrate.
template <class Real>
struct KinematicsOf {
  Real overlap{};            ///< delta = -gap [m]
  Real approach_velocity{};  ///< d(delta)/dt, > 0 while approaching [m/s]
  Real effective_mass{};     ///< m* [kg]; the mass of the free body against a fixed one
  Real effective_radius{};   ///< R* [m]; NaN unless the law needs curvature
  Real area{};               ///< contact area (volume over overlap) [m^2], if the law needs it
  Real middle_velocity{};    ///< as approach_velocity, in the middle of the step [m/s]
  DamperStep<Real> step{};   ///< default: approach_velocity is exact

  /// Force [N] of a dashpot [N s/m] beside a spring of this stiffness [N/m]; positive while approaching.
  EPAFI_LANES Real viscous(const Real& dashpot, const Real& stiffness) const {
    const Real damper = damper_in_step<Real>(step.half_mobility, dashpot, Real{});
    return damper_force(step, damper, stiffness, approach_velocity, middle_velocity);
  }
  /// The same of one that grows with overlap^growth from the first touch on.
  EPAFI_LANES Real viscous(const Real& dashpot, const Real& stiffness, const Real& growth) const {
    const Real damper = damper_in_step<Real>(step.half_mobility, dashpot, growth);
    Real weighed = damper * begun_share<Real>(overlap, step.dt * middle_velocity, growth);
    if (!(step.dt > 0.0))  // at the start of a run a touch to within rounding begins in the first step
      weighed = if_less(stiffness * overlap, 1e-6 * (dashpot * approach_velocity), Real{}, weighed);
    return damper_force(step, weighed, stiffness, approach_velocity, middle_velocity);
  }
};
using ContactKinematics = KinematicsOf<double>;

/// Result of a normal law.
template <class Real>
struct ResponseOf {
  Real force{};          ///< N [N]; >= 0 unless the law is adhesive: a contact never pulls
  Real elastic_force{};  ///< the part of N that is stored, dU/d(delta) [N]
  Real stiffness{};      ///< k_n = d(elastic_force)/d(delta) [N/m]
  Real energy{};         ///< U(delta) [J]
  Real adhesion{};       ///< pull-off force [N], >= 0: friction slides at mu (N + adhesion)
  Real lost{};           ///< energy lost to plastic deformation or adhesion since the last step [J]
  Real dashpot{};  ///< c of the viscous part of N [N s/m]; if a damped law leaves it 0, losses have errors of order dt
  Real growth{};   ///< laws without memory: q of c ~ overlap^q, 0 to 1.5
};
using NormalResponse = ResponseOf<double>;

/// Memory of a part that has none.
template <int part>
struct Nothing {};

/// Keys that a scene lacks for a law, nearest first; empty if it is complete.
using Missing = std::vector<std::string>;

template <class L>
concept LawPart = requires(const MaterialPair& pair) {
  { L::name } -> std::convertible_to<const char*>;
  { L::needs } -> std::convertible_to<Needs>;
  { L::entry() } -> std::same_as<Entry>;
  { L::missing(pair) } -> std::same_as<Missing>;
  { L::parameters(pair) } -> std::same_as<typename L::Parameters>;
};

/// A law with memory has `State`, which begins unloaded with every contact.
template <class L>
concept RemembersNormal = requires {
  typename L::State;
};

template <class L>
struct NormalStateOf {
  using type = Nothing<0>;
};
template <RemembersNormal L>
struct NormalStateOf<L> {
  using type = typename L::State;
};
template <class L>
using NormalState = typename NormalStateOf<L>::type;

template <class L>
concept NormalLaw = LawPart<L> &&
    requires(const typename L::Parameters& p, const ContactKinematics& c, NormalState<L>& s) {
  { L::is_hertzian } -> std::convertible_to<bool>;  ///< k_n = 2 E* a, a the contact radius: sqrt(R* delta) for Hertz
  { L::is_damped(p) } -> std::same_as<bool>;
  requires requires {
    { L::respond(p, c) } -> std::same_as<NormalResponse>;
  } || requires {
    { L::respond(p, c, s, s) } -> std::same_as<NormalResponse>;
  };  ///< state before, state now
};

/// A normal law that also evaluates several contacts at once.
template <class L>
concept LaneLaw = NormalLaw<L> &&(
    requires(const typename L::template ParametersOf<Lanes>& p, const KinematicsOf<Lanes>& c) {
      { L::respond(p, c) } -> std::same_as<ResponseOf<Lanes>>;
    } ||
    requires(const typename L::template ParametersOf<Lanes>& p, const KinematicsOf<Lanes>& c,
             typename L::template StateOf<Lanes>& s) {
      { L::respond(p, c, s, s) } -> std::same_as<ResponseOf<Lanes>>;
    });

template <NormalLaw L>
NormalResponse respond(const typename L::Parameters& p, const ContactKinematics& c, const NormalState<L>& before,
                       NormalState<L>& now) {
  if constexpr (RemembersNormal<L>)
    return L::respond(p, c, before, now);
  else
    return L::respond(p, c);
}

/// Friction by a spring of stiffness k_t(k_n), rescaled on unloading, that slides at mu N: laws/smooth/spring.h, also
/// for lanes.
template <class L>
concept LaneFriction = requires(const typename L::template ParametersOf<Lanes>& p, Lanes normal_stiffness) {
  { L::stiffness(p, normal_stiffness) } -> std::same_as<Lanes>;
};

/// Laws that differ only in how parameters are computed share one evaluation.
template <class L>
struct LoopOfLaw {
  using type = L;
};
template <class L>
requires requires { typename L::Loop; }
struct LoopOfLaw<L> {
  using type = typename L::Loop;
};
template <class L>
using Loop = typename LoopOfLaw<L>::type;

/// Input of friction in one step. All lengths are in the contact plane.
struct SlipStep {
  Vec3 normal;              ///< now, from A to B
  double twist;             ///< mean rotation of the pair about the normal in the step [rad]
  Vec3 displacement;        ///< of B against A [m]
  double normal_stiffness;  ///< k_n [N/m]
  double normal_force;      ///< N + adhesion [N], >= 0: friction slides at mu times this
};

/// Result of friction.
struct FrictionResponse {
  Vec3 load = Vec3::Zero();  ///< on A [N]
  double energy = 0.0;       ///< stored now [J]
  double work = 0.0;         ///< work done on the spring during the step, by the trapezoidal rule [J]
};

/// Friction: pull(parameters, step, memory before, memory now).
template <class L>
concept TangentialLaw = LawPart<L> &&
    requires(const typename L::Parameters& p, const SlipStep& step, typename L::Memory& m) {
  { L::is_present } -> std::convertible_to<bool>;
  { L::stiffness(p, 1.0) } -> std::same_as<double>;  ///< of k_n, without slip [N/m]: for the time step
  { L::pull(p, step, m, m) } -> std::same_as<FrictionResponse>;
};

/// Friction with a dashpot beside the spring, with `damping` times the critical value.
template <class L>
concept WithDashpot = LaneFriction<L> && requires(const typename L::Parameters& p) {
  { p.damping } -> std::convertible_to<double>;
};

/// Input of rolling resistance in one step, for one contact or several.
template <class Real>
struct RollingStepOf {
  Real normal_stiffness, normal_force, radius;  ///< k_n [N/m], N [N], R* [m]
  Real inertia;                                 ///< I_r of the pair about the contact [kg m^2]
  Real spin_inertia;                            ///< of the pair about the centres, 1/(1/I_a + 1/I_b) [kg m^2]
  Real spin;                                    ///< rolling velocity [rad/s], >= 0
  double dt;                                    ///< [s]
};
using RollingStep = RollingStepOf<double>;

/// Resistance to rolling: the parameters of AnyRolling (laws/smooth/rolling.h), or none.
template <class L>
concept RollingLaw = LawPart<L> && requires {
  { L::is_present } -> std::convertible_to<bool>;
};

inline Field optional_field(const char* name, const char* symbol, const char* unit, Kind kind, const Range& range,
                            const char* help) {
  Field f{name, symbol, unit, kind, {}, range, help};
  f.optional = true;
  return f;
}

/// Value of a field, or the entry's default if the scene omits it; NaN if there is neither.
inline double number_or_default(const Parameters& given, const Entry& entry, const std::string& name) {
  if (given.has(name)) return given.number(name);
  for (const auto& f : entry.fields)
    if (f.name == name && f.default_value) return std::get<double>(*f.default_value);
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace epafi
