/// @file surface_weld.h  The steps of joining that look at corners and sides (surface_join.h).
#pragma once
#include "detection/shapes/surface_join.h"

namespace epafi {

/// Corners within the tolerance of each other become one, the first of them.
void weld_corners(TriangleSurface& surface, JoinReport& report);
/// Leaves out triangles lower than the tolerance and those given again.
void drop_slivers(TriangleSurface& surface, JoinReport& report);
/// Cuts triangles at the corners of others that lie on a side of theirs which has not exactly one neighbour.
void cut_at_corners(TriangleSurface& surface, JoinReport& report);
/// Turns triangles so that neighbours run along their side in opposite directions; of each connected part the larger
/// area stays.
void turn_alike(TriangleSurface& surface, JoinReport& report);

/// Twice the area over the longest side [m].
inline double least_height(const TriangleSurface& s, const Triangle& t) {
  const Vec3 ab = s.vertices[t[1]] - s.vertices[t[0]];
  const Vec3 ac = s.vertices[t[2]] - s.vertices[t[0]];
  const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
  return longest > 0.0 ? ab.cross(ac).norm() / std::sqrt(longest) : 0.0;
}

}  // namespace epafi
