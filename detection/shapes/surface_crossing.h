/// @file surface_crossing.h  Where a surface of triangles goes through itself: a side of one triangle through the
/// inside of another. Corners, sides and faces that only touch are no crossing.
#pragma once
#include "detection/shapes/triangle_surface.h"

namespace epafi {

struct SurfaceCrossings {
  std::size_t triangles = 0;  ///< number that cross others
  Vec3 first = Vec3::Zero();  ///< where the first of them does, in the order of the file [m]
};

/// slack: of heights and of distances from sides [m]. Above 0 what is less deep touches; below 0 sides that go through
/// sides cross as well.
[[nodiscard]] SurfaceCrossings find_crossings(const TriangleSurface& surface, double slack);

}  // namespace epafi
