#include "viz_export/vtk/surface.h"

#include <map>

#include "detection/shapes/hull_from_points.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

/// Volume inside a closed surface: sum over the fans of its polygons of det(a, b, c) / 6.
double volume(const Surface& s) {
  double six = 0.0;
  for (std::size_t f = 0, k = 0; f < s.offsets.size(); ++f) {
    const auto end = static_cast<std::size_t>(s.offsets[f]);
    const auto corner = [&](std::size_t i) -> const Vec3& {
      return s.points[static_cast<std::size_t>(s.connectivity[i])];
    };
    for (std::size_t i = k + 1; i + 1 < end; ++i) six += corner(k).dot(corner(i).cross(corner(i + 1)));
    k = end;
  }
  return six / 6.0;
}

/// Directed edges that lack their opposite: none in a closed, consistently oriented surface.
std::size_t open_edges(const Surface& s) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (std::size_t f = 0, k = 0; f < s.offsets.size(); ++f) {
    const auto end = static_cast<std::size_t>(s.offsets[f]);
    for (std::size_t i = k; i < end; ++i) {
      const std::int32_t from = s.connectivity[i], to = s.connectivity[i + 1 < end ? i + 1 : k];
      ++edges[{from, to}];
      --edges[{to, from}];
    }
    k = end;
  }
  std::size_t open = 0;
  for (const auto& [edge, count] : edges) open += count != 0;
  return open;
}

}  // namespace

TEST_CASE("drawn surfaces are closed, turned outward and enclose the shape's volume", "[viz_export][surface]") {
  ShapeStore shapes;
  const auto check = [&](auto shape, double lost) {
    const double exact = shape.mass_properties().mass;  // at density 1
    const Surface s = surface_of(shapes, shapes.add(std::move(shape)), 1.0);
    CHECK(open_edges(s) == 0);
    CHECK(volume(s) <= exact * (1 + 1e-12));
    CHECK(volume(s) >= exact * (1 - lost));
  };
  check(Box(Vec3(0.5, 1, 2)), 1e-12);
  // a circle of 12 corners lacks 1 - sin(pi/6) 12/(2 pi) = 4.5 % of its area; a ball of 12 x 6 such strips 11 %
  check(Cylinder{0.5, 2.0}, 0.046);
  check(Capsule{0.5, 2.0}, 0.12);
  check(Ellipsoid{Vec3(0.5, 1, 2)}, 0.12);
  // the sharper its edges, the nearer a superquadric is to a box, of which nothing is lost
  for (const int exponent : {2, 3, 4, 8, 16, 32}) check(Superquadric(Vec3(0.5, 1, 2), exponent, exponent), 0.12);
}

TEST_CASE("a box is drawn with its six faces of four corners and a sphere without a surface", "[viz_export][surface]") {
  ShapeStore shapes;
  const Surface box = surface_of(shapes, shapes.add(Box(Vec3(1, 1, 1))), 1.0);
  CHECK(box.offsets == std::vector<std::int32_t>{4, 8, 12, 16, 20, 24});
  CHECK(box.points.size() == 8);
  CHECK(surface_of(shapes, shapes.add(Sphere{1.0}), 1.0).empty());
}

TEST_CASE("a half-space is drawn as a square of the wanted size around the foot of a point", "[viz_export][surface]") {
  ShapeStore shapes;
  const Surface s = surface_of(shapes, shapes.add(HalfSpace{Vec3::UnitX()}), 4.0, Vec3(7, 2, 3));
  REQUIRE(s.points.size() == 4);
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : s.points) mean += 0.25 * p;
  CHECK((mean - Vec3(0, 2, 3)).norm() < 1e-15);
  for (std::size_t k = 0; k < 4; ++k) CHECK((s.points[k] - s.points[(k + 1) % 4]).norm() == Approx(4.0).epsilon(1e-15));
  const Vec3 normal = (s.points[1] - s.points[0]).cross(s.points[2] - s.points[1]);
  CHECK((normal / 16.0 - Vec3::UnitX()).norm() < 1e-15);
}
