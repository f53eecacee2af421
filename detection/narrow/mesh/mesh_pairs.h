/// @file mesh_pairs.h  Bodies against the triangles of a mesh. Both sides of a triangle are walls: a body is pushed to
/// the side of its centre. Contacts are local minima of the distance over the surface; a point that also lies on or
/// behind a closer triangle is dropped, so inner edges and vertices have no effect. Convex bodies touch convex regions
/// of the surface (mesh_region.h): the plane of a face, with the depth limited by the region; at edges and corners
/// along the shortest way out of the region. At most four points of one normal are kept, or under smooth laws all
/// corners of the body. A contact on a face is named after the face, so its memory persists from triangle to triangle.
/// A ball in a shallow hollow has one contact: of faces joined by edges of less than a degree, the nearest represents
/// those within 30 degrees. Limits: bodies that move by more than their size through the surface in one step; hulls,
/// and balls in steeper hollows, have one contact per face.
#pragma once
#include "detection/narrow/mesh/mesh_contact.h"
#include "detection/narrow/pairs/closed_forms.h"
#include "detection/narrow/pairs/convex_pairs.h"
#include "detection/shapes/capsule.h"
#include "detection/shapes/sphere.h"

namespace epafi {

/// All functions: the body is A, the mesh B; triangles: candidates in ascending order, every triangle within reach
/// among them.
void collide_triangles(const Sphere& a, const TriangleMesh& b, std::span<const std::uint32_t> triangles,
                       const PairQuery& q, ContactSink& sink);

/// Its two ends as spheres, and edges and vertices of the mesh against its side.
void collide_triangles(const Capsule& a, const TriangleMesh& b, std::span<const std::uint32_t> triangles,
                       const PairQuery& q, ContactSink& sink);

/// Against the convex regions of the surface (mesh_region.h).
void collide_polyhedron_triangles(const PolyhedronView& a, double sweep, double radius, const TriangleMesh& b,
                                  std::span<const std::uint32_t> triangles, const PairQuery& q, ContactSink& sink);

/// A convex core, and what it does on a plane.
struct CoreOnPlane {
  ConvexRef core;
  const void* shape;
  void (*collide)(const void* shape, const HalfSpace& plane, const PairQuery& q, ContactSink& sink);
  FlatSide (*facing)(const void* shape, const Vec3& d) = nullptr;  ///< null where it has no flat sides
};
/// GJK and EPA against convex regions; where the normal is that of a face, the closed form against its plane.
void collide_core_triangles(const CoreOnPlane& a, double sweep, double radius, const TriangleMesh& b,
                            std::span<const std::uint32_t> triangles, const PairQuery& q, ContactSink& sink);

template <PolyhedralShape S>
void collide_triangles(const S& a, const TriangleMesh& b, std::span<const std::uint32_t> triangles, const PairQuery& q,
                       ContactSink& sink) {
  collide_polyhedron_triangles(a.view(), a.rounding(), contact_radius(a), b, triangles, q, sink);
}

template <ConvexShape S>
requires(!PolyhedralShape<S>) void collide_triangles(const S& a, const TriangleMesh& b,
                                                     std::span<const std::uint32_t> triangles, const PairQuery& q,
                                                     ContactSink& sink) {
  const auto on_plane = [](const void* shape, const HalfSpace& plane, const PairQuery& query, ContactSink& out) {
    collide_closed(*static_cast<const S*>(shape), plane, query, out);
  };
  CoreOnPlane core{ConvexRef::to(a), &a, on_plane};
  if constexpr (HasFlatSides<S>) core.facing = facing_of<S>;
  collide_core_triangles(core, a.rounding(), contact_radius(a), b, triangles, q, sink);
}

}  // namespace epafi
