/// @file mesh_contact.h  What the pairs with a mesh share: how a contact is named, and how the contacts of one body
/// with many triangles become few. Everything is in the mesh's axes; normals point from the mesh to the body.
#pragma once
#include <span>
#include <vector>

#include "detection/narrow/pair_query.h"
#include "detection/narrow/point_triangle.h"
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

/// Does x lie on the triangle, to within `tolerance` [m]?
inline bool lies_on(const TriangleMesh& mesh, std::uint32_t t, const Vec3& x, double tolerance) {
  const auto corner = mesh.corners(t);
  if (std::abs(mesh.normals[t].dot(x - corner[0])) > tolerance) return false;
  return nearest_on_triangle(x, corner).distance <= tolerance;
}

/// Unit normal of a triangle towards the side on which x is; the front where x is in its plane.
inline Vec3 normal_towards(const TriangleMesh& mesh, std::uint32_t t, const Vec3& x) {
  const Vec3& n = mesh.normals[t];
  return n.dot(x - mesh.vertices[mesh.triangles[t][0]]) < 0.0 ? Vec3(-n) : n;
}

/// Takes those out of the triangles behind the first `first` ones that lie farther than `distance` [m] from x: one that
/// lies askew has a box much larger than itself.
void drop_far(const TriangleMesh& mesh, const Vec3& x, double distance, std::size_t first,
              std::vector<std::uint32_t>& triangles);

/// Merges points that are one (position and normal within 1e-6 of `size` and of 1), keeping the lowest feature; of
/// points with one normal keeps at most 4 that span the largest area, the deepest among them.
void reduce(std::vector<MeshPoint>& points, double size);

/// Hands the points to the sink, with the body as A. body: its pose in the mesh's axes.
void emit(std::span<const MeshPoint> points, const Vec3& body, double radius, const PairQuery& q, ContactSink& sink);

}  // namespace epafi
