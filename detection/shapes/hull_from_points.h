/// @file hull_from_points.h  Convex hull of a set of points, with exact predicates (CGAL convex_hull_3, quickhull).
/// Duplicates, interior and coplanar points are allowed in any order.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/error.h"
#include "engine/types.h"

namespace epafi {

/// Vertices of a hull and its triangles, counter-clockwise seen from outside; coplanar triangles stay apart.
struct HullSurface {
  std::vector<Vec3> vertices;  ///< in the order of the points they come from [m]
  std::vector<std::vector<std::uint32_t>> faces;
};

/// Throws SceneError at `place` where a point is not finite, there are fewer than 4 distinct points, or all of them lie
/// within 1e-9 of their extent of one plane. The result does not depend on the order of the points, but for the
/// numbering of vertices and faces.
[[nodiscard]] HullSurface hull_from_points(std::span<const Vec3> points, const Place& place = {});

}  // namespace epafi
