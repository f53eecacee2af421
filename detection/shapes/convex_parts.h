/// @file convex_parts.h  A closed surface cut into convex polyhedra without common volume, by planes of its own faces
/// (a tree of cuts as of Thibault and Naylor 1987): a cell whose faces do not all lie behind each other is cut by the
/// plane of one that has others in front, the one that splits the fewest faces; then parts whose union is convex are
/// joined again. Corners within the tolerance of a plane lie on it, so that rounding of the file makes no slivers.
/// Cavities and several shells are allowed. An L gives 2 parts, a tray 5, a stone with three dents 5 to 15.
#pragma once
#include "detection/shapes/hull_from_points.h"
#include "detection/shapes/surface_join.h"
#include "engine/units/error.h"

namespace epafi {

struct ConvexPart {
  HullSurface surface;
  double volume = 0.0;         ///< [m^3]
  Vec3 centre = Vec3::Zero();  ///< of mass [m]
};

/// `joined`: closed, outward counter-clockwise, without crossing itself; precision: of its coordinates [m]. Throws
/// SceneError at `place` where the parts do not add up to the volume inside it, which is what a surface that crosses
/// itself comes to, or where they are more than can be carried.
[[nodiscard]] std::vector<ConvexPart> convex_parts(const JoinedSurface& joined, double precision,
                                                   const Place& place = {});

}  // namespace epafi
