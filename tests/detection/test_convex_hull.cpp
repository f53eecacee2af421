#include "detection/shapes/convex_hull.h"

#include <algorithm>

#include "tests/support/catch.h"
#include "tests/support/polyhedra.h"

using namespace epafi;

TEST_CASE("a cube given as triangles becomes six squares", "[detection][hull]") {
  const auto surface = testing::box_surface({1, 2, 3});
  std::vector<std::vector<std::uint32_t>> faces;
  for (const auto& t : surface.triangles) faces.push_back({t[0], t[1], t[2]});
  const auto built = ConvexHull::from_faces(surface.vertices, faces);
  REQUIRE(built.problem.empty());
  const ConvexHull& h = built.hull;
  CHECK(h.vertices.size() == 8);
  CHECK(h.face_normals.size() == 6);
  CHECK(h.edges.size() == 12);
  CHECK(h.volume == Approx(48.0).epsilon(1e-15));
  CHECK(h.inertia(0, 0) == Approx(48.0 / 3.0 * (4 + 9)).epsilon(1e-14));  // m/3 (b^2 + c^2), half lengths
  CHECK(std::abs(h.inertia(0, 1)) < 1e-12);
  CHECK(h.inner_radius == 1.0);
  CHECK(h.radius == Approx(std::sqrt(14.0)).epsilon(1e-15));
  for (std::size_t f = 0; f < 6; ++f) CHECK(h.face_begin[f + 1] - h.face_begin[f] == 4);
  for (std::size_t v = 0; v < 8; ++v) CHECK(h.fan_begin[v + 1] - h.fan_begin[v] == 3);
}

TEST_CASE("each edge lies between its two faces", "[detection][hull]") {
  Random random(41, 0);
  for (int k = 0; k < 20; ++k) {
    const ConvexHull h = support::random_hull(random, 8 + static_cast<std::size_t>(5 * k));
    CHECK(h.vertices.size() + h.face_normals.size() == h.edges.size() + 2);
    for (const auto& e : h.edges) {
      for (const std::uint32_t v : {e.from, e.to}) {
        for (const std::uint32_t f : {e.left, e.right}) {
          CHECK(std::abs(h.face_normals[f].dot(h.vertices[v]) - h.face_offsets[f]) < 1e-12);
        }
      }
      // Left normal x right normal runs along the edge: what the Gauss arcs rely on.
      CHECK(h.face_normals[e.left].cross(h.face_normals[e.right]).dot(h.vertices[e.to] - h.vertices[e.from]) > 0.0);
    }
  }
}

TEST_CASE("neighbours and faces go round each vertex counter-clockwise", "[detection][hull]") {
  Random random(45, 0);
  for (int k = 0; k < 10; ++k) {
    const ConvexHull h = support::random_hull(random, 8 + static_cast<std::size_t>(9 * k));
    CHECK(h.neighbour_begin == h.fan_begin);
    CHECK(h.fans.size() == 2 * h.edges.size());
    for (std::uint32_t v = 0; v < h.vertices.size(); ++v) {
      const std::uint32_t begin = h.fan_begin[v], count = h.fan_begin[v + 1] - begin;
      for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t to = h.neighbours[begin + i], from = h.neighbours[begin + (i + 1) % count];
        const std::uint32_t f = h.fans[begin + i];  // its loop comes from the one and goes to the other
        std::vector<std::uint32_t> loop(h.face_vertices.begin() + h.face_begin[f],
                                        h.face_vertices.begin() + h.face_begin[f + 1]);
        std::rotate(loop.begin(), std::ranges::find(loop, v), loop.end());
        CHECK(loop[0] == v);
        CHECK(loop[1] == to);
        CHECK(loop.back() == from);
      }
    }
  }
}

TEST_CASE("hill climbing finds the height that a scan finds", "[detection][hull]") {
  Random random(42, 0);
  const ConvexHull h = support::random_hull(random, 400, {1, 0.5, 0.2});
  for (int k = 0; k < 2000; ++k) {
    const Vec3 d = testing::random_direction(random);
    double height = -infinity;
    for (const Vec3& v : h.vertices) height = std::max(height, d.dot(v));
    const auto start = static_cast<std::uint32_t>(random.bits() % h.vertices.size());
    CHECK(d.dot(h.vertices[ConvexHull::support_vertex(h.view(), d, start)]) == height);
  }
}

TEST_CASE("a hull of ten thousand vertices is climbed to the height that a scan finds", "[detection][hull]") {
  Random random(44, 0);
  const ConvexHull h = support::random_hull(random, 10000, {1, 0.5, 0.2});
  CHECK(h.vertices.size() > 9900);
  std::uint32_t last = 0;
  for (int k = 0; k < 300; ++k) {
    const bool along_axis = k < 6;
    const Vec3 d = along_axis ? Vec3((k % 2 ? 1.0 : -1.0) * Vec3::Unit(k / 2)) : testing::random_direction(random);
    double height = -infinity;
    for (const Vec3& v : h.vertices) height = std::max(height, d.dot(v));
    CHECK(d.dot(h.support(d)) == height);
    last = ConvexHull::climb(h.view(), d, last);
    CHECK(d.dot(h.vertices[last]) == height);
  }
}

TEST_CASE("the box that holds a turned hull touches it on all sides", "[detection][hull]") {
  Random random(43, 0);
  for (const std::size_t points : {12u, 200u}) {
    ConvexHull h = support::random_hull(random, points);
    h.sweep = 0.125;
    const Pose pose{testing::random_point(random), testing::random_turn(random)};
    Aabb exact;
    for (const Vec3& v : h.vertices) exact.include(pose.to_world(v));
    const Aabb box = h.bounding_box(pose);
    CHECK((box.min - (exact.min - Vec3::Constant(0.125))).norm() < 1e-15 * 8);
    CHECK((box.max - (exact.max + Vec3::Constant(0.125))).norm() < 1e-15 * 8);
  }
}

TEST_CASE("surfaces that are not convex bodies are refused by name", "[detection][hull]") {
  const std::vector<Vec3> v{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  const auto problem = [&](std::vector<Vec3> vertices, const std::vector<std::vector<std::uint32_t>>& faces) {
    return ConvexHull::from_faces(std::move(vertices), faces).problem;
  };
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  CHECK(problem(v, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}).empty());
  CHECK(has(problem(v, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}}), "at least 4"));
  CHECK(has(problem(v, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 2, 3}}), "same direction"));
  CHECK(has(problem(v, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 7}}), "names vertex 7"));
  CHECK(has(problem(v, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3}}), "has 2 vertices"));
  CHECK(has(problem(v, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}), "convex"));  // inside out
  auto shifted = v;
  for (Vec3& p : shifted) p += Vec3(5, 0, 0);
  CHECK(has(problem(shifted, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}), "origin is not inside"));
  auto broken = v;
  broken[2].y() = std::numeric_limits<double>::quiet_NaN();
  CHECK(has(problem(broken, {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}), "vertex 2 is not finite"));
  // A cube with one corner pushed in.
  auto dented = testing::box_surface({1, 1, 1});
  dented.vertices[7] = Vec3(0.1, 0.1, 0.1);
  std::vector<std::vector<std::uint32_t>> faces;
  for (const auto& t : dented.triangles) faces.push_back({t[0], t[1], t[2]});
  CHECK(has(problem(dented.vertices, faces), "not convex"));
}
