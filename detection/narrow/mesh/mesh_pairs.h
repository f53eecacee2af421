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
