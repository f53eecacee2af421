/// @file hull_from_points.h  Convex hull of a set of points, by exact predicates. Duplicates,
/// interior and coplanar points are allowed in any order.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "detection/shapes/triangle_surface.h"
#include "engine/units/error.h"

namespace epafi {

/// Vertices of a hull and its faces, counter-clockwise seen from outside. Of exact points: triangles, coplanar ones
/// stay apart. Of rounded points: the faces that lie within the tolerance of one plane, as polygons.
struct HullSurface {
  std::vector<Vec3> vertices;  ///< in the order of the points they come from [m]
  std::vector<std::vector<std::uint32_t>> faces;
  double tolerance = 0.0;  ///< of vertices to the planes of their faces; 0: to rounding [m]
};

/// The faces as fans of triangles.
[[nodiscard]] inline std::vector<Triangle> triangles_of(const HullSurface& hull) {
  std::vector<Triangle> triangles;
  for (const auto& f : hull.faces)
    for (std::size_t k = 2; k < f.size(); ++k) triangles.push_back({f[0], f[k - 1], f[k]});
  return triangles;
}

/// precision: how far rounding may have put a coordinate (of a file: MeshReport) [m]; 0: the points are exact. Four
/// times as much is flat: facets within it of one plane are one face, corners are moved into the planes that meet
/// there. Throws SceneError at `place` where a point is not finite, there are fewer than 4 distinct points, or all of
/// them lie within 1e-9 of their extent of one plane. The result does not depend on the order of the points, but for
/// the numbering of vertices and faces.
[[nodiscard]] HullSurface hull_from_points(std::span<const Vec3> points, const Place& place = {},
                                           double precision = 0.0);

}  // namespace epafi
