/// @file mesh_floors.h  Floors of triangles, and contacts of one body with a mesh.
#pragma once
#include "detection/narrow/mesh/mesh_pairs.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

namespace epafi::testing {

/// The same triangles, none of which shares a corner with another.
inline TriangleSurface with_loose_corners(const TriangleSurface& s) {
  TriangleSurface loose;
  for (const auto& t : s.triangles) {
    const auto k = static_cast<std::uint32_t>(loose.vertices.size());
    for (const auto v : t) loose.vertices.push_back(s.vertices[v]);
    loose.triangles.push_back({k, k + 1, k + 2});
  }
  return loose;
}

enum class Joints { shared, loose, staggered };

/// Floor z = 0 over [-1, 1]^2 in n by n cells with jittered nodes and random diagonals. loose: no shared vertices.
/// staggered: every second row shifted by half a cell, so that vertices lie in the middle of their neighbours' edges.
inline TriangleSurface floor_surface(Random& random, std::uint32_t n, Joints joints = Joints::shared) {
  TriangleSurface s;
  const double cell = 2.0 / n;
  const auto quad = [&](const std::array<std::uint32_t, 4>& q) {
    if (random.bits() & 1u) {
      s.triangles.push_back({q[0], q[1], q[2]});
      s.triangles.push_back({q[0], q[2], q[3]});
    } else {
      s.triangles.push_back({q[1], q[2], q[3]});
      s.triangles.push_back({q[1], q[3], q[0]});
    }
  };
  if (joints == Joints::staggered) {
    for (std::uint32_t j = 0; j < n; ++j)
      for (std::uint32_t i = 0; i <= n; ++i) {
        const double x = -1 + cell * (i - (j % 2 ? 0.5 : 0.0)), y = -1 + cell * j;
        const auto k = static_cast<std::uint32_t>(s.vertices.size());
        for (const Vec3& v : {Vec3(x, y, 0), Vec3(x + cell, y, 0), Vec3(x + cell, y + cell, 0), Vec3(x, y + cell, 0)})
          s.vertices.push_back(v);
        quad({k, k + 1, k + 2, k + 3});
      }
    return s;
  }
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const bool border = i == 0 || j == 0 || i == n || j == n;
      const double shift = border ? 0.0 : 0.3 * cell;
      s.vertices.push_back(
          {-1 + cell * i + shift * random.uniform(-1, 1), -1 + cell * j + shift * random.uniform(-1, 1), 0.0});
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t k = j * (n + 1) + i;
      quad({k, k + 1, k + n + 2, k + n + 1});
    }
  return joints == Joints::shared ? s : with_loose_corners(s);
}

/// Contacts of a body with all triangles near it.
template <class S>
ContactSet contacts_with(const S& shape, const Pose& body, const TriangleMesh& mesh, const Pose& at = {},
                         double reach = 0.0) {
  ContactSet set;
  set.with_curvature = true;
  ContactSink sink(set);
  std::vector<std::uint32_t> triangles;
  mesh.query(box_in_body_axes(shape.bounding_box(body), at).fattened(reach + 1e-3), triangles);
  sink.begin(0, 1);
  collide_triangles(shape, mesh, triangles, {body, at, reach, true, nullptr}, sink);
  sink.end();
  return set;
}
template <class A, class B>
ContactSet contacts_closed(const A& a, const Pose& pa, const B& b, const Pose& pb, double reach = 0.0) {
  ContactSet set;
  set.with_curvature = true;
  ContactSink sink(set);
  sink.begin(0, 1);
  collide_closed(a, b, {pa, pb, reach, true, nullptr}, sink);
  sink.end();
  return set;
}

/// Every contact of `found` is one of `expected` and the other way round: gap, normal and point.
inline void check_same_contacts(const ContactSet& found, const ContactSet& expected, double tolerance) {
  CHECK(found.size() == expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    double best = infinity;
    for (std::size_t i = 0; i < found.size(); ++i)
      best = std::min(best, std::abs(found.gap[i] - expected.gap[k]) + (found.normal[i] - expected.normal[k]).norm() +
                                (found.arm[i] - expected.arm[k]).norm());
    CHECK(best < tolerance);
  }
}

inline void check_distinct_features(const ContactSet& set) {
  for (std::size_t k = 1; k < set.size(); ++k) CHECK(set.feature[k - 1] < set.feature[k]);
}

}  // namespace epafi::testing
