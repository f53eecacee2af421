/// @file flat_side.h  The flat sides of smooth bodies: what several contact points are made of.
#pragma once
#include <array>
#include <concepts>

#include "engine/state/types.h"

namespace epafi {

/// Corners of what a core turns towards a direction where that is nearly flat: 2 of a straight side, more of a flat
/// end; 0 where it is curved or pointed. Corners are fixed in the body, so that their names persist. Body axes [m].
struct FlatSide {
  static constexpr int most = 8;
  std::array<Vec3, most> corner;
  int count = 0;
};

/// Sine of the angle within which a side or end counts as facing: beyond, one point is the contact.
inline constexpr double facing_sine = 0.05;

template <class S>
concept HasFlatSides = requires(const S& s, const Vec3& d) {
  { s.facing(d) } -> std::same_as<FlatSide>;
};

}  // namespace epafi
