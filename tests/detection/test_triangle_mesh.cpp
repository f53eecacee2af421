#include "detection/shapes/triangle_mesh.h"

#include "detection/narrow/polyhedra/polyhedra.h"
#include "detection/shapes/box.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using namespace epafi::testing;

namespace {

/// Loose triangles of random size and place.
TriangleSurface soup(Random& random, std::uint32_t n, double size) {
  TriangleSurface s;
  for (std::uint32_t k = 0; k < n; ++k) {
    const Vec3 at = random_point(random);
    for (int i = 0; i < 3; ++i) s.vertices.push_back(at + size * random_point(random));
    s.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  return s;
}
Aabb box_of(const TriangleMesh& m, std::size_t t) {
  Aabb box;
  for (const auto v : m.triangles[t]) box.include(m.vertices[v]);
  return box;
}

}  // namespace

TEST_CASE("the tree finds what testing every triangle finds, in ascending order", "[detection][triangle-mesh]") {
  Random random(41, 0);
  for (const std::uint32_t n : {1u, 4u, 5u, 63u, 1000u}) {
    const TriangleMesh mesh = TriangleMesh::from_surface(soup(random, n, 0.1));
    std::vector<std::uint32_t> found;
    for (int k = 0; k < 200; ++k) {
      const Vec3 at = random_point(random, -1.2, 1.2);
      const Vec3 half = random_point(random, 0, k % 10 == 0 ? 1.0 : 0.1);
      const Aabb box{at - half, at + half};
      found.assign(1, 7u);  // what was there stays
      mesh.query(box, found);
      std::vector<std::uint32_t> expected{7u};
      for (std::uint32_t t = 0; t < n; ++t)
        if (box_of(mesh, t).overlaps(box)) expected.push_back(t);
      CHECK(found == expected);
    }
  }
}

TEST_CASE("oriented boxes find every triangle that a turned body touches, and few others",
          "[detection][triangle-mesh]") {
  Random random(43, 0);
  std::size_t by_axes = 0, by_sides = 0;
  for (const std::uint32_t n : {1u, 4u, 63u, 1000u}) {
    const TriangleSurface surface = soup(random, n, 0.05);
    const TriangleMesh mesh = TriangleMesh::from_surface(surface);
    TriangleMesh oriented = TriangleMesh::from_surface(surface);
    oriented.orient_boxes();
    for (int k = 0; k < 100; ++k) {
      const Box rod(Vec3(0.4, 0.02, 0.02));
      const Pose pose{random_point(random), random_turn(random)};
      std::vector<std::uint32_t> plain, found(1, 7u);
      mesh.find_near(rod, pose, 0.0, plain);
      oriented.find_near(rod, pose, 0.0, found);
      REQUIRE(found.front() == 7u);  // what was there stays
      CHECK(std::is_sorted(found.begin() + 1, found.end()));
      for (const std::uint32_t t : plain) {
        bool touches = false;  // corners and points of the triangle inside the rod
        for (int i = 0; i < 40 && !touches; ++i) {
          double u = random.uniform(), v = random.uniform();
          if (u + v > 1.0) {
            u = 1.0 - u;
            v = 1.0 - v;
          }
          const auto c = mesh.corners(t);
          touches = (pose.to_local(c[0] + u * (c[1] - c[0]) + v * (c[2] - c[0])).cwiseAbs().array() <=
                     Vec3(0.4, 0.02, 0.02).array())
                        .all();
        }
        if (touches) CHECK(std::binary_search(found.begin() + 1, found.end(), t));
      }
      by_axes += plain.size();
      by_sides += found.size() - 1;
    }
  }
  INFO(by_axes << " candidates by boxes along the axes, " << by_sides << " by oriented ones");
  CHECK(by_sides < by_axes / 2);
}

TEST_CASE("two oriented boxes meet exactly where their polyhedra do", "[detection][triangle-mesh]") {
  Random random(44, 0);
  int meeting = 0;
  for (int k = 0; k < 4000; ++k) {
    const auto draw = [&] {
      const Vec3 half(random.uniform(0.01, 0.5), random.uniform(0.01, 0.5), k % 5 ? random.uniform(0.01, 0.5) : 0.0005);
      return std::pair(Box(half), Pose{random_point(random), k % 7 ? random_turn(random) : Quat(1, 0, 0, 0)});
    };
    const auto [a, pose_a] = draw();
    const auto [b, pose_b] = draw();
    const double gap = polyhedron_distance(PolyhedronPair(a.view(), b.view(), pose_a, pose_b)).axis.gap;
    if (std::abs(gap) < 1e-9) continue;
    const bool meet = overlap(OrientedBox::placed(a.bounding_box({}), pose_a, 0.0),
                              OrientedBox::placed(b.bounding_box({}), pose_b, 0.0));
    CHECK(meet == (gap < 0.0));
    meeting += meet;
  }
  CHECK(meeting > 300);
}

TEST_CASE("triangles that lie on top of each other are one", "[detection][triangle-mesh]") {
  TriangleSurface s{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}};
  for (int k = 0; k < 100; ++k) s.triangles.push_back({0, 1, 2});
  const TriangleMesh mesh = TriangleMesh::from_surface(s);
  std::vector<std::uint32_t> found;
  mesh.query({Vec3(0, 0, -1), Vec3(1, 1, 1)}, found);
  CHECK(found.size() == 1);
  CHECK(mesh.edge_kinds[0][0] == EdgeKind::open);
}

