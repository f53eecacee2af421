/// @file convex_parts.h  A closed surface cut into convex polyhedra without common volume (Chazelle 1984, by CGAL's Nef
/// polyhedra in exact numbers): every reflex edge is cut by a plane, then parts whose union is convex are joined again.
/// r reflex edges give at most about r^2/2 parts; a stone with three dents gives 5 to 15 in 0.2 s. The only use of CGAL's
/// Nef polyhedra.
#pragma once
#include "detection/shapes/hull_from_points.h"
#include "detection/shapes/triangle_surface.h"
#include "engine/error.h"

namespace epafi {

struct ConvexPart {
  HullSurface surface;
  double volume = 0.0;         ///< [m^3]
  Vec3 centre = Vec3::Zero();  ///< of mass [m]
};

/// `surface`: closed, outward counter-clockwise, without crossing itself. Throws SceneError at `place` where the parts do
/// not add up to the volume inside it (to 1e-9), which is what a surface that crosses itself comes to.
[[nodiscard]] std::vector<ConvexPart> convex_parts(const TriangleSurface& surface, const Place& place = {});

}  // namespace epafi
