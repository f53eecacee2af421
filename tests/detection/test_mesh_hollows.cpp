// Balls and other round bodies inside concave polygons of triangles: the force is continuous wherever they are pressed
// or roll.
#include "detection/shapes/capsule.h"
#include "detection/shapes/cylinder.h"
#include "detection/shapes/ellipsoid.h"
#include "detection/shapes/hull_from_points.h"
#include "tests/detection/mesh_floors.h"
#include "tests/support/pair_errors.h"

using namespace epafi;
using namespace epafi::testing;

namespace {

/// What a file holds of a tube of `sides` plane sides around z, of inner radius 1, between z = -1 and 1: corners that
/// triangles share or not, in double or single precision, seen from either side.
TriangleSurface tube_surface(Random& random, int sides, bool shared, bool single) {
  TriangleSurface s;
  const auto rows = static_cast<int>(1 + random.bits() % 4);
  const double outer = 1.0 / std::cos(pi / sides);
  const bool turned = random.bits() % 2 == 0;
  const auto corner = [&](int i, int j) {
    const double angle = 2.0 * pi * (i % sides) / sides;
    const Vec3 x(outer * std::cos(angle), outer * std::sin(angle), -1.0 + 2.0 * j / rows);
    return single ? Vec3(x.cast<float>().cast<double>()) : x;
  };
  const auto number = [&](int i, int j) { return static_cast<std::uint32_t>(j * sides + i % sides); };
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i < sides; ++i) s.vertices.push_back(corner(i, j));
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < sides; ++i) {
      const auto a = number(i, j), b = number(i + 1, j), c = number(i + 1, j + 1), d = number(i, j + 1);
      if (random.bits() % 2 == 0)
        s.triangles.insert(s.triangles.end(), {{a, b, c}, {a, c, d}});
      else
        s.triangles.insert(s.triangles.end(), {{b, c, d}, {b, d, a}});
    }
  if (turned)
    for (Triangle& t : s.triangles) std::swap(t[1], t[2]);
  return shared ? s : with_loose_corners(s);
}

/// Force of springs N = overlap^power, as seen by the ball.
Vec3 force_of(const ContactSet& contacts, double power) {
  Vec3 force = Vec3::Zero();
  for (std::size_t k = 0; k < contacts.size(); ++k)
    if (contacts.gap[k] < 0.0) force -= std::pow(-contacts.gap[k], power) * contacts.normal[k];
  return force;
}

/// A body that touches the polygon with `ends` points of radius `radius` is carried around in it, at one overlap.
struct Rolling {
  int sides, ends;
  double radius, overlap;

  template <class S>
  void check(const S& shape, Random& random) const {
    const bool single = random.bits() % 2 == 0;
    const double precision = single ? 1.2e-7 : 0.0;
    const std::array<TriangleMesh, 2> meshes{
        TriangleMesh::from_surface(tube_surface(random, sides, true, single), precision),
        TriangleMesh::from_surface(tube_surface(random, sides, false, single), precision)};
    const double z = random.uniform(-0.3, 0.3), start = random.uniform(0, 2 * pi), bend = 2.0 * pi / sides;
    const auto body_at = [&](double angle) {
      const double from_middle = std::remainder(angle - 0.5 * bend, bend);  // of the side
      const double away = (1.0 - radius + overlap) / std::cos(from_middle);
      return Pose{{away * std::cos(angle), away * std::sin(angle), z}, Quat(1, 0, 0, 0)};
    };
    const int steps = 300;
    const double step = 1.5 * bend / steps, moved = step * (1.0 - radius + overlap) / std::cos(0.5 * bend) / overlap;
    std::array<Vec3, 2> before{};
    double jump = 0.0, differ = 0.0;
    std::size_t most = 0;
    for (int k = 0; k <= steps; ++k) {
      const Pose body = body_at(start + step * k);
      const ContactSet one = contacts_with(shape, body, meshes[0]), other = contacts_with(shape, body, meshes[1]);
      most = std::max(most, one.size());
      differ = std::max(differ, (force_of(one, 1.0) - force_of(other, 1.0)).norm() / overlap);
      for (const double power : {1.0, 1.5}) {
        Vec3& last = before[power > 1.0];
        const Vec3 force = force_of(one, power) / std::pow(overlap, power);
        if (k > 0) jump = std::max(jump, (force - last).norm());
        last = force;
      }
    }
    INFO(S::name << ": " << sides << " sides, R " << radius << ", overlap " << overlap / radius << " R");
    CHECK(jump < 3.5 * ends * moved);  // stiffness 1 or, of N = overlap^1.5, 1.5: of each of two contacts
    CHECK(differ < 1e-6 * ends);
    if (sides >= 20) CHECK(most == static_cast<std::size_t>(ends));
  }
};

