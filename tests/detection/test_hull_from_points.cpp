#include "detection/shapes/hull_from_points.h"

#include <algorithm>
#include <set>

#include "detection/mass_properties.h"
#include "detection/shapes/convex_hull.h"
#include "detection/shapes/mesh_file.h"
#include "detection/shapes/placed_hull.h"
#include "detection/shapes/rounded_shapes.h"
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
  for (int k = 0; k < 40; ++k) {
    more.push_back(points[static_cast<std::size_t>(k)]);
    more.push_back(0.3 * random_direction(random));
  }
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

namespace {

Vec3 in_single_precision(const Vec3& x) { return x.cast<float>().cast<double>(); }

/// As MeshReport::precision: half of the last bit of the largest coordinate.
double single_precision_of(const std::vector<Vec3>& points) {
  double largest = 0.0;
  for (const Vec3& x : points) largest = std::max(largest, x.cwiseAbs().maxCoeff());
  return std::ldexp(largest, -24);
}

/// The farthest that a point lies outside of the built hull of the others [m].
double farthest_outside(const ConvexHull& hull, const PrincipalFrame& frame, const std::vector<Vec3>& points) {
  double farthest = -infinity;
  for (const Vec3& x : points)
    for (std::size_t f = 0; f < hull.face_normals.size(); ++f)
      farthest = std::max(farthest, hull.face_normals[f].dot(frame.to_principal(x)) - hull.face_offsets[f]);
  return farthest;
}

}  // namespace

TEST_CASE("a cut block in single precision has six faces, turned and up to 100 m away", "[detection][hull]") {
  Random random(27, 0);
  for (int run = 0; run < 200; ++run) {
    const Quat turn = random_turn(random);
    const Vec3 shift = random_point(random, -1, 1) * (run % 4 == 0 ? 0.0 : std::pow(10.0, random.uniform(-1, 2)));
    const Vec3 size = random_point(random, 0.3, 2);
    const int cuts = 1 + run % 5;
    std::vector<Vec3> points;
    for (int i = 0; i <= cuts; ++i)
      for (int j = 0; j <= cuts; ++j)
        for (int k = 0; k <= cuts; ++k)
          points.push_back(in_single_precision(turn * (Vec3(i, j, k) / cuts).cwiseProduct(size) + shift));
    const double precision = single_precision_of(points);
    HullSurface hull = hull_from_points(points, {}, precision);
    CHECK(hull.vertices.size() == 8);
    CHECK(hull.faces.size() == 6);
    const MassProperties whole = surface_mass_properties(hull.vertices, triangles_of(hull));
    // corners are off by the rounding of three coordinates, sides by as much over their length
    CHECK(whole.mass == Approx(size.prod()).epsilon(20 * precision / size.minCoeff()));
    const PrincipalFrame frame = principal_frame(whole);
    for (Vec3& v : hull.vertices) v = frame.to_principal(v);
    const auto b = built_hull(hull);
    REQUIRE(b.problem == "");
    CHECK(b.hull.face_normals.size() == 6);
    CHECK(farthest_outside(b.hull, frame, points) < 8 * precision);
  }
}

TEST_CASE("a round body of quadrilaterals keeps its corners and has one face each", "[detection][hull]") {
  constexpr int rows = 16, sides = 64;  // 962 corners, of which exact predicates see every quadrilateral bent
  Random random(28, 0);
  for (const bool single : {false, true}) {
    const Quat turn = random_turn(random);
    std::vector<Vec3> points{turn * Vec3(0, 0, 1), turn * Vec3(0, 0, -1)};
    for (int i = 1; i < rows; ++i)
      for (int k = 0; k < sides; ++k) {
        const double down = pi * i / rows, around = 2 * pi * k / sides, r = std::sin(down);
        points.push_back(turn * Vec3(r * std::cos(around), r * std::sin(around), std::cos(down)));
      }
    if (single) std::ranges::transform(points, points.begin(), in_single_precision);
    HullSurface hull = hull_from_points(points, {}, single ? single_precision_of(points) : 0.0);
    CHECK(hull.vertices.size() == points.size());
    const PrincipalFrame frame = principal_frame(surface_mass_properties(hull.vertices, triangles_of(hull)));
    for (Vec3& v : hull.vertices) v = frame.to_principal(v);
    const auto b = built_hull(hull);
    REQUIRE(b.problem == "");
    CHECK(b.hull.face_normals.size() == rows * sides);
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
    flat.push_back({x, y, 1.0 - x + 0.5 * y});
    line.push_back({x, 2 * x, -x});
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
