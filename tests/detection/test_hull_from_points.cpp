#include "detection/shapes/hull_from_points.h"

#include <algorithm>
#include <set>

#include "detection/mass_properties.h"
#include "detection/shapes/convex_hull.h"
#include "detection/shapes/mesh_file.h"
#include "detection/shapes/placed_hull.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using namespace epafi::testing;

namespace {

TriangleSurface surface_of(const HullSurface& hull) {
  TriangleSurface s{hull.vertices, {}};
  for (const auto& f : hull.faces) s.triangles.push_back({f[0], f[1], f[2]});
  return s;
}

/// Every triple of points whose plane has all the others on one side: the faces of the hull, by trying all of them.
std::set<std::set<std::uint32_t>> faces_by_brute_force(const std::vector<Vec3>& p) {
  std::set<std::set<std::uint32_t>> faces;
  const auto n = static_cast<std::uint32_t>(p.size());
  for (std::uint32_t a = 0; a < n; ++a)
    for (std::uint32_t b = a + 1; b < n; ++b)
      for (std::uint32_t c = b + 1; c < n; ++c) {
        const Vec3 normal = (p[b] - p[a]).cross(p[c] - p[a]);
        int above = 0, below = 0;
        for (std::uint32_t d = 0; d < n; ++d)
          if (d != a && d != b && d != c) (normal.dot(p[d] - p[a]) > 0 ? above : below)++;
        if (above == 0 || below == 0) faces.insert({a, b, c});
      }
  return faces;
}

/// A polyhedron as the engine wants it: centre of mass at the origin, principal axes.
ConvexHull::Built built(const HullSurface& hull) {
  const PrincipalFrame frame = principal_frame(surface_mass_properties(surface_of(hull)));
  auto vertices = hull.vertices;
  for (Vec3& v : vertices) v = frame.to_principal(v);
  return ConvexHull::from_faces(vertices, hull.faces);
}

}  // namespace

TEST_CASE("random hulls have the faces that trying all triples finds", "[detection][hull]") {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Random random(21, seed);
    std::vector<Vec3> points;
    for (int k = 0; k < 24; ++k) points.push_back(random_point(random));
    const HullSurface hull = hull_from_points(points);
    std::set<std::set<std::uint32_t>> found;
    for (const auto& f : hull.faces) {
      std::set<std::uint32_t> face;
      for (const auto v : f)
        face.insert(
            static_cast<std::uint32_t>(std::find(points.begin(), points.end(), hull.vertices[v]) - points.begin()));
      found.insert(face);
    }
    CHECK(found == faces_by_brute_force(points));
    CHECK(inspect(surface_of(hull)).is_watertight());
    CHECK_FALSE(inspect(surface_of(hull)).is_inverted());
    CHECK(hull.faces.size() == 2 * hull.vertices.size() - 4);  // Euler
  }
}

TEST_CASE("the volume of a random hull agrees with sampling of its planes", "[detection][hull]") {
  Random random(22, 0);
  std::vector<Vec3> points;
  for (int k = 0; k < 30; ++k) points.push_back(random_direction(random));
  const TriangleSurface s = surface_of(hull_from_points(points));
  const int n = 200000;
  int inside = 0;
  for (int k = 0; k < n; ++k) {
    const Vec3 p = random_point(random);
    inside += std::all_of(s.triangles.begin(), s.triangles.end(), [&](const Triangle& t) {
      const Vec3& a = s.vertices[t[0]];
      return (s.vertices[t[1]] - a).cross(s.vertices[t[2]] - a).dot(p - a) <= 0;
    });
  }
  const double share = static_cast<double>(inside) / n;
  // binomial: standard deviation sqrt(p (1 - p) / n); 4 of them
  CHECK(std::abs(surface_mass_properties(s).mass / 8 - share) < 4 * std::sqrt(share * (1 - share) / n));
}

TEST_CASE("order, duplicates and points inside do not change a hull", "[detection][hull]") {
  Random random(23, 0);
  std::vector<Vec3> points;
  for (int k = 0; k < 40; ++k) points.push_back(random_direction(random));
  const HullSurface hull = hull_from_points(points);
  auto more = points;
  for (int k = 0; k < 40; ++k)
    more.push_back(points[static_cast<std::size_t>(k)]), more.push_back(0.3 * random_direction(random));
  std::reverse(more.begin(), more.end());
  const HullSurface again = hull_from_points(more);
  CHECK(again.vertices == hull.vertices);
  CHECK(again.faces == hull.faces);
}

