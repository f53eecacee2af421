#include "detection/narrow/pairs/core_patch.h"

#include <set>

#include "detection/narrow/pairs/hollow_pairs.h"
#include "detection/shapes/all_shapes.h"
#include "tests/support/catch.h"
#include "tests/support/pair_contacts.h"
#include "tests/support/polyhedra.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using support::about, support::contacts, support::deepest;
using testing::pi;
using testing::upright;

namespace {

const Box table(Vec3(1, 1, 0.25));  // its top at z = 0.25

}  // namespace

TEST_CASE("a cylinder that stands on a box stands on four points of its rim", "[detection][core-patch]") {
  const Cylinder can(0.2, 0.6);
  Random random(111, 0);
  for (int k = 0; k < 100; ++k) {
    const double depth = std::pow(10.0, -random.uniform(3, 10));
    const Pose pose{{random.uniform(-0.7, 0.7), random.uniform(-0.7, 0.7), 0.55 - depth},
                    about(Vec3::UnitZ(), random.uniform(0, 6))};
    const ContactSet c = contacts(table, {}, can, pose);
    REQUIRE(c.size() == 4);
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK(std::abs(c.gap[i] + depth) < 1e-15);
      CHECK((c.normal[i] - Vec3(0, 0, 1)).norm() < 1e-12);
      const Vec3 from_axis = c.arm[i] - pose.position;
      CHECK(std::sqrt(from_axis.x() * from_axis.x() + from_axis.y() * from_axis.y()) == Approx(0.2).epsilon(1e-12));
      sum += from_axis;
    }
    CHECK(sum.head<2>().norm() < 0.4);  // around the axis, not to one side of it
    const ContactSet swapped = contacts(can, pose, table, {});
    REQUIRE(swapped.size() == 4);
    for (std::size_t i = 0; i < 4; ++i) CHECK((swapped.normal[i] + Vec3(0, 0, 1)).norm() < 1e-12);
  }
}

TEST_CASE("a tilted cylinder keeps its deepest point exactly, whatever the rim's corners are",
          "[detection][core-patch]") {
  const double r = 0.2, half = 0.3;
  const Cylinder can(r, 2 * half);
  Random random(112, 0);
  for (int k = 0; k < 200; ++k) {
    const double tilt = std::pow(10.0, -random.uniform(0.5, 6)), height = 0.25 + half;
    const Quat turn = about({std::cos(0.1 * k), std::sin(0.1 * k), 0}, tilt) * about(Vec3::UnitZ(), 0.37 * k);
    const ContactSet c = contacts(table, {}, can, {{0.1, -0.2, height}, turn}, 0.05);
    REQUIRE(c.size() >= 1);
    const double exact = height - 0.25 - half * std::cos(tilt) - r * std::sin(tilt);
    CHECK(std::abs(deepest(c) - exact) < 2e-9);  // corners stand for the rim within 1e-9 of the box, 1.4 large
  }
}

TEST_CASE("a capsule and a cylinder that lie on a box rest on two points, cut where they hang over",
          "[detection][core-patch]") {
  const Quat along_x = about(Vec3::UnitY(), std::acos(0.0));
  const auto check = [&](const auto& body) {
    const ContactSet c = contacts(table, {}, body, {{0.1, 0.3, 0.25 + 0.1 - 1e-4}, along_x});
    REQUIRE(c.size() == 2);
    CHECK(std::abs(c.arm[0].x() - c.arm[1].x()) == Approx(0.6).epsilon(1e-9));
    const ContactSet over =
        contacts(table, {}, body, {{0.9, 0.3, 0.25 + 0.1 - 1e-4}, along_x});  // from 0.6 to 1.2: the edge is at 1
    REQUIRE(over.size() == 2);
    CHECK(std::max(over.arm[0].x(), over.arm[1].x()) == Approx(1.0).epsilon(1e-9));
    CHECK(std::min(over.arm[0].x(), over.arm[1].x()) == Approx(0.6).epsilon(1e-9));
    for (const double gap : over.gap) CHECK(std::abs(gap + 1e-4) < 1e-12);
  };
  check(Capsule(0.1, 0.6));
  check(Cylinder(0.1, 0.6));
}

TEST_CASE("names stay while the contact does, and steep bodies touch in one point", "[detection][core-patch]") {
  const Capsule rod(0.1, 0.6);
  const Quat lying = about(Vec3::UnitY(), std::acos(0.0));
  const ContactSet first = contacts(table, {}, rod, {{0, 0, 0.3499}, lying});
  for (int k = 1; k < 50; ++k) {
    const ContactSet c =
        contacts(table, {}, rod, {{0.005 * k, 0.003 * k, 0.3499}, about(Vec3::UnitZ(), 0.01 * k) * lying});
    CHECK(c.feature == first.feature);
  }
  CHECK(contacts(table, {}, rod,
                 {{0, 0, 0.25 + 0.1 + 0.3 * std::sin(0.5) - 1e-3}, about(Vec3::UnitY(), std::acos(0.0) - 0.5)})
            .size() == 1);
  CHECK(contacts(table, {}, rod, {{0, 0, 0.25 + 0.4 - 1e-3}, upright}).size() == 1);
}

namespace {

/// A body whose axis lies at `height` over the upper edge of a beam along x, over `middle`; the beam stands on the
/// opposite edge, its half length is 1.
template <class B>
ContactSet on_beam(const B& body, double middle, double height, const Quat& turn, double reach = 0.0) {
  const Box beam(Vec3(1, 0.2, 0.2));
  const Pose pose{{middle, 0, 0.2 * std::sqrt(2.0) + height}, turn};
  return contacts(beam, {{0, 0, 0}, about(Vec3::UnitX(), std::acos(std::sqrt(0.5)))}, body, pose, reach);
}

}  // namespace

