/// @file contact_law.h  What a smooth law sees of a contact, and what its normal, tangential and rolling parts offer.
/// A part is a set of static functions over plain parameters of a material pair; the loop of laws/smooth/smooth_contact.h
/// takes it as a template parameter, so a part that is absent costs nothing.
#pragma once
#include <concepts>

#include "engine/lanes.h"
#include "engine/registry.h"
#include "engine/types.h"
#include "laws/material.h"

namespace epafi {

/// One contact at one instant, in SI, or four of them (Real = Lanes). overlap > 0 where bodies interpenetrate.
template <class Real>
struct KinematicsOf {
  Real overlap{};            ///< delta = -gap [m]
  Real approach_velocity{};  ///< d(delta)/dt, > 0 while approaching [m/s]
  Real effective_mass{};     ///< m* [kg]; the mass of the free body against a fixed one
  Real effective_radius{};   ///< R* [m]; NaN where the law did not ask for curvature
  Real area{};               ///< of a cell of overlap volume [m^2], where the law asked for it
};
using ContactKinematics = KinematicsOf<double>;

/// What a normal law answers.
template <class Real>
struct ResponseOf {
  Real force{};          ///< N [N], >= 0: a contact never pulls
  Real elastic_force{};  ///< the part of N that is stored, dU/d(delta) [N]
  Real stiffness{};      ///< k_n = d(elastic_force)/d(delta) [N/m]
  Real energy{};         ///< U(delta) [J]
};
using NormalResponse = ResponseOf<double>;

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

/// A normal law that also answers for four contacts at once: its formula is a template over the number.
template <class L>
concept LaneLaw = NormalLaw<L> && requires(const typename L::Parameters& p, const KinematicsOf<Lanes>& c) {
  { L::respond(p, c) } -> std::same_as<ResponseOf<Lanes>>;
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
