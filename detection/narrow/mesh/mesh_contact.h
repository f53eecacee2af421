/// @file mesh_contact.h  Common parts of pairs with a mesh: names of contacts, and reduction of the contacts of one
/// body with many triangles. Everything is in the mesh's axes; normals point from the mesh to the body.
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

/// 28 bits for the triangle, 28 for what touches it there; the top byte stays free for the image code.
constexpr Feature mesh_feature(std::uint32_t triangle, std::uint32_t local) {
  return Feature{triangle & 0xfffffffu} << 28 | (local & 0xfffffffu);
}

/// Position of a point relative to a triangle's plane and sides. Most points are over its face or out of reach, which
/// needs no root or division (saves 50 ns a pair and step of spheres in a hopper).
struct OverTriangle {
  double height;  ///< above the plane, towards the front [m]
  double beyond;  ///< the side that it lies farthest beyond; < 0: inside of all [m]
  /// Lower bound of the squared distance [m^2], up to rounding.
  double least_square() const { return height * height + (beyond > 0.0 ? beyond * beyond : 0.0); }
};
inline OverTriangle over_triangle(const TriangleMesh& mesh, std::uint32_t t, const Vec3& x) {
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

/// Unit normal of a triangle towards the side on which x is; the front where x is in its plane.
inline Vec3 normal_towards(const TriangleMesh& mesh, std::uint32_t t, const Vec3& x) {
  const Vec3& n = mesh.normals[t];
  return n.dot(x - mesh.vertices[mesh.triangles[t][0]]) < 0.0 ? Vec3(-n) : n;
}

/// Removes the triangles after the first `first` ones that are farther than `distance` [m] from x: the box of an
/// oblique triangle is much larger than the triangle.
void drop_far(const TriangleMesh& mesh, const Vec3& x, double distance, std::size_t first,
              std::vector<std::uint32_t>& triangles);

/// Key of a point: kind (2 bits), feature on the body (18 bits), side of the triangle (2 bits).
constexpr std::uint32_t local_name(FeatureKind kind, std::uint32_t on_body, std::uint32_t side) {
  return static_cast<std::uint32_t>(kind) << 20 | (on_body & 0x3ffffu) << 2 | (side & 3u);
}
constexpr bool is_corner_of_body(Feature mesh_feature) {
  return FeatureKind(mesh_feature >> 20 & 0xff) == FeatureKind::vertex_a;
}

/// Merges coincident points (position and normal within 1e-6 of `size` and of 1), keeping the lowest feature. Of points
/// with one normal keeps all if they are corners of the body under a smooth law, else those of keep_four (manifold.h).
void reduce(std::vector<MeshPoint>& points, double size, bool springs);

/// Adds the points to the sink, with the body as A. body: its pose in the mesh's axes.
void emit(std::span<const MeshPoint> points, const Vec3& body, double radius, const PairQuery& q, ContactSink& sink);

}  // namespace epafi
