/// @file contact_law.h  What a smooth law sees of a contact, and what its normal, tangential and rolling parts offer.
/// A part is a set of static functions over plain parameters of a material pair; the loop of laws/smooth/smooth_contact.h
/// takes it as a template parameter, so a part that is absent costs nothing.
#pragma once
#include <concepts>

#include "engine/registry.h"
#include "engine/types.h"
#include "laws/material.h"

namespace epafi {

/// One contact at one instant, in SI. overlap > 0 where bodies interpenetrate.
struct ContactKinematics {
  double overlap = 0.0;            ///< delta = -gap [m]
  double approach_velocity = 0.0;  ///< d(delta)/dt, > 0 while approaching [m/s]
  double effective_mass = 0.0;     ///< m* [kg]; the mass of the free body against a fixed one
  double effective_radius = 0.0;   ///< R* [m]; NaN where the law did not ask for curvature
  double area = std::numeric_limits<double>::quiet_NaN();  ///< of a cell of overlap volume [m^2]; NaN elsewhere
};

/// What a normal law answers.
struct NormalResponse {
  double force = 0.0;          ///< N [N]; >= 0 unless the law is adhesive: a contact never pulls
  double elastic_force = 0.0;  ///< the part of N that is stored, dU/d(delta) [N]
  double stiffness = 0.0;      ///< k_n = d(elastic_force)/d(delta) [N/m]
  double energy = 0.0;         ///< U(delta) [J]
  double adhesion = 0.0;       ///< the force that parts the bodies [N], >= 0: friction slides at mu (N + adhesion)
  double lost = 0.0;           ///< to plastic deformation or adhesion since the last step [J]
};

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
concept RemembersNormal = requires { typename L::State; };

template <class L>
struct NormalStateOf { using type = Nothing<0>; };
template <RemembersNormal L>
struct NormalStateOf<L> { using type = typename L::State; };
template <class L>
using NormalState = typename NormalStateOf<L>::type;

template <class L>
concept NormalLaw = LawPart<L> && requires(const typename L::Parameters& p, const ContactKinematics& c, NormalState<L>& s) {
  { L::is_hertzian } -> std::convertible_to<bool>;  ///< k_n = 2 E* a, a the contact radius: sqrt(R* delta) for Hertz
  { L::is_damped(p) } -> std::same_as<bool>;
  requires requires { { L::respond(p, c) } -> std::same_as<NormalResponse>; } ||
      requires { { L::respond(p, c, s, s) } -> std::same_as<NormalResponse>; };  ///< state before, state now
};

template <NormalLaw L>
NormalResponse respond(const typename L::Parameters& p, const ContactKinematics& c, const NormalState<L>& before, NormalState<L>& now) {
  if constexpr (RemembersNormal<L>) return L::respond(p, c, before, now);
  else return L::respond(p, c);
}

/// Some laws of a list share one way of evaluation and differ in how their parameters come about.
template <class L>
struct LoopOfLaw { using type = L; };
template <class L>
requires requires { typename L::Loop; }
struct LoopOfLaw<L> { using type = typename L::Loop; };
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
concept TangentialLaw = LawPart<L> && requires(const typename L::Parameters& p, const SlipStep& step, typename L::Memory& m) {
  { L::is_present } -> std::convertible_to<bool>;
  { L::stiffness(p, 1.0) } -> std::same_as<double>;  ///< of k_n, without slip [N/m]: for the time step
  { L::pull(p, step, m, m) } -> std::same_as<FrictionResponse>;
};

/// What rolling resistance sees of one step.
struct RollingStep {
  double normal_stiffness, normal_force, radius;  ///< k_n [N/m], N [N], R* [m]
  double inertia;                                 ///< I_r of the pair about the contact [kg m^2]
  double spin;                                    ///< rolling velocity [rad/s], >= 0
  double dt;                                      ///< [s]
};

/// A rolling spring (stiffness 0: none) and dashpot with a largest moment.
template <class L>
concept RollingLaw = LawPart<L> && requires(const typename L::Parameters& p, const RollingStep& step) {
  { L::is_present } -> std::convertible_to<bool>;
  { L::stiffness(p, step) } -> std::same_as<double>;  ///< [N m/rad]
  { L::limit(p, step) } -> std::same_as<double>;      ///< [N m]
  { L::damping(p, step) } -> std::same_as<double>;    ///< [N m s]
};

inline Field optional_field(const char* name, const char* symbol, const char* unit, Kind kind, const Range& range, const char* help) {
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