TEST_CASE("a lattice of points gives a box of 8 vertices, turned and anywhere", "[detection][hull][long]") {
  Random random(24, 0);
  for (int run = 0; run < 50; ++run) {
    const Quat turn = run == 0 ? Quat(1, 0, 0, 0) : random_turn(random);
    const Vec3 shift = run == 0 ? Vec3(0, 0, 0) : random_point(random, -3, 3);
    const double size = std::pow(10.0, random.uniform(-6, 3));
    std::vector<Vec3> points;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < 4; ++j)
        for (int k = 0; k < 4; ++k) points.push_back(size * (turn * Vec3(i, j, k) + shift));
    const HullSurface hull = hull_from_points(points);
    CHECK(hull.vertices.size() == 8);
    CHECK(hull.faces.size() == 12);
    CHECK(surface_mass_properties(surface_of(hull)).mass == Approx(27 * size * size * size).epsilon(1e-13));
    const auto b = built(hull);
    CHECK(b.problem == "");
    CHECK(b.hull.face_normals.size() == 6);
  }
}

TEST_CASE("hulls of random points become polyhedra with their mass properties", "[detection][hull]") {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Random random(25, seed);
    std::vector<Vec3> points;
    const int n = 4 + static_cast<int>(random.uniform(0, 60));
    for (int k = 0; k < n; ++k) points.push_back(random_point(random, 2, 3));
    const HullSurface hull = hull_from_points(points);
    const MassProperties m = surface_mass_properties(surface_of(hull));
    const auto b = built(hull);
    REQUIRE(b.problem == "");
    CHECK(b.hull.mass_properties().mass == Approx(m.mass).epsilon(1e-12));
    CHECK((b.hull.mass_properties().inertia.diagonal() - principal_frame(m).moments).norm() < 1e-11 * m.inertia.norm());
  }
}

TEST_CASE("sets without a volume are refused with what is wrong", "[detection][hull]") {
  using Catch::Matchers::Equals;
  const Place place{"pebble.toml", 7, 3};
  const std::vector<Vec3> three{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}};
  CHECK_THROWS_WITH(hull_from_points(three, place),
                    Equals("pebble.toml:7:3: error: a polyhedron needs at least 4 distinct vertices, found 3"));
  std::vector<Vec3> flat, line;
  Random random(26, 0);
  for (int k = 0; k < 20; ++k) {
    const double x = random.uniform(), y = random.uniform();
    flat.push_back({x, y, 1.0 - x + 0.5 * y}), line.push_back({x, 2 * x, -x});
  }
  CHECK_THROWS_WITH(hull_from_points(flat),
                    Equals("error: the vertices of the polyhedron lie on one plane: they enclose no volume"));
  CHECK_THROWS_WITH(hull_from_points(line),
                    Equals("error: the vertices of the polyhedron lie on one line: they enclose no volume"));
  std::vector<Vec3> broken{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::nan("")}};
  CHECK_THROWS_WITH(hull_from_points(broken), Equals("error: vertex 3 of the polyhedron is not finite"));
}

TEST_CASE("a placed hull is where its author put it, in its own principal axes", "[detection][hull]") {
  Random random(27, 0);
  for (int k = 0; k < 20; ++k) {
    std::vector<Vec3> points;
    for (int i = 0; i < 30; ++i) points.push_back(random_point(random, 1, 4));
    const PlacedHull placed = place_hull(points, 0.01);
    CHECK(placed.hull.bounding_radius() == placed.hull.radius + 0.01);
    const Mat3 inertia = placed.hull.mass_properties().inertia;
    CHECK((inertia - Mat3(inertia.diagonal().asDiagonal())).norm() < 1e-12 * inertia.norm());
    for (const Vec3& v : placed.hull.vertices) {  // back in the author's axes it is one of the points
      double nearest = infinity;
      for (const Vec3& p : points) nearest = std::min(nearest, (placed.frame.to_author(v) - p).norm());
      CHECK(nearest < 1e-14);
    }
  }
}

TEST_CASE("a thin plate is still a hull", "[detection][hull]") {
  std::vector<Vec3> plate;
  for (int k = 0; k < 8; ++k) plate.push_back({k & 1 ? 1.0 : 0.0, k & 2 ? 1.0 : 0.0, k & 4 ? 1e-6 : 0.0});
  CHECK(surface_mass_properties(surface_of(hull_from_points(plate))).mass == Approx(1e-6).epsilon(1e-12));
}