TEST_CASE("triangles that lie over each other do not break the tree", "[detection][triangle-mesh]") {
  TriangleSurface s;
  for (std::uint32_t k = 0; k < 100; ++k) {
    for (const Vec3& v : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)}) s.vertices.push_back(v + 0.01 * k * v);
    s.triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  const TriangleMesh mesh = TriangleMesh::from_surface(s);
  std::vector<std::uint32_t> found;
  mesh.query({Vec3(-1, -1, -1), Vec3(3, 3, 1)}, found);
  CHECK(found.size() == mesh.triangles.size());
  CHECK(found.size() >= 100);
}

TEST_CASE("edges of a closed box are convex, its diagonals flat, from inside concave", "[detection][triangle-mesh]") {
  Random random(42, 0);
  auto s = moved(box_surface({1, 2, 3}), random_turn(random), random_point(random));
  const TriangleMesh box = TriangleMesh::from_surface(s);
  int flat = 0, convex = 0;
  for (const auto& kinds : box.edge_kinds)
    for (const auto kind : kinds) {
      flat += kind == EdgeKind::flat;
      convex += kind == EdgeKind::convex;
    }
  CHECK(flat == 12);    // 6 diagonals, seen twice
  CHECK(convex == 24);  // 12 edges, seen twice
  for (auto& t : s.triangles) std::swap(t[1], t[2]);
  const TriangleMesh room = TriangleMesh::from_surface(s);
  int concave = 0;
  for (const auto& kinds : room.edge_kinds)
    for (const auto kind : kinds) concave += kind == EdgeKind::concave;
  CHECK(concave == 24);
}

TEST_CASE("flat groups are the faces of a polyhedron and never creep round a curve", "[detection][triangle-mesh]") {
  const TriangleMesh box = TriangleMesh::from_surface(box_surface({1, 2, 3}));
  CHECK(box.face == std::vector<std::uint32_t>{0, 0, 2, 2, 4, 4, 6, 6, 8, 8, 10, 10});
  // 20000 sides: 3e-4 rad from side to side, well above what counts as flat; each side is its own pair of triangles
  const TriangleMesh drum = TriangleMesh::from_surface(prism_surface(20000, 1, 1));
  std::size_t groups = 0;
  for (std::uint32_t t = 0; t < drum.triangles.size(); ++t) groups += drum.face[t] == t;
  CHECK(groups == 20002);
}

TEST_CASE("neighbours are mutual and open edges have none", "[detection][triangle-mesh]") {
  const TriangleSurface s{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const TriangleMesh m = TriangleMesh::from_surface(s);
  CHECK(m.neighbours[0] == std::array<std::uint32_t, 3>{TriangleMesh::none, TriangleMesh::none, 1});
  CHECK(m.neighbours[1] == std::array<std::uint32_t, 3>{0, TriangleMesh::none, TriangleMesh::none});
  CHECK(m.edge_kinds[0][2] == EdgeKind::flat);
  CHECK(m.edge_kinds[0][0] == EdgeKind::open);
  CHECK(m.normals[0] == Vec3(0, 0, 1));
}

TEST_CASE("the box of a turned mesh contains it and the box of an aligned one fits", "[detection][triangle-mesh]") {
  Random random(43, 0);
  const TriangleMesh mesh = TriangleMesh::from_surface(soup(random, 50, 0.5));
  for (int k = 0; k < 50; ++k) {
    const Pose pose{random_point(random), random_turn(random)};
    const Aabb box = mesh.bounding_box(pose).fattened(1e-14);
    for (const Vec3& v : mesh.vertices) {
      CHECK(box.contains({pose.to_world(v), pose.to_world(v)}));
      CHECK(v.norm() <= mesh.bounding_radius());
    }
    const Aabb world{random_point(random, -1, 0), random_point(random, 0, 1)};
    const Aabb local = box_in_body_axes(world, pose).fattened(1e-14);
    const Vec3 p = world.min + (world.max - world.min).cwiseProduct(random_point(random, 0, 1));
    CHECK(local.contains({pose.to_local(p), pose.to_local(p)}));
  }
  const TriangleMesh box = TriangleMesh::from_surface(box_surface({1, 2, 3}));
  CHECK(box.bounding_box({}).max == Vec3(1, 2, 3));
  CHECK(box.mass_properties().mass == Approx(48).epsilon(1e-14));
  CHECK(box.contact_radius() == infinity);
}
