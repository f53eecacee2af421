/// @file on_surface.h  Tests whether a point is on a wall, and whether the wall extends beyond a plane there.
#pragma once
#include <vector>

#include "detection/shape_store.h"

namespace epafi {

/// Walls with flat or straight sides: polyhedra, solids of them, cylinders, capsules, half-spaces, meshes, tubes and
/// cones (whose curve around the axis counts as straight). Others (spheres, clumps, ellipsoids, superquadrics, rails,
/// wheels) never form seams.
bool has_flat_faces(const ShapeStore& shapes, ShapeRef shape);
/// Free bodies form level surfaces only with plane faces; two capsules side by side do not.
bool is_free_wall(const ShapeStore& shapes, ShapeRef shape);

/// True for convex shapes: the whole lies behind the plane through any of its points and normals.
bool is_convex(const ShapeStore& shapes, ShapeRef shape);

/// Number of convex parts of a solid; 0 for other shapes.
std::size_t part_count(const ShapeStore& shapes, ShapeRef shape);

/// A body, or one part of a solid.
struct WallPiece {
  static constexpr std::size_t whole = std::size_t(-1);
  ShapeRef shape;
  Pose pose;
  std::size_t part = whole;
};

/// Distance of `point` (world axes) from the surface, 0 or less inside [m]; infinite if more than `near` [m]. Of a mesh
/// only the surface counts; near edges of a polyhedron it is the largest distance from its planes.
double distance_to(const ShapeStore& shapes, const WallPiece& piece, const Vec3& point, double near);

inline bool is_on(const ShapeStore& shapes, const WallPiece& piece, const Vec3& point, double near) {
  return distance_to(shapes, piece, point, near) <= near;
}

/// Numbers of the parts of a solid that `point` (world axes) is on; `out` is cleared first.
void find_parts(const ShapeStore& shapes, const WallPiece& solid, const Vec3& point, double near,
                std::vector<std::size_t>& out);

/// True where the body extends beyond `point` along `normal` (unit) by more than `near` [m]: a convex body as a whole,
/// of solids the parts, of meshes the triangles that contain the point.
bool goes_beyond(const ShapeStore& shapes, const WallPiece& piece, const Vec3& point, const Vec3& normal, double near);

/// The normal (unit, world axes) of the flat or straight side that contains `point`, more than `near` [m] from its
/// edges, if it differs from `normal` by less than facing_sine; else `normal` itself. The contact normal of a body that
/// lies flat may come from its own face, which tilts with the body.
Vec3 side_normal(const ShapeStore& shapes, const WallPiece& piece, const Vec3& point, const Vec3& normal, double near);

/// A plane side of a wall: where normal . x = offset from its centre, world axes.
struct PlaneSide {
  Vec3 normal;
  double offset = infinity;  ///< [m]; infinite: there is none
};

/// Of polyhedra, solids and meshes: the side nearest to the plane through `point` across `normal` (unit). Normals agree
/// within facing_sine. Of a mesh and of parts what is within `reach` [m] of `centre` counts, of a mesh on the side of
/// the surface on which that is.
PlaneSide plane_side(const ShapeStore& shapes, const WallPiece& piece, const Vec3& normal, const Vec3& point,
                     const Vec3& centre, double reach);

}  // namespace epafi
