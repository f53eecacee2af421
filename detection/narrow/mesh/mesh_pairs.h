/// @file mesh_pairs.h  Bodies against the triangles of a mesh. Both sides of a triangle are walls: a body is pushed to
/// the side on which its centre is. Contacts are local minima of the distance over the surface: one whose nearest point
/// also lies on a triangle that comes closer, or behind one, is left out, so inner edges and vertices are not felt. A
/// convex body is held by the convex regions of the surface (mesh_region.h): on a face by its plane, as deep as the
/// region lets it be; at edges and corners by the way out of the region. Of one normal at most four points are kept, or
/// under springs all corners of the body. On a face the contact is named by the face, not by the triangle: its memory
/// survives the way from triangle to triangle. A ball in a shallow hollow touches once: of faces that edges bent by
/// less than a degree join, the nearest stands for those within 30 degrees. Limits: bodies that move more than their
/// size through the surface in one step; hulls, and balls in steeper hollows, have one contact for each face.
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

/// A convex body behind pointers, against the convex regions of the surface (mesh_region.h).
struct MeshGuest {
  ConvexRef core;
  double sweep, radius;  ///< of the sphere swept over the core, and that of its contacts [m]
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
  MeshGuest guest{ConvexRef::to(a), a.rounding(), contact_radius(a), &a, on_plane};
  PolyhedronView view;
  if constexpr (PolyhedralShape<S>) guest.polyhedron = &(view = a.view());
  if constexpr (HasFlatSides<S>) guest.facing = facing_of<S>;
  collide_guest(guest, b, triangles, q, sink);
}

}  // namespace epafi
