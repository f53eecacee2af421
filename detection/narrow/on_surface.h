/// @file on_surface.h  Whether a point is on a wall, and whether the wall goes on beyond a plane there.
#pragma once
#include "detection/shape_store.h"

namespace epafi {

/// Walls with flat or straight sides: polyhedra, solids of them, cylinders, capsules, half-spaces, meshes, tubes and
/// cones (whose curve around the axis counts as straight). Others
/// (spheres, clumps, ellipsoids, superquadrics, rails, wheels) never are part of a seam.
bool has_flat_faces(const ShapeStore& shapes, ShapeRef shape);
/// What moves freely is a wall to its neighbours by plane faces: two capsules side by side are no level surface.
bool is_free_wall(const ShapeStore& shapes, ShapeRef shape);

/// All of it lies behind the plane through any of its points and normals.
bool is_convex(const ShapeStore& shapes, ShapeRef shape);

/// Of a solid of convex parts; 0 for other shapes.
std::size_t part_count(const ShapeStore& shapes, ShapeRef shape);

/// A body, or one part of a solid.
struct WallPiece {
  static constexpr std::size_t whole = std::size_t(-1);
  ShapeRef shape;
  Pose pose;
  std::size_t part = whole;
};

/// From the surface to `point` (world axes), 0 or less inside [m]; infinite where it is more than `near` [m]. Of a mesh
/// only the surface counts; at the edges of a polyhedron the distance is measured across its planes.
double distance_to(const ShapeStore& shapes, const WallPiece& piece, const Vec3& point, double near);

inline bool is_on(const ShapeStore& shapes, const WallPiece& piece, const Vec3& point, double near) {
  return distance_to(shapes, piece, point, near) <= near;
}

/// Whether some of the body that is joined to `point` lies further along `normal` (unit) than `point` by more than
/// `near` [m]: of convex bodies anything, of solids the parts on which the point is, of meshes the triangles.
bool goes_beyond(const ShapeStore& shapes, const WallPiece& piece, const Vec3& point, const Vec3& normal, double near);

/// The normal (unit, world axes) of the flat or straight side inside of which `point` lies, by more than `near` [m]
/// from its edges, where that is turned from `normal` by less than facing_sine; else `normal` itself. Where a body lies
/// flat its own face may say the normal of the contact, and that leans as the body does.
Vec3 side_normal(const ShapeStore& shapes, const WallPiece& piece, const Vec3& point, const Vec3& normal, double near);

/// A plane side of a polyhedron: where normal . x = offset from its centre, world axes.
struct PlaneSide {
  Vec3 normal;
  double offset = infinity;  ///< [m]; infinite: there is none
};

/// Of a wall that is a polyhedron: its side turned least from `normal` (unit), by less than facing_sine.
PlaneSide plane_side(const ShapeStore& shapes, const WallPiece& piece, const Vec3& normal);

}  // namespace epafi