TEST_CASE("a straight side along an edge touches it at both ends of what they share", "[detection][core-patch]") {
  const Quat along_x = about(Vec3::UnitY(), std::acos(0.0));
  Random random(113, 0);
  for (int k = 0; k < 100; ++k) {
    const double radius = random.uniform(0.02, 0.5), length = random.uniform(0.1, 3),
                 middle = random.uniform(-0.8, 0.8), depth = radius * std::pow(10.0, -random.uniform(2, 9)),
                 lean = random.uniform(-0.6, 0.6);
    const auto check = [&](const auto& body) {
      const ContactSet c = on_beam(body, middle, radius - depth, about(Vec3::UnitX(), lean) * along_x);
      REQUIRE(c.size() == 2);
      const auto [low, high] = std::minmax(c.arm[0].x(), c.arm[1].x());
      CHECK(low == Approx(std::max(-1.0, middle - 0.5 * length)).margin(1e-9));
      CHECK(high == Approx(std::min(1.0, middle + 0.5 * length)).margin(1e-9));
      for (std::size_t i = 0; i < 2; ++i) {
        CHECK(std::abs(c.gap[i] + depth) < 1e-12);
        CHECK((c.normal[i] - Vec3(0, 0, 1)).norm() < 1e-5);  // a gap is exact to second order in it
        CHECK(std::abs(c.arm[i].z() - 0.2 * std::sqrt(2.0) + 0.5 * depth) < 1e-9);
      }
    };
    check(Capsule(radius, length));
    check(Cylinder(radius, length));
  }
}

TEST_CASE("an end across an edge touches it at both rims, a side across it in one point", "[detection][core-patch]") {
  Random random(114, 0);
  for (int k = 0; k < 100; ++k) {
    const double radius = random.uniform(0.02, 0.5), half = random.uniform(0.05, 1), middle = random.uniform(-0.4, 0.4),
                 depth = radius * std::pow(10.0, -random.uniform(3, 9)), across = random.uniform(0.2, 1.3);
    const Quat any = about(Vec3::UnitZ(), random.uniform(0, 6));
    const ContactSet end = on_beam(Cylinder(radius, 2 * half), middle, half - depth, any);
    REQUIRE(end.size() == 2);
    CHECK(std::abs(end.arm[0].x() - end.arm[1].x()) > 1.84 * radius);  // an octagon stands for the rim
    for (const double gap : end.gap) CHECK(std::abs(gap + depth) < 1e-12);
    const Quat crossed = about(Vec3::UnitZ(), across) * about(Vec3::UnitY(), std::acos(0.0));
    CHECK(on_beam(Cylinder(radius, 2 * half), middle, radius - depth, crossed).size() == 1);
    CHECK(on_beam(Capsule(radius, 2 * half), middle, radius - depth, crossed).size() == 1);
  }
}

namespace {

/// A prism of height 0.4 around z over `sides` corners on a circle.
ConvexHull prism(int sides, double radius) {
  std::vector<Vec3> corners;
  for (const double z : {-0.2, 0.2})
    for (int k = 0; k < sides; ++k)
      corners.push_back(about(Vec3::UnitZ(), 2.0 * pi * k / sides) * Vec3(radius, 0, 0) + Vec3(0, 0, z));
  const HullSurface surface = hull_from_points(corners);
  return ConvexHull::from_faces(surface.vertices, surface.faces).hull;
}

std::set<Feature> names_of(const ContactSet& c) { return {c.feature.begin(), c.feature.end()}; }

}  // namespace

TEST_CASE("a prism on a round end stands on all its corners, or on the same four whatever rounding says",
          "[detection][core-patch]") {
  Random random(115, 0);
  for (int k = 0; k < 60; ++k) {
    const int sides = 3 + static_cast<int>(random.bits() % 10);
    const ConvexHull body = prism(sides, random.uniform(0.1, 0.5));
    const Pose at{testing::random_point(random), testing::random_turn(random)};
    const auto stands_on = [&](const auto& wall, double top) {
      const Vec3 place(random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), top + 0.2 - 1e-4);
      const Quat yaw = about(Vec3::UnitZ(), random.uniform(0, 2 * pi));
      const auto meet = [&](double reach) {
        const Quat tremble = about(testing::random_direction(random), 1e-10);
        const Pose there{at.to_world(place), at.orientation * tremble * yaw};
        ContactSet set;
        ContactSink sink(set);
        sink.begin(0, 1);
        if constexpr (HollowShape<std::decay_t<decltype(wall)>>)
          collide_closed(body, wall, PairQuery{there, at, reach}, sink);
        else
          collide(body, wall, PairQuery{there, at, reach}, sink);
        sink.end();
        return set;
      };
      const ContactSet all = meet(0.0);
      CHECK(all.size() == static_cast<std::size_t>(sides));
      for (const double gap : all.gap) CHECK(std::abs(gap + 1e-4) < 1e-8);
      const std::set<Feature> four = names_of(meet(1e-3));
      CHECK(four.size() == std::min<std::size_t>(4, static_cast<std::size_t>(sides)));
      for (int again = 0; again < 10; ++again) CHECK(names_of(meet(1e-3)) == four);
    };
    stands_on(Cylinder(1.0, 0.6), 0.3);
    stands_on(Tube(1.0, 0.6, true), 0.3);
    stands_on(Cone(0.5, 1.0, 0.6, true), 0.3);
  }
}
