/// @file triangle_solid.h  One triangle as a convex body: a polyhedron of two faces back to back, and a core for GJK.
#pragma once
#include "detection/shapes/convex_hull.h"

namespace epafi {

/// Coordinates are relative to the triangle's centroid. Face 0 looks along `normal`, face 1 against it.
class TriangleSolid {
 public:
  TriangleSolid(const std::array<Vec3, 3>& corner, const Vec3& normal)
      : centre_((corner[0] + corner[1] + corner[2]) / 3.0) {
    for (std::size_t k = 0; k < 3; ++k) {
      vertices_[k] = corner[k] - centre_;
      radius_ = std::max(radius_, vertices_[k].norm());
    }
    const double offset = normal.dot(vertices_[0]);
    normals_ = {normal, -normal};
    offsets_ = {offset, -offset};
    vertex_lanes_[0] = vertex_lanes(vertices_, 0);
    face_lanes_[0] = face_lanes(normals_, offsets_, 0);
  }
  TriangleSolid(const TriangleSolid&) = delete;  // views point into it
  TriangleSolid& operator=(const TriangleSolid&) = delete;

  const Vec3& centre() const { return centre_; }
  Pose pose() const { return {centre_, Quat(1, 0, 0, 0)}; }
  double bounding_radius() const { return radius_; }
  double rounding() const { return 0.0; }
  Vec3 support(const Vec3& d) const {
    const double a = d.dot(vertices_[0]), b = d.dot(vertices_[1]), c = d.dot(vertices_[2]);
    return a >= b ? (a >= c ? vertices_[0] : vertices_[2]) : (b >= c ? vertices_[1] : vertices_[2]);
  }
  PolyhedronView view() const {
    static constexpr std::array<std::uint32_t, 3> face_begin{0, 3, 6};
    static constexpr std::array<std::uint32_t, 6> face_vertices{0, 1, 2, 0, 2, 1};
    static constexpr std::array<HullEdge, 3> edges{{{0, 1, 0, 1}, {1, 2, 0, 1}, {2, 0, 0, 1}}};
    static const std::array<EdgeLanes, 1> lanes_of_edges{
        edge_lanes(edges, std::array<Vec3, 2>{Vec3::UnitZ(), -Vec3::UnitZ()}, 0)};
    static constexpr std::array<std::uint32_t, 4> pairs_begin{0, 2, 4, 6};
    static constexpr std::array<std::uint32_t, 6> neighbours{1, 2, 0, 2, 0, 1}, fans{0, 1, 0, 1, 0, 1};
    return {vertices_,   face_begin, face_vertices, normals_,    offsets_,      edges,
            pairs_begin, neighbours, pairs_begin,   fans,        radius_,       0.0,
            nullptr,     {},         vertex_lanes_, face_lanes_, lanes_of_edges};
  }

 private:
  Vec3 centre_;
  std::array<Vec3, 3> vertices_;
  std::array<Vec3, 2> normals_;
  std::array<double, 2> offsets_{};
  std::array<VertexLanes, 1> vertex_lanes_;
  std::array<FaceLanes, 1> face_lanes_;
  double radius_ = 0.0;
};
static_assert(PolyhedralShape<TriangleSolid>);

}  // namespace epafi
