/// @file choose_law.h  A name becomes a type: one visit per run, none per contact.
#pragma once
#include <optional>
#include <string>
#include <type_traits>
#include <variant>

#include "laws/all_laws.h"
#include "laws/smooth/restitution.h"

namespace epafi {

template <class... L>
std::vector<Entry> law_entries(LawList<L...>) {
  return {L::entry()...};
}

/// The type of the list with that name, none where there is no such law.
template <class... L>
auto find_law(LawList<L...>, const std::string& name) {
  std::optional<std::variant<std::type_identity<L>...>> found;
  ((name == L::name ? void(found = std::type_identity<L>{}) : void()), ...);
  return found;
}

/// f(type of the law), the name being known. One list at a time: all triples of types take 40 s to compile.
template <class List, class F>
decltype(auto) with_law(const List& list, const std::string& name, const F& f) {
  return std::visit(f, *find_law(list, name));
}

/// Smallest restitution the law's damper is set for.
template <NormalLaw N>
inline constexpr double least_restitution = [] {
  if constexpr (requires { N::least_restitution; })
    return N::least_restitution;
  else
    return minimum_restitution;
}();

/// True where `restitution` sets the damper; otherwise the law has its own parameter.
template <NormalLaw N>
inline constexpr bool uses_restitution = [] {
  if constexpr (requires { N::uses_restitution; })
    return N::uses_restitution;
  else
    return true;
}();

}  // namespace epafi
