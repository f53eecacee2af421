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
  double force = 0.0;          ///< N [N], >= 0: a contact never pulls
  double elastic_force = 0.0;  ///< the part of N that is stored, dU/d(delta) [N]
  double stiffness = 0.0;      ///< k_n = d(elastic_force)/d(delta) [N/m]
  double energy = 0.0;         ///< U(delta) [J]
};

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

template <class L>
concept NormalLaw = LawPart<L> && requires(const typename L::Parameters& p, const ContactKinematics& c) {
  { L::is_hertzian } -> std::convertible_to<bool>;           ///< k_n = 2 E* sqrt(R* delta)
  { L::is_damped(p) } -> std::same_as<bool>;
  { L::respond(p, c) } -> std::same_as<NormalResponse>;
};

/// A tangential spring of stiffness k_t(k_n) that slides at mu N.
template <class L>
concept TangentialLaw = LawPart<L> && requires(const typename L::Parameters& p, double normal_stiffness) {
  { L::is_present } -> std::convertible_to<bool>;
  { L::stiffness(p, normal_stiffness) } -> std::same_as<double>;
  { L::friction(p) } -> std::same_as<double>;
};

/// A rolling spring and dashpot with a largest moment.
template <class L>
concept RollingLaw = LawPart<L> && requires(const typename L::Parameters& p, double x) {
  { L::is_present } -> std::convertible_to<bool>;
  { L::stiffness(p, x, x) } -> std::same_as<double>;   ///< of (k_n, R*) [N m/rad]
  { L::limit(p, x, x) } -> std::same_as<double>;       ///< of (N, R*) [N m]
  { L::damping(p, x, x) } -> std::same_as<double>;     ///< of (k_r, I_r) [N m s]
};

/// The default of a field of an entry, where the scene leaves it out.
inline double number_or_default(const Parameters& given, const Entry& entry, const std::string& name) {
  if (given.has(name)) return given.number(name);
  for (const auto& f : entry.fields)
    if (f.name == name && f.default_value) return std::get<double>(*f.default_value);
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace epafi
