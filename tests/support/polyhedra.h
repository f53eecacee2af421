/// @file polyhedra.h  Convex polyhedra for tests, and their signed distance by brute force.
#pragma once
#include "detection/shapes/box.h"
#include "detection/shapes/convex_hull.h"
#include "detection/shapes/hull_from_points.h"
#include "tests/support/random_geometry.h"

namespace epafi::support {

/// Regular tetrahedron of edge 1 about its centre.
inline ConvexHull unit_tetrahedron() {
  const double s = 1.0 / (2.0 * std::sqrt(2.0));
  return ConvexHull::from_faces({{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}},
                                {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}})
      .hull;
}

/// Hull of n random points on the ellipsoid with the given semi-axes.
inline ConvexHull random_hull(Random& random, std::size_t n, const Vec3& semi_axes = Vec3::Ones()) {
  for (;;) {
    std::vector<Vec3> points;
    for (std::size_t k = 0; k < n; ++k) points.push_back(testing::random_direction(random).cwiseProduct(semi_axes));
    const HullSurface surface = hull_from_points(points);
    auto built = ConvexHull::from_faces(surface.vertices, surface.faces);
    if (built.problem.empty()) return built.hull;  // few points may leave the origin outside
  }
}

/// Signed distance by brute force, all in world axes and extended precision, without topology: every facet normal of
/// either body, every cross product of edges, every pair of vertices and every vertex-edge perpendicular is tried as a
/// direction; the largest separation is the signed distance, because its direction is of one of these four kinds.
inline double brute_force_distance(const ConvexHull& a, const Pose& pose_a, const ConvexHull& b, const Pose& pose_b) {
  using Long3 = Eigen::Matrix<long double, 3, 1>;
  const auto place = [](const ConvexHull& h, const Pose& pose, const Vec3& origin) {
    std::vector<Long3> out;
    const Eigen::Matrix<long double, 3, 3> rotation = pose.orientation.toRotationMatrix().cast<long double>();
    for (const Vec3& v : h.vertices)
      out.push_back(rotation * v.cast<long double>() + (pose.position - origin).cast<long double>());
    return out;
  };
  const std::vector<Long3> va = place(a, pose_a, pose_a.position), vb = place(b, pose_b, pose_a.position);
  long double best = -std::numeric_limits<long double>::infinity();
  const auto attempt = [&](const Long3& direction) {
    const long double length = direction.norm();
    if (!(length > 1e-12L)) return;
    const Long3 n = direction / length;
    long double max_a = -std::numeric_limits<long double>::infinity(), min_a = -max_a, max_b = max_a, min_b = min_a;
    for (const Long3& v : va) {
      max_a = std::max(max_a, n.dot(v));
      min_a = std::min(min_a, n.dot(v));
    }
    for (const Long3& v : vb) {
      max_b = std::max(max_b, n.dot(v));
      min_b = std::min(min_b, n.dot(v));
    }
    best = std::max({best, min_b - max_a, min_a - max_b});
  };
  const auto normals = [&](const ConvexHull& h, const std::vector<Long3>& v) {
    for (std::size_t f = 0; f + 1 < h.face_begin.size(); ++f) {
      const std::uint32_t k = h.face_begin[f];
      const Long3 &p = v[h.face_vertices[k]], &q = v[h.face_vertices[k + 1]], &r = v[h.face_vertices[k + 2]];
      attempt((q - p).cross(r - p));
    }
  };
  normals(a, va);
  normals(b, vb);
  for (const auto& ea : a.edges) {
    for (const auto& eb : b.edges) attempt((va[ea.to] - va[ea.from]).cross(vb[eb.to] - vb[eb.from]));
  }
  if (best <= 0.0L) return static_cast<double>(best);  // overlapping: a facet of the difference is nearest
  for (const Long3& p : va) {
    for (const Long3& q : vb) attempt(q - p);
  }
  const auto perpendiculars = [&](const ConvexHull& h, const std::vector<Long3>& v, const std::vector<Long3>& others) {
    for (const auto& e : h.edges) {
      const Long3 u = (v[e.to] - v[e.from]).normalized();
      for (const Long3& q : others) attempt((q - v[e.from]) - u * u.dot(q - v[e.from]));
    }
  };
  perpendiculars(a, va, vb);
  perpendiculars(b, vb, va);
  return static_cast<double>(best);
}

}  // namespace epafi::support
