/// @file mesh_contact.h  What the pairs with a mesh share: how a contact is named, what stands between two points, and
/// how the contacts of one body with many triangles become few. Everything is in the mesh's axes; normals point from
/// the mesh to the body.
#pragma once
#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "detection/narrow/mesh/point_triangle.h"
#include "detection/narrow/pairs/pair_query.h"
#include "detection/narrow/polyhedra/manifold.h"
#include "detection/shapes/triangle_mesh.h"

namespace epafi {

struct MeshPoint {
  Vec3 position;  ///< midway between the surfaces [m]
  Vec3 normal;    ///< unit, from the mesh to the body
  double gap;     ///< [m]
  Feature feature;
};

/// 28 bits for the triangle or its face, 28 for what touches it there; the top byte stays free for the image code.
constexpr Feature mesh_feature(std::uint32_t triangle, std::uint32_t local) {
  return Feature{triangle & 0xfffffffu} << 28 | (local & 0xfffffffu);
}

constexpr std::uint32_t triangle_of(Feature f) { return static_cast<std::uint32_t>(f >> 28) & 0xfffffffu; }
constexpr std::uint32_t local_of(Feature f) { return static_cast<std::uint32_t>(f) & 0xfffffffu; }

/// A point of a flat side: its kind (2 bits), what it is on the body (16 and 8 bits), 1 + side of the triangle that
/// cuts the body there (2 bits).
constexpr std::uint32_t local_name(Feature f, std::uint32_t cut = 0) {
  return (static_cast<std::uint32_t>(feature_kind(f)) & 3u) << 26 | (feature_vertex_a(f) & 0xffffu) << 10 |
         (feature_vertex_b(f) & 0xffu) << 2 | cut;
}
constexpr bool is_corner_of_body(Feature mesh_feature) {
  return FeatureKind(mesh_feature >> 26 & 3u) == FeatureKind::vertex_a;
}

/// A point against a triangle's plane and sides: most points are on its face or out of reach, and no root or division
/// is needed to say so (spheres in a hopper: 50 ns a pair and step less).
struct OverTriangle {
  double height;  ///< above the plane, towards the front [m]
  double beyond;  ///< the side that it lies farthest beyond; < 0: inside of all [m]
  /// Lower bound of the squared distance [m^2], up to rounding.
  double least_square() const { return height * height + (beyond > 0.0 ? beyond * beyond : 0.0); }
};
[[gnu::always_inline]] inline OverTriangle over_triangle(const TriangleMesh& mesh, std::uint32_t t, const Vec3& x) {
  const Triangle& corner = mesh.triangles[t];
  const auto& inward = mesh.inward[t];
  // differences first, for accuracy far from the origin
  const Vec3 a = x - mesh.vertices[corner[0]], b = x - mesh.vertices[corner[1]], c = x - mesh.vertices[corner[2]];
  return {mesh.normals[t].dot(a), -std::min({inward[0].dot(a), inward[1].dot(b), inward[2].dot(c)})};
}

/// Does x lie on the triangle, to within `tolerance` [m]?
inline bool lies_on(const TriangleMesh& mesh, std::uint32_t t, const Vec3& x, double tolerance) {
  const OverTriangle at = over_triangle(mesh, t, x);
  if (std::abs(at.height) > tolerance || at.beyond > tolerance) return false;
  return at.beyond <= 0.0 || nearest_on_triangle(x, mesh.corners(t)).distance <= tolerance;
}

/// The triangle stands between the points, or its rim does; `to` is off its plane by more than the tolerance [m].
inline bool stands_between(const TriangleMesh& mesh, std::uint32_t t, const Vec3& from, const Vec3& to,
                           double tolerance) {
  const double h0 = over_triangle(mesh, t, from).height, h1 = over_triangle(mesh, t, to).height;
  if (!(h0 * h1 < 0.0) || std::abs(h1) <= tolerance) return false;
  return over_triangle(mesh, t, from + h0 / (h0 - h1) * (to - from)).beyond <= tolerance;
}

/// Unit normal of a triangle towards the side on which x is; the front where x is in its plane.
inline Vec3 normal_towards(const TriangleMesh& mesh, std::uint32_t t, const Vec3& x) {
  const Vec3& n = mesh.normals[t];
  return n.dot(x - mesh.vertices[mesh.triangles[t][0]]) < 0.0 ? Vec3(-n) : n;
}

constexpr double one_spot = 0.86602540378443864676;  // cosine of 30 degrees: what a point of a body touches there

/// The surface around triangle t that bodies touch as one: with edges of less than 18 degrees, or of rigid laws of one.
inline std::uint32_t smooth_around(const TriangleMesh& mesh, std::uint32_t t, bool springs) {
  return springs ? mesh.around[t].smooth : mesh.around[t].gentle;
}
/// True if x is over the triangle, or only beyond smooth edges that are concave on the side of `normal`: its plane goes
/// on there.
inline bool goes_on_to(const TriangleMesh& mesh, std::uint32_t t, const Vec3& normal, const Vec3& x, bool springs,
                       double tolerance) {
  const EdgeKind hollow = normal.dot(mesh.normals[t]) > 0.0 ? EdgeKind::concave : EdgeKind::convex;
  const auto corner = mesh.corners(t);
  for (std::size_t k = 0; k < 3; ++k) {
    const bool goes_on = mesh.edge_kinds[t][k] == hollow &&
                         smooth_around(mesh, mesh.neighbours[t][k], springs) == smooth_around(mesh, t, springs);
    if (!goes_on && mesh.inward[t][k].dot(x - corner[k]) < -tolerance) return false;
  }
  return true;
}

/// The shortest way out of planes of a concave surface is y with n . y >= depth of each: the distance from a convex
/// set, which turns continuously (Rockafellar and Wets 1998, 2.23). With n / depth as the point of a plane it is
/// p / |p|^2 of the point p of their hull that is nearest to the origin. first: one of the points.
Vec3 nearest_of_hull(const Vec3& first, std::span<const Vec3> points);

/// Removes the triangles after the first `first` ones that are farther than `distance` [m] from x: the box of an
/// oblique triangle is much larger than the triangle.
void drop_far(const TriangleMesh& mesh, const Vec3& x, double distance, std::size_t first,
              std::vector<std::uint32_t>& triangles);

/// Merges points that are one (within 1e-6 of `size`), keeping the lowest feature; of points with one normal keeps all
/// if they are corners of the body and springs act there, else those that keep_four takes (manifold.h). Normals are one
/// within 1e-6, or within the angle that `flatness` [m] of the mesh's faces leaves open over the size.
void reduce(std::vector<MeshPoint>& points, double size, double flatness, bool springs);

/// Contacts of these points. radius_towards(n): the body's radius for R* where n leaves it, in axes of the mesh [m].
template <class Radius>
void emit(std::span<const MeshPoint> points, const Vec3& body, const Radius& radius_towards, const PairQuery& q,
          ContactSink& sink) {
  if (points.empty()) return;
  const Mat3 to_world = q.b.orientation.toRotationMatrix();
  for (const MeshPoint& p : points)
    sink.add({p.gap, -(to_world * p.normal), to_world * (p.position - body),
              q.curvature ? radius_towards(Vec3(-p.normal)) : 0.0, p.feature});
}

}  // namespace epafi
