#include "detection/narrow/gjk/epa.h"

#include "detection/narrow/mesh/point_triangle.h"
#include "detection/narrow/mesh/triangle_core.h"
#include "detection/narrow/polyhedra/polyhedra.h"
#include "detection/shapes/box.h"
#include "detection/shapes/capsule.h"
#include "detection/shapes/cylinder.h"
#include "detection/shapes/ellipsoid.h"
#include "tests/support/catch.h"
#include "tests/support/pair_contacts.h"
#include "tests/support/polyhedra.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using support::difference;
using testing::upright;

TEST_CASE("the polytope gives the depth of polyhedra that the features give", "[detection][epa]") {
  Random random(31, 0);
  double worst = 0.0;
  int overlaps = 0;
  for (int k = 0; k < 200; ++k) {
    const ConvexHull a = support::random_hull(random, 6 + static_cast<std::size_t>(k % 20)),
                     b = support::random_hull(random, 12);
    const Pose pb{random.uniform(0, 1.5) * testing::random_direction(random), testing::random_turn(random)};
    const auto axis = separating_axis({a.view(), b.view(), {}, pb});
    if (axis.gap > -1e-3) continue;
    ++overlaps;
    const auto p = epa(difference(a, {}, b, pb));
    CHECK(p.status == Penetration::Status::converged);
    worst = std::max(worst, std::abs(p.upper + axis.gap));
  }
  CHECK(overlaps > 100);
  CHECK(worst < 1e-12);  // the tolerance of the interval
}

TEST_CASE("smooth depths: concentric and coaxial bodies have closed forms", "[detection][epa]") {
  // Two ellipsoids on the z axis, semi-axes 1 and 1.5 there, 2 apart: 0.5 deep, unless leaving sideways were shorter.
  const auto e = epa(difference(Ellipsoid(Vec3(3, 2, 1)), {}, Ellipsoid(Vec3(2, 2, 1.5)), {{0, 0, 2}, upright}), 1e-8);
  CHECK(e.status == Penetration::Status::converged);
  CHECK(e.lower <= 0.5 + 1e-15);
  CHECK(std::abs(e.upper - 0.5) < 3e-8);  // tolerance 1e-8 of size 3
  CHECK(std::abs(e.normal.z() - 1.0) < 1e-6);
  // Cylinder r 1, L 2 standing on another, 0.1 deep.
  const auto c = epa(difference(Cylinder(1, 2), {}, Cylinder(1, 2), {{0.2, 0.1, 1.9}, upright}));
  CHECK(c.status == Penetration::Status::converged);
  CHECK(std::abs(c.upper - 0.1) < 2e-12);
}

TEST_CASE("the interval holds the depth of random smooth bodies, and the direction parts them", "[detection][epa]") {
  Random random(32, 0);
  int tried = 0;
  double widest = 0.0;
  for (int k = 0; k < 100; ++k) {
    const Ellipsoid a(Vec3(random.uniform(0.3, 1), random.uniform(0.3, 1), random.uniform(0.3, 1)));
    const Cylinder b(random.uniform(0.3, 1), random.uniform(0.3, 2));
    const auto m = difference(a, {Vec3::Zero(), testing::random_turn(random)}, b,
                              {random.uniform(0, 1) * testing::random_direction(random), testing::random_turn(random)});
    const auto p = epa(m, 1e-9);
    if (p.upper < 1e-3) continue;
    ++tried;
    widest = std::max(widest, p.upper - p.lower);
    CHECK(p.normal.dot(m.support(p.normal).y) == Approx(p.upper).epsilon(1e-12));
    for (int j = 0; j < 200; ++j) {  // no sampled direction leaves earlier than `lower`
      const Vec3 n = testing::random_direction(random);
      CHECK(n.dot(m.support(n).y) >= p.lower - 1e-12);
    }
  }
  CHECK(tried > 50);
  INFO("widest interval " << widest);
  CHECK(widest < 1e-4);
}

TEST_CASE("crossed segments a rounding apart are left along the way they are apart", "[detection][epa]") {
  const Capsule rod(0.1, 1.0);  // its core: a segment along z
  const Quat along_x(Eigen::AngleAxisd(std::acos(0.0), Vec3::UnitY()));
  for (const double h : {2e-14, -2e-14}) {
    const auto d = difference(rod, {{0, 0, 0}, along_x}, rod, {{0, h, 0}, upright});
    const Penetration p = epa(d);
    const Vec3 normal = along_x * p.normal;
    CHECK(p.status == Penetration::Status::flat);
    CHECK(p.upper == Approx(-2e-14).epsilon(1e-2));  // apart, not inside each other
    CHECK(normal.y() * h > 0.99 * std::abs(h));      // from A to B
  }
}

