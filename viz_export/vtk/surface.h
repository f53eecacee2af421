/// @file surface.h  The surface of a shape as polygons, for pictures. Flat faces are exact; round bodies are drawn as
/// the support points of a grid of directions, so every corner lies on the body and the picture lies inside it.
#pragma once
#include <cstdint>
#include <vector>

#include "detection/shape_store.h"

namespace epafi {

/// Polygon f has the points connectivity[offsets[f-1] .. offsets[f]), counter-clockwise from outside; offsets[-1] = 0.
struct Surface {
  std::vector<Vec3> points;  ///< body axes [m]
  std::vector<std::int32_t> connectivity, offsets;
  bool curved = false;  ///< stands for a curved body: its facets are no faces
  bool empty() const { return offsets.empty(); }
};

/// Empty for a sphere: it is drawn as a point with its radius. plane_size: edge of the square that stands for a
/// half-space [m], cut around the foot of `plane_centre` (body axes) on the plane.
Surface surface_of(const ShapeStore& shapes, ShapeRef shape, double plane_size,
                   const Vec3& plane_centre = Vec3::Zero());

}  // namespace epafi
