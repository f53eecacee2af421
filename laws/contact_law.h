/// @file contact_law.h  What a smooth law sees of a contact, and what its normal, tangential and rolling parts offer.
/// A part is a set of static functions over plain parameters of a material pair. Formulas are templates over the number
/// of contacts at a time: `ParametersOf<Real>`, `StateOf<Real>` and `respond` with Real = double or lanes. A
/// law written for one number alone is evaluated lane by lane.
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
  Real effective_radius{};   ///< R* [m]; NaN where the law did not ask for curvature
  Real area{};               ///< of a cell of overlap volume [m^2], where the law asked for it
  Real middle_velocity{};    ///< as approach_velocity, in the middle of the step [m/s]
  DamperStep<Real> step{};   ///< none: approach_velocity is exact

  /// Of a dashpot [N s/m] beside a spring of that stiffness [N/m], positive while approaching [N].
  EPAFI_LANES Real viscous(const Real& dashpot, const Real& stiffness) const {
    const Real damper = damper_in_step<Real>(step.half_mobility, dashpot, Real{});
    return damper_force(step, damper, stiffness, approach_velocity, middle_velocity);
  }
  /// The same of one that grows with overlap^growth from the first touch on.
  EPAFI_LANES Real viscous(const Real& dashpot, const Real& stiffness, const Real& growth) const {
    const Real damper = damper_in_step<Real>(step.half_mobility, dashpot, growth);
    const Real weighed = damper * begun_share<Real>(overlap, step.dt * middle_velocity, growth);
    return damper_force(step, weighed, stiffness, approach_velocity, middle_velocity);
  }
};
using ContactKinematics = KinematicsOf<double>;

/// What a normal law answers.
template <class Real>
struct ResponseOf {
  Real force{};          ///< N [N]; >= 0 unless the law is adhesive: a contact never pulls
  Real elastic_force{};  ///< the part of N that is stored, dU/d(delta) [N]
  Real stiffness{};      ///< k_n = d(elastic_force)/d(delta) [N/m]
  Real energy{};         ///< U(delta) [J]
  Real adhesion{};       ///< the force that parts the bodies [N], >= 0: friction slides at mu (N + adhesion)
  Real lost{};           ///< to plastic deformation or adhesion since the last step [J]
  Real dashpot{};        ///< c of the viscous part of N [N s/m]; where a damped law leaves it 0, losses err by order dt
  Real growth{};         ///< q of c ~ overlap^q, 0 to 1.5, of a law without memory
  Real share_before{};   ///< of a law with memory: c of the step before over c now, 0 for a new contact
};
using NormalResponse = ResponseOf<double>;

/// Memory of a part that has none.
template <int part>
struct Nothing {};

/// Names of what a scene must give for a law, nearest first; empty when all is there.
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

/// What the dashpot of a law, which remembers or not, does to the balance of energy (laws/smooth/damper.h).
template <class Real>
EPAFI_LANES Real viscous_loss(const KinematicsOf<Real>& at, const ResponseOf<Real>& r, bool remembers) {
  const Real damper = damper_in_step<Real>(at.step.half_mobility, r.dashpot, r.growth);
  DampedContact<Real> now{r.elastic_force + r.adhesion, r.stiffness, damper, {r.share_before, Real{} + 1.0}};
  if (!remembers) {
    const Real moved = at.step.dt * at.middle_velocity, late = at.step.dt * at.approach_velocity;
    const Real begun = begun_share<Real>(at.overlap, moved, r.growth);
    now.before = dashpot_before<Real>(at.overlap, moved, r.growth);
    now.before.part = now.before.part * begun_share<Real>(at.overlap - moved, 3.0 * moved - 2.0 * late, r.growth);
    now.before.whole = now.before.whole * begun;
    now.dashpot = now.dashpot * begun;
  }
  return dashpot_power<Real>(at.step, r.force - r.elastic_force, at.approach_velocity, at.middle_velocity, now);
}

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

/// Some laws of a list share one evaluation and differ in how their parameters are computed.
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

/// What friction sees of one step. All lengths in the contact plane.
struct SlipStep {
  Vec3 normal;              ///< now, from A to B
  double twist;             ///< mean turn of the pair about the normal [rad]
  Vec3 displacement;        ///< of B against A [m]
  double normal_stiffness;  ///< k_n [N/m]
  double normal_force;      ///< what friction slides at, over mu: N + adhesion [N], >= 0
};

/// What it answers.
struct FrictionResponse {
  Vec3 load = Vec3::Zero();  ///< on A [N]
  double energy = 0.0;       ///< stored now [J]
  double work = 0.0;         ///< done on it during the step, by the trapezoid of the load [J]
};

/// Friction that remembers: pull(parameters, step, memory before, memory now).
template <class L>
concept TangentialLaw = LawPart<L> &&
    requires(const typename L::Parameters& p, const SlipStep& step, typename L::Memory& m) {
  { L::is_present } -> std::convertible_to<bool>;
  { L::stiffness(p, 1.0) } -> std::same_as<double>;  ///< of k_n, without slip [N/m]: for the time step
  { L::pull(p, step, m, m) } -> std::same_as<FrictionResponse>;
};

/// Friction whose spring may have a dashpot beside it, `damping` of the critical one.
template <class L>
concept WithDashpot = LaneFriction<L> && requires(const typename L::Parameters& p) {
  { p.damping } -> std::convertible_to<double>;
};

/// What rolling resistance sees of one step, of one contact or of several.
template <class Real>
struct RollingStepOf {
  Real normal_stiffness, normal_force, radius;  ///< k_n [N/m], N [N], R* [m]
  Real inertia;                                 ///< I_r of the pair about the contact [kg m^2]
  Real spin_inertia;                            ///< of the pair about the centres, 1/(1/I_a + 1/I_b) [kg m^2]
  Real spin;                                    ///< rolling velocity [rad/s], >= 0
  double dt;                                    ///< [s]
};
using RollingStep = RollingStepOf<double>;

/// A rolling spring (stiffness 0: none) and dashpot with a largest moment.
template <class L>
concept RollingLaw = LawPart<L> && requires(const typename L::Parameters& p, const RollingStep& step) {
  { L::is_present } -> std::convertible_to<bool>;
  { L::stiffness(p, step) } -> std::same_as<double>;  ///< [N m/rad]
  { L::limit(p, step) } -> std::same_as<double>;      ///< [N m]
  { L::damping(p, step) } -> std::same_as<double>;    ///< [N m s]
  { L::stops_at_once(p) } -> std::same_as<bool>;  ///< its dashpot stops a spin within the step (laws/smooth/damper.h)
};

inline Field optional_field(const char* name, const char* symbol, const char* unit, Kind kind, const Range& range,
                            const char* help) {
  Field f{name, symbol, unit, kind, {}, range, help};
  f.optional = true;
  return f;
}

/// The default of a field of an entry, where the scene leaves it out.
inline double number_or_default(const Parameters& given, const Entry& entry, const std::string& name) {
  if (given.has(name)) return given.number(name);
  for (const auto& f : entry.fields)
    if (f.name == name && f.default_value) return std::get<double>(*f.default_value);
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace epafi
