/// @file tessellate.h  Triangles of any shape, for drawing; body axes, vertices on the true surface, counter-clockwise
/// seen from outside, closed (but for the half-space, a square, and for open meshes).
#pragma once
#include "detection/shape_store.h"
#include "detection/shapes/triangle_surface.h"

namespace epafi {

struct Fineness {
  std::uint32_t segments = 24;  ///< of a full circle, >= 4; chords leave out 1 - cos(pi/segments) of the radius: 0.9 %
  double plane_size = 1.0;      ///< edge of the square that stands for a half-space [m], > 0
};

[[nodiscard]] TriangleSurface tessellate(const Sphere& sphere, const Fineness& fineness = {});
[[nodiscard]] TriangleSurface tessellate(const HalfSpace& half_space, const Fineness& fineness = {});
[[nodiscard]] TriangleSurface tessellate(const Box& box, const Fineness& fineness = {});
/// The core: a sweep is not drawn.
[[nodiscard]] TriangleSurface tessellate(const ConvexHull& hull, const Fineness& fineness = {});
[[nodiscard]] TriangleSurface tessellate(const Capsule& capsule, const Fineness& fineness = {});
[[nodiscard]] TriangleSurface tessellate(const Cylinder& cylinder, const Fineness& fineness = {});
[[nodiscard]] TriangleSurface tessellate(const Ellipsoid& ellipsoid, const Fineness& fineness = {});
[[nodiscard]] TriangleSurface tessellate(const Superquadric& superquadric, const Fineness& fineness = {});
[[nodiscard]] TriangleSurface tessellate(const TriangleMesh& mesh, const Fineness& fineness = {});
/// The surface, with its discs where it is closed; open ones have a front outside.
[[nodiscard]] TriangleSurface tessellate(const HollowWall& wall, const Fineness& fineness = {});
template <HollowShape S>
[[nodiscard]] TriangleSurface tessellate(const S& shape, const Fineness& fineness = {}) {
  return tessellate(shape.wall, fineness);
}
[[nodiscard]] TriangleSurface tessellate(const SolidParts& solid, const Fineness& fineness = {});
/// Its balls, each whole.
[[nodiscard]] TriangleSurface tessellate(const Clump& clump, const Fineness& fineness = {});

/// Two wheels and the axle, open surfaces.
[[nodiscard]] TriangleSurface tessellate(const WheelProfile& wheelset, const Fineness& fineness = {});
/// Both rails from the start of the track over the drawn length, without irregularities.
[[nodiscard]] TriangleSurface tessellate(const RailProfile& track, const Fineness& fineness = {});

[[nodiscard]] inline TriangleSurface tessellate(const ShapeStore& shapes, ShapeRef ref, const Fineness& fineness = {}) {
  return shapes.with(ref, [&](const auto& shape) { return tessellate(shape, fineness); });
}

}  // namespace epafi
