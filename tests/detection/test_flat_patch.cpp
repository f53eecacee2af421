#include "detection/narrow/pairs/flat_patch.h"

#include "detection/shapes/all_shapes.h"
#include "tests/support/catch.h"
#include "tests/support/pair_contacts.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using support::about, support::contacts, support::deepest;

namespace {

const double right = std::acos(0.0);

}  // namespace

TEST_CASE("a cylinder that stands on a cylinder stands on four points, also where it hangs over",
          "[detection][flat-patch]") {
  const Cylinder lower(0.5, 0.4), upper(0.2, 0.6);
  Random random(211, 0);
  for (int k = 0; k < 100; ++k) {
    const double depth = std::pow(10.0, -random.uniform(3, 10)), shift = k % 2 == 0 ? 0.1 : 0.4,
                 way = random.uniform(0, 6);
    const Pose pose{{shift * std::cos(way), shift * std::sin(way), 0.5 - depth},
                    about(Vec3::UnitZ(), random.uniform(0, 6))};
    const ContactSet c = contacts(lower, {}, upper, pose);
    REQUIRE(c.size() == 4);
    double area = 0.0;  // of the four points, by its largest triangle: no thin strip
    for (int i = 0; i < 4; ++i) {
      CHECK(std::abs(c.gap[static_cast<std::size_t>(i)] + depth) < 1e-15);
      CHECK((c.normal[static_cast<std::size_t>(i)] - Vec3::UnitZ()).norm() < 1e-12);
      const Vec3 x = c.arm[static_cast<std::size_t>(i)];
      CHECK(x.head<2>().norm() < 0.5 + 1e-8);
      CHECK((x - pose.position).head<2>().norm() < 0.2 + 1e-8);
      CHECK(x.z() == Approx(0.2 - 0.5 * depth).epsilon(1e-12));
    }
    area = (c.arm[1] - c.arm[0]).cross(c.arm[2] - c.arm[0]).norm();
    CHECK(std::max(area, (c.arm[2] - c.arm[0]).cross(c.arm[3] - c.arm[0]).norm()) > 0.02);
    const ContactSet swapped = contacts(upper, pose, lower, {});
    REQUIRE(swapped.size() == 4);
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK((swapped.normal[i] + Vec3::UnitZ()).norm() < 1e-12);
      CHECK(std::abs(swapped.gap[i] + depth) < 1e-15);
      CHECK((swapped.arm[i] + pose.position).z() == Approx(0.2 - 0.5 * depth).epsilon(1e-12));
    }
  }
}

TEST_CASE("a tilted cylinder keeps its deepest point on a cylinder exactly", "[detection][flat-patch]") {
  const double r = 0.2, half = 0.3;
  const Cylinder lower(0.6, 0.5), upper(r, 2 * half);
  Random random(212, 0);
  for (int k = 0; k < 200; ++k) {
    const double tilt = std::pow(10.0, -random.uniform(0.5, 6)), height = 0.25 + half;
    const Quat turn = about({std::cos(0.1 * k), std::sin(0.1 * k), 0}, tilt) * about(Vec3::UnitZ(), 0.37 * k);
    const ContactSet c = contacts(lower, {}, upper, {{0.1, -0.2, height}, turn}, 0.05);
    REQUIRE(c.size() >= 1);
    const double exact = height - 0.25 - half * std::cos(tilt) - r * std::sin(tilt);
    CHECK(std::abs(deepest(c) - exact) < 2e-9);  // corners stand for the rim within 1e-9 of the pair
  }
}

TEST_CASE("rods that lie side by side touch in two points, crossed ones in one", "[detection][flat-patch]") {
  const Quat along_x = about(Vec3::UnitY(), right);
  const auto check = [&](const auto& a, const auto& b) {
    const ContactSet c = contacts(a, {{0, 0, 0}, along_x}, b, {{0.2, 0, 0.2 - 1e-4}, along_x});
    REQUIRE(c.size() == 2);  // the lower reaches from -0.3 to 0.3, the upper from -0.1 to 0.5
    CHECK(std::max(c.arm[0].x(), c.arm[1].x()) == Approx(0.3).epsilon(1e-9));
    CHECK(std::min(c.arm[0].x(), c.arm[1].x()) == Approx(-0.1).epsilon(1e-9));
    for (std::size_t i = 0; i < 2; ++i) {
      CHECK(std::abs(c.gap[i] + 1e-4) < 1e-12);
      CHECK(c.arm[i].z() == Approx(0.1 - 0.5e-4).epsilon(1e-9));
    }
    const Quat across = about(Vec3::UnitX(), right);
    CHECK(contacts(a, {{0, 0, 0}, along_x}, b, {{0, 0, 0.2 - 1e-4}, across}).size() == 1);
  };
  check(Cylinder(0.1, 0.6), Cylinder(0.1, 0.6));
  check(Cylinder(0.1, 0.6), Capsule(0.1, 0.6));
  check(Capsule(0.1, 0.6), Cylinder(0.1, 0.6));
}

TEST_CASE("a rod that lies on the end of a cylinder rests on two points", "[detection][flat-patch]") {
  const Quat along_x = about(Vec3::UnitY(), right);
  const auto check = [&](const auto& rod) {
    const ContactSet c = contacts(Cylinder(0.2, 0.4), {}, rod, {{0, 0, 0.3 - 1e-4}, along_x});
    REQUIRE(c.size() == 2);  // the end reaches 0.2 either way, along the corner that stands for its rim
    CHECK(std::abs(c.arm[0].x() - c.arm[1].x()) == Approx(0.4).epsilon(1e-8));
    for (const double gap : c.gap) CHECK(std::abs(gap + 1e-4) < 1e-12);
  };
  check(Cylinder(0.1, 0.6));
  check(Capsule(0.1, 0.6));
}
