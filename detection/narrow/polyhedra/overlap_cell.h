/// @file overlap_cell.h  A cell of the overlap of two polyhedra, however it is found.
#pragma once
#include "engine/state/types.h"

namespace epafi {

/// Part of the overlap where one face is the nearest of all.
struct OverlapCell {
  bool of_a;
  std::uint32_t face;
  double volume;  ///< [m^3]
  double depth;   ///< of the centroid below the face [m]
  Vec3 centroid;  ///< A's axes, from A's centre [m]
};

/// Known faces and features are not asked for cells thinner than this: of the sum of radii, 500 times the rounding of
/// heights.
inline constexpr double thinnest_cell = 1e-13;

/// The last cell is what the others leave where that is more than this part of the overlap: of less the difference
/// would lose more than three digits.
inline constexpr double least_rest = 1e-3;

}  // namespace epafi