/// Half of the draws have few sides.
Rolling random_rolling(Random& random, int draw, int least, int ends) {
  const int sides = least + static_cast<int>(draw % 2 == 0 ? random.bits() % 20 : random.bits() % 189);
  const double radius = random.uniform(0.05, 0.95), overlap = radius * std::pow(10.0, random.uniform(-3.0, -1.302));
  return {sides, ends, radius, overlap};
}

}  // namespace

TEST_CASE("the force on a ball inside a polygon of 12 to 200 sides is continuous up to overlaps of a twentieth of R",
          "[detection][mesh-pairs]") {
  Random random(641, 0);
  for (int draw = 0; draw < 60; ++draw) {
    INFO("draw " << draw);
    const Rolling rolling = random_rolling(random, draw, 12, 1);
    rolling.check(Sphere{rolling.radius}, random);
  }
}

TEST_CASE("capsules, cylinders and ellipsoids along a polygon touch its smooth side as balls do",
          "[detection][mesh-pairs]") {
  Random random(645, 0);
  for (int draw = 0; draw < 45; ++draw) {
    INFO("draw " << draw);
    const Rolling rolling = random_rolling(random, draw, 20, draw % 3 == 2 ? 1 : 2);
    const double r = rolling.radius, length = random.uniform(0.3, 1.0);
    if (draw % 3 == 0) rolling.check(Capsule(r, std::max(length, 0.3 * r)), random);
    if (draw % 3 == 1) rolling.check(Cylinder(r, length), random);
    if (draw % 3 == 2) rolling.check(Ellipsoid({r, r, random.uniform(0.3, 1.0) * r}), random);
  }
}

TEST_CASE("the force on a ball that is pressed anywhere into a bowl of random triangles is continuous",
          "[detection][mesh-pairs]") {
  Random random(642, 0);
  std::vector<Vec3> points;
  for (int k = 0; k < 1500; ++k) points.push_back(random_direction(random));
  const HullSurface hull = hull_from_points(points);
  const TriangleMesh bowl = TriangleMesh::from_surface({hull.vertices, triangles_of(hull)});
  int touching = 0;
  for (int draw = 0; draw < 60; ++draw) {
    const double radius = random.uniform(0.2, 0.9), depth = radius * random.uniform(0.01, 0.05);
    const Vec3 way = random_direction(random), aside = way.cross(random_direction(random)).normalized();
    Vec3 before = Vec3::Zero();
    for (int k = 0; k <= 200; ++k) {
      const double along = 1e-5 * radius * k;
      const Vec3 at = (1.0 - radius + depth) * way + along * (draw % 2 == 0 ? aside : way);
      const Vec3 force = force_of(contacts_with(Sphere{radius}, {at, Quat(1, 0, 0, 0)}, bowl), 1.0);
      INFO("draw " << draw << ", step " << k);
      if (k > 0) CHECK((force - before).norm() < 1.01e-5 * radius);  // a distance changes by no more than the place
      before = force;
      touching += force.norm() > 0.5 * depth;
    }
  }
  CHECK(touching > 11000);
}

TEST_CASE("a ball at the edge of a blade touches neither the planes of its far side nor anything deeper",
          "[detection][mesh][hollow]") {
  Random random(518, 0);
  for (int k = 0; k < 100; ++k) {
    // thin and of many corners: bends of a few degrees on both sides, which are hollow from behind
    const ConvexHull blade =
        support::random_hull(random, 20 + random.bits() % 30, {1.0, 1.0, random.uniform(0.02, 0.2)});
    const TriangleMesh mesh = support::surface_of(blade);
    for (const HullEdge& edge : blade.edges) {
      const double radius = std::pow(10.0, random.uniform(-1.5, 0.5)), depth = radius * random.uniform(1e-6, 0.01);
      const Vec3 &from = blade.vertices[edge.from], &to = blade.vertices[edge.to];
      const double along = random.uniform(), across = random.uniform();
      const Vec3 out =
          ((1.0 - across) * blade.face_normals[edge.left] + across * blade.face_normals[edge.right]).normalized();
      const Pose ball{Vec3(from + along * (to - from) + (radius - depth) * out), Quat(1, 0, 0, 0)};
      for (const double reach : {0.0, 1e-3 * radius}) {  // springs, and rigid laws
        const ContactSet contacts = contacts_with(Sphere{radius}, ball, mesh, {}, reach);
        REQUIRE(contacts.size() > 0);
        CHECK(*std::ranges::min_element(contacts.gap) == Approx(-depth).margin(1e-12));
      }
    }
  }
}
