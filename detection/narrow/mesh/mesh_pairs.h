/// @file mesh_pairs.h  Bodies against the triangles of a mesh. Both sides of a triangle are walls: a body is pushed to
/// the side of its centre. Contacts are local minima of the distance over the surface; a point that also lies on or
/// behind a closer triangle is dropped, so inner edges and vertices have no effect. Convex bodies touch convex regions
/// of the surface (mesh_region.h): the plane of a face, with the depth limited by the region; at edges and corners
/// along the shortest way out of the region. At most four points of one normal are kept, or under smooth laws all
/// corners of the body. A contact on a face is named after the face, so its memory persists from triangle to triangle.
/// A point of a body (a ball, an end of a capsule, a corner) touches a smooth surface once, whose edges bend by less
/// than 18 degrees (of rigid laws a degree): as deep as the shortest way out of its faces, so the force is continuous
/// over concave edges, and over sharper ones while it overlaps by less than a twentieth of its radius. Limit: bodies
/// that move by more than their size through the surface in one step.
#pragma once
#include "detection/narrow/mesh/mesh_contact.h"
#include "detection/narrow/pairs/closed_forms.h"
#include "detection/narrow/pairs/convex_pairs.h"
#include "detection/narrow/pairs/pair_radius.h"
#include "detection/shapes/sphere.h"

namespace epafi {

/// All functions: the body is A, the mesh B; triangles: candidates in ascending order, every triangle within reach
/// among them.
void collide_triangles(const Sphere& a, const TriangleMesh& b, std::span<const std::uint32_t> triangles,
                       const PairQuery& q, ContactSink& sink);

/// A convex body behind pointers, against the convex regions of the surface (mesh_region.h).
struct MeshGuest {
  ConvexRef core;
  double sweep;  ///< radius of the sphere swept over the core [m]
  TouchingRadius radius;
  const void* shape;
  void (*on_plane)(const void* shape, const HalfSpace& plane, const PairQuery& q, ContactSink& sink);
  FlatSide (*facing)(const void* shape, const Vec3& d) = nullptr;  ///< null where it has no flat sides, or faces
  const PolyhedronView* polyhedron = nullptr;                      ///< null where it is none
};
void collide_guest(const MeshGuest& a, const TriangleMesh& b, std::span<const std::uint32_t> triangles,
                   const PairQuery& q, ContactSink& sink);

template <ConvexShape S>
void collide_triangles(const S& a, const TriangleMesh& b, std::span<const std::uint32_t> triangles, const PairQuery& q,
                       ContactSink& sink) {
  const auto on_plane = [](const void* shape, const HalfSpace& plane, const PairQuery& query, ContactSink& out) {
    collide_closed(*static_cast<const S*>(shape), plane, query, out);
  };
  MeshGuest guest{ConvexRef::to(a), a.rounding(), TouchingRadius::of(a), &a, on_plane};
  PolyhedronView view;
  if constexpr (PolyhedralShape<S>) guest.polyhedron = &(view = a.view());
  if constexpr (HasFlatSides<S>) guest.facing = facing_of<S>;
  if constexpr (RestsFlat<S>)
    if (q.reach > 0.0) guest.facing = resting_side_of<S>;
  collide_guest(guest, b, triangles, q, sink);
}

}  // namespace epafi