TEST_CASE("a difference without volume is named flat and left across at once", "[detection][epa]") {
  const Quat across(Eigen::AngleAxisd(2 * std::atan(1.0), Vec3::UnitX()));
  const auto p = epa(difference(Capsule(0.1, 2), {}, Capsule(0.1, 2), {Vec3::Zero(), across}));
  CHECK(p.status == Penetration::Status::flat);
  CHECK(std::abs(p.upper) < 1e-15);
  CHECK(std::abs(std::abs(p.normal.x()) - 1.0) < 1e-12);  // segments along z and y cross: apart along x
}

TEST_CASE("the deepest points are a tip and its foot wherever the tip stands on a face", "[detection][epa]") {
  // Tip of a double pyramid of 6 sides on a wide box: the difference has one wide face, cut into facets by rounding
  // alone.
  std::vector<Vec3> points{{0, 0, -0.5}, {0, 0, 0.5}};
  std::vector<std::vector<std::uint32_t>> faces;
  for (std::uint32_t k = 0; k < 6; ++k) {
    points.emplace_back(0.4 * std::cos(k * std::acos(0.5)), 0.4 * std::sin(k * std::acos(0.5)), 0.0);
    faces.push_back({2 + k, 2 + (k + 1) % 6, 1});
    faces.push_back({2 + (k + 1) % 6, 2 + k, 0});
  }
  const ConvexHull tip = ConvexHull::from_faces(points, faces).hull;
  REQUIRE(tip.vertices.size() == 8);
  const Box floor(Vec3(5, 4, 1));
  Random random(33, 0);
  for (int k = 0; k < 300; ++k) {
    const double depth = k % 3 == 0 ? 0.0 : std::pow(10.0, -random.uniform(3, 13));
    const Vec3 foot(random.uniform(-4, 4), random.uniform(-3, 3), 1.0);
    const Pose pose{foot + Vec3(0, 0, 0.5 - depth), Quat(Eigen::AngleAxisd(random.uniform(0, 3), Vec3::UnitZ()))};
    const auto p = epa(difference(floor, {}, tip, pose));
    CHECK(std::abs(p.upper - depth) < 2e-12 * 6.5);
    CHECK((p.witness_a - foot).norm() < 1e-11);  // a few ulp of 6.5, over the apex of 40 degrees
    CHECK((p.witness_b - (foot - Vec3(0, 0, depth))).norm() < 1e-11);
  }
}

TEST_CASE("a sliver in a box is left by a way that parts them, its deepest points on both", "[detection][epa]") {
  Random random(34, 0);
  for (int k = 0; k < 400; ++k) {
    const Box box(testing::random_point(random, 0.2, 1.0));
    const double thin = std::pow(10.0, random.uniform(-15, -3));
    const Vec3 along = testing::random_direction(random),
               inside = 0.9 * box.half.cwiseProduct(testing::random_point(random));
    const std::array<Vec3, 3> corner{inside - random.uniform(0.5, 5) * along, inside + random.uniform(0.5, 5) * along,
                                     inside + thin * along.unitOrthogonal()};
    const TriangleCore sliver(corner);
    const auto d = difference(box, {}, sliver, {sliver.centre, upright});
    const auto p = epa(d);
    INFO("draw " << k << ", " << thin << " m thin");
    const double size = d.size(), parts = p.normal.dot(d.support(p.normal).y);
    CHECK(p.upper - p.lower < 1e-9 * size);
    CHECK(std::abs(parts - p.upper) < 1e-12 * size);
    const Vec3 on_sliver = p.witness_b;
    CHECK((p.witness_a.cwiseAbs() - box.half).maxCoeff() < 1e-9 * size);
    const double along_it = nearest_on_segment(on_sliver, corner[0], corner[1]);
    CHECK((corner[0] + along_it * (corner[1] - corner[0]) - on_sliver).norm() < 1e-9 * size + thin);
    CHECK((p.witness_a - on_sliver - p.upper * p.normal).norm() < 1e-9 * size);
  }
}
