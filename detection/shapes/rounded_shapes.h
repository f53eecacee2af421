/// @file rounded_shapes.h  Polyhedra and solids whose corners have been rounded, as in a file of single precision.
#pragma once
#include "detection/shapes/hull_from_points.h"
#include "detection/shapes/solid_parts.h"

namespace epafi {

/// ConvexHull::from_faces where vertices may lie beside the planes of their faces by the tolerance of the surface.
[[nodiscard]] ConvexHull::Built built_hull(HullSurface surface);

/// place_solid where rounding may have put coordinates off by `precision` [m]: corners are welded, slivers left out,
/// triangles gathered to plane faces (surface_join.h) before the surface is cut.
[[nodiscard]] PlacedSolid place_solid(TriangleSurface surface, const Place& place, double precision);

}  // namespace epafi
