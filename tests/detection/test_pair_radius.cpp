// R* on a flat wall does not depend on what the wall is made of: a half-space, a box, a hull or the end of a cylinder,
// thick or thin.
#include "detection/narrow/pairs/pair_table.h"
#include "detection/shape_store.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;

namespace {

template <class A, class B>
std::vector<double> radii(const A& a, const Pose& pa, const B& b, const Pose& pb, bool wall_b) {
  ContactSet set;
  set.with_curvature = true;
  ContactSink sink(set);
  PairQuery q{pa, pb, 0.0, true};
  q.wall_b = wall_b;
  sink.begin(0, 1);
  pair_table_detail::meet(a, b, q, sink, {});
  sink.end();
  return set.effective_radius;
}

/// A body that sinks by `depth` into walls whose upper face is z = 0, at a random place of their middle.
template <class A>
void check_walls(const A& body, const Quat& turn, double depth, Random& random) {
  const double low = -(turn * body.support(turn.conjugate() * Vec3(0, 0, -1))).z() + body.rounding();
  const Pose at{{random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), low - depth}, turn};
  const std::vector<double> plane = radii(body, at, HalfSpace{Vec3::UnitZ()}, {}, true);
  REQUIRE_FALSE(plane.empty());
  const double expected = plane.front();
  const auto check = [&](const std::vector<double>& got, const char* wall) {
    INFO(A::name << " on " << wall);
    REQUIRE_FALSE(got.empty());
    for (const double r : got) CHECK(r == Approx(expected).epsilon(1e-6));
  };
  const double thickness = random.uniform(0.01, 0.2);
  const Pose below{{0, 0, -0.5 * thickness}, Quat(Eigen::AngleAxisd(random.uniform(-3, 3), Vec3::UnitZ()))};
  check(radii(body, at, Box(Vec3(0.5, 0.6, thickness)), below, true), "box");
  check(radii(body, at, Cylinder(0.3, thickness), below, true), "cylinder");
  check(radii(body, at, Box(Vec3(0.5, 0.6, thickness)).hull, below, true), "hull");
}

}  // namespace

TEST_CASE("a flat wall has no radius, whatever it is made of", "[detection][round]") {
  Random random(648, 1);
  for (int n = 0; n < 30; ++n) {
    const Quat any = testing::random_turn(random);
    const auto size = [&] { return random.uniform(0.01, 0.05); };
    check_walls(Sphere{size()}, any, 1e-4, random);
    check_walls(Capsule(size(), size()), any, 1e-4, random);
    check_walls(Ellipsoid(Vec3(size(), size(), size())), any, 1e-4, random);
    check_walls(Box(Vec3(size(), size(), size())), any, 1e-4, random);
    check_walls(Cylinder(size(), size()), any, 1e-4, random);
  }
}

TEST_CASE("the side of a cylinder has the mean of its curvatures, two free flats count both", "[detection][round]") {
  // Hertz' ellipse of a sphere on a rod ten times thicker: within a hundredth of the mean curvature's circle
  const Cylinder rod(1.0, 5.0);
  const double exact = hertz_radius(0.5 / 0.1, 0.5 * (1.0 / 0.1 + 1.0));
  const std::vector<double> side = radii(Sphere{0.1}, {{1.1 - 1e-4, 0, 0}, testing::upright}, rod, {}, false);
  REQUIRE(side.size() == 1);
  CHECK(side[0] == Approx(exact).epsilon(0.01));
  const Box cube(Vec3::Constant(0.1));
  const double own = cube.contact_radius();
  const std::vector<double> free = radii(cube, {{0, 0, 0.0999}, testing::upright}, cube, {}, false);
  REQUIRE(free.size() == 4);
  CHECK(free[0] == Approx(0.5 * own).epsilon(1e-12));
  CHECK(radii(cube, {{0, 0, 0.0999}, testing::upright}, cube, {}, true)[0] == Approx(own).epsilon(1e-12));
}
