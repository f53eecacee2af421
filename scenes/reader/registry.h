/// @file registry.h  The lists of variants that a scene may name. Passed in, so that the reader knows no list of its
/// own.
#pragma once
#include <string>
#include <vector>

#include "engine/units/registry.h"

namespace epafi {

inline constexpr double largest_integer = 9007199254740992.0;  // 2^53: exact as a double

struct Registry {
  std::vector<Entry> shapes;
  std::vector<Entry> normal_laws;  ///< [contact.smooth] law
  std::vector<Entry> tangential_laws;
  std::vector<Entry> rolling_laws;
  std::vector<Entry> solvers;
  std::vector<Entry> broad_phases;
  std::vector<Entry> schemes;                  ///< of both methods
  std::vector<std::string> smooth_schemes;     ///< names of those that work with forces; the first is the default
  std::vector<std::string> nonsmooth_schemes;  ///< those that work with impulses
  std::vector<Entry> measures;
  std::vector<Field> rolling_fields;       ///< [contact.wheel_rail]
  std::vector<Entry> patch_normal_models;  ///< of `epafi patch`
  std::vector<Entry> patch_tangential_models;
};

/// The names of a list, in its order.
std::vector<std::string> names_of(const std::vector<Entry>& entries);
/// The entry of that name; null if there is none.
const Entry* find_entry(const std::vector<Entry>& entries, const std::string& name);

}  // namespace epafi
