/// @file exact_hull.h  Convex hull of points, decided by exact predicates.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/state/types.h"

namespace epafi {

/// Triangles of the convex hull, as indices of points, counter-clockwise seen from outside, each beginning with its
/// lowest index. Only extreme points appear: none inside an edge or a face. Needs four points that span a volume:
/// `simplex`, their indices.
[[nodiscard]] std::vector<std::array<std::uint32_t, 3>> exact_hull(std::span<const Vec3> points,
                                                                   std::array<std::uint32_t, 4> simplex);

}  // namespace epafi
