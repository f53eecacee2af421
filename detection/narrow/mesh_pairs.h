/// @file mesh_pairs.h  Bodies against the triangles of a mesh. Both sides of a triangle are walls: a body is pushed to
/// the side on which its centre is. Contacts are local minima of the distance over the surface: one whose nearest point
/// also lies on a triangle that comes closer is left out, so inner edges and vertices of a flat floor are not felt,
/// whether or not the triangles share vertices. On a flat part the contact is that of its plane and is named by the
/// part, not by the triangle: its memory survives the way from triangle to triangle. Limits: bodies that move more than
/// their size through the surface in one step; two shallow concave faces give two contacts where a smooth surface would
/// give one; a polyhedron that touches a corner of the mesh nearer to it than the contact is deep may get a direction
/// that is off by some degrees (1 of 300 random contacts of 1e-5 depth; the gap is right); a polyhedron's corner that
/// hangs over a convex edge is left out of its points on the face (1 of 500 contacts at edges: less deep by up to 0.02
/// of the size).
#pragma once
#include "detection/narrow/closed_forms.h"
#include "detection/narrow/convex_pairs.h"
#include "detection/narrow/mesh_contact.h"
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

/// Features of polyhedron and triangle; a normal that an adjacent triangle forbids is replaced by the triangle's own.
void collide_polyhedron_triangles(const PolyhedronView& a, double sweep, double radius, const TriangleMesh& b,
                                  std::span<const std::uint32_t> triangles, const PairQuery& q, ContactSink& sink);

/// A convex core, and what it does on a plane.
struct CoreOnPlane {
  ConvexRef core;
  const void* shape;
  void (*collide)(const void* shape, const HalfSpace& plane, const PairQuery& q, ContactSink& sink);
};
/// GJK and EPA against each triangle; where the normal is that of the triangle, the closed form against its plane.
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
  collide_core_triangles({ConvexRef::to(a), &a, on_plane}, a.rounding(), contact_radius(a), b, triangles, q, sink);
}

}  // namespace epafi
