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

TEST_CASE("a ball touches the side of a cylinder along Hertz' ellipse, whichever is thicker", "[detection][round]") {
  // Johnson 1985, section 4.2: relative curvatures 1/r along the axis and 1/r + 1/R across it
  Random random(648, 2);
  for (int n = 0; n < 200; ++n) {
    const double r = std::pow(10.0, random.uniform(-2.0, 1.0)), R = std::pow(10.0, random.uniform(-2.0, 1.0));
    const Cylinder rod(R, 20.0 * r);
    const Pose axis{Vec3::Zero(), testing::random_turn(random)};
    const double angle = random.uniform(-testing::pi, testing::pi), far = r + R - 1e-6 * std::min(r, R);
    const Vec3 place(far * std::cos(angle), far * std::sin(angle), random.uniform(-5.0, 5.0) * r);
    const Pose at{axis.orientation * place, testing::random_turn(random)};
    const double exact = hertz_radius(0.5 / r, 0.5 * (1.0 / r + 1.0 / R));
    INFO("r " << r << " R " << R);
    for (const std::vector<double>& got :
         {radii(Sphere{r}, at, rod, axis, false), radii(rod, axis, Sphere{r}, at, true)}) {
      REQUIRE(got.size() == 1);
      CHECK(got[0] == Approx(exact).epsilon(1e-11));
    }
  }
}

TEST_CASE("crossed rods touch like balls; two free flats count both", "[detection][round]") {
  const Cylinder rod(1.0, 5.0);
  const Quat across(Eigen::AngleAxisd(0.5 * testing::pi, Vec3::UnitX()));
  const std::vector<double> crossed = radii(rod, {}, rod, {{2.0 - 1e-4, 0, 0}, across}, false);
  REQUIRE(crossed.size() == 1);
  CHECK(crossed[0] == Approx(1.0).epsilon(1e-12));
  const Box cube(Vec3::Constant(0.1));
  const double own = cube.contact_radius();
  const std::vector<double> free = radii(cube, {{0, 0, 0.0999}, testing::upright}, cube, {}, false);
  REQUIRE(free.size() == 4);
  CHECK(free[0] == Approx(0.5 * own).epsilon(1e-12));
  CHECK(radii(cube, {{0, 0, 0.0999}, testing::upright}, cube, {}, true)[0] == Approx(own).epsilon(1e-12));
}
