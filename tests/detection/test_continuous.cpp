#include "detection/continuous/sweep_guard.h"

#include "tests/support/catch.h"
#include "tests/support/polyhedra.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using testing::upright;

namespace {

template <class S>
MovingBody moving(const S& s, const Pose& start, const Vec3& travel, const Vec3& turn = Vec3::Zero()) {
  const ConvexRef core = ConvexRef::to(s);
  return {core, s.rounding(), core.radius, {start, travel, turn}};
}

/// A world of one thing in the way and one flagged body that has made its way in one step of 1 s.
struct Shot {
  ShapeStore shapes;
  World world{Columns{.rotation = true, .force = false}};
  std::vector<BodyId> flagged;

  template <class S>
  Slot add(const S& shape, const Pose& pose, const Vec3& velocity, bool flag) {
    Body body;
    body.shape = shapes.add(shape).packed;
    body.position = pose.position;
    body.orientation = pose.orientation;
    body.velocity = velocity;
    body.mass = velocity.squaredNorm() > 0.0 ? 1.0 : 0.0;
    body.inertia = Vec3::Ones();
    const BodyId id = world.add(body);
    if (flag) flagged.push_back(id);
    return world.slot_of(id);
  }
  /// Drifts everything by `duration` and holds back; the number of bodies held.
  std::uint64_t step(double duration) {
    SweepGuard guard(shapes, flagged);
    guard.remember(world);
    for (Slot s = 0; s < world.size(); ++s) world.position[s] += duration * world.velocity[s];
    guard.hold_back(world, duration);
    CHECK(guard.unfinished() == 0);
    return guard.held();
  }
};

}  // namespace

TEST_CASE("a shot of 300 m/s reaches a plate of 0.1 mm at the time of its distance", "[detection][continuous]") {
  const Sphere ball{0.005};
  const Box plate(Vec3(0.5, 0.5, 0.5e-4));  // its near face 1 m away: t = (1 - 0.005) / 300
  const auto i = time_of_impact(moving(ball, {{0, 0, 1 + 0.5e-4}, upright}, {0, 0, -300 * 0.01}),
                                moving(plate, {}, Vec3::Zero()), 0.0, 1e-12);
  REQUIRE(i.hits);
  CHECK(i.share * 0.01 == Approx(0.995 / 300).epsilon(1e-10));
  CHECK(i.iterations <= 3);  // travel alone: Newton on a plane
}

TEST_CASE("a spinning rod reaches the edge of a plate after a third of pi", "[detection][continuous]") {
  // Rod of length 1 about its fixed middle, 100 rad/s about z, from -60 degrees; the corner of the plate at (0.3, 0).
  const Capsule rod(1e-9, 1.0);
  const Vec3 start(std::cos(-testing::pi / 3), std::sin(-testing::pi / 3), 0.0);
  const Pose pose{Vec3::Zero(), Quat::FromTwoVectors(Vec3::UnitZ(), start)};
  const Box plate(Vec3(0.05, 0.05, 0.2));
  const Pose corner{{0.3, 0.05 * std::sqrt(2.0), 0}, Quat(Eigen::AngleAxisd(testing::pi / 4, Vec3::UnitZ()))};
  const double duration = 0.02;
  const auto i = time_of_impact(moving(rod, pose, Vec3::Zero(), {0, 0, 100 * duration}),
                                moving(plate, corner, Vec3::Zero()), 0.0, 1e-10);
  REQUIRE(i.hits);
  CHECK(i.converged);
  CHECK(i.share * duration == Approx(testing::pi / 3 / 100).epsilon(1e-6));
  CHECK(i.iterations < 64);
}

TEST_CASE("two needles that cross in one step meet, and pass when one comes late", "[detection][continuous]") {
  const Capsule needle(1e-3, 1.0);
  const Quat along_x = Quat::FromTwoVectors(Vec3::UnitZ(), Vec3::UnitX()),
             along_y = Quat::FromTwoVectors(Vec3::UnitZ(), Vec3::UnitY());
  const auto a = moving(needle, {{0, 0.1, 1}, along_x}, {0, 0, -2});
  const auto met = time_of_impact(a, moving(needle, {{0.1, 0, -1}, along_y}, {0, 0, 2}), 0.0, 1e-12);
  REQUIRE(met.hits);
  CHECK(met.share == Approx((1 - 1e-3) / 2).epsilon(1e-9));
  CHECK(std::abs(met.normal.z()) == Approx(1.0).epsilon(1e-6));
  CHECK_FALSE(time_of_impact(a, moving(needle, {{0.6, 0, -1}, along_y}, {0, 0, 2}), 0.0, 1e-12).hits);
}

TEST_CASE("times of impact are those of a fine march over random drifting and turning bodies",
          "[detection][continuous]") {
  Random random(101, 0);
  int hits = 0;
  for (int k = 0; k < 60; ++k) {
    const ConvexHull a = support::random_hull(random, 12, Vec3(0.5, 0.3, 0.2)),
                     b = support::random_hull(random, 10, Vec3(0.3, 0.3, 0.3));
    const Vec3 from = 2.0 * testing::random_direction(random);
    const auto ma =
        moving(a, {from, testing::random_turn(random)}, -2.0 * from + testing::random_point(random, -0.5, 0.5),
               2.0 * testing::random_direction(random));
    const auto mb = moving(b, {Vec3::Zero(), testing::random_turn(random)}, testing::random_point(random, -0.3, 0.3),
                           testing::random_direction(random));
    const auto gap = [&](double share) {
      return support::brute_force_distance(a, ma.path.at(share), b, mb.path.at(share));
    };
    const Impact i = time_of_impact(ma, mb, 0.0, 1e-10);
    CHECK(i.converged);
    hits += i.hits;
    if (i.hits) CHECK(std::abs(gap(i.share)) < 2e-10);
    const double end = i.hits ? i.share : 1.0;  // nothing touches before
    for (int j = 0; j < 12; ++j) CHECK(gap(end * (j / 12.0)) > 0.0);
  }
  CHECK(hits > 30);
}

TEST_CASE("no body of 10000 passes a plate, a wall of triangles or a plane", "[detection][continuous]") {
  Random random(102, 0);
  const TriangleMesh wall =
      TriangleMesh::from_surface({{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}});
  int crossed = 0, stopped = 0;
  for (int k = 0; k < 10000; ++k) {
    Shot shot;
    const double size = std::pow(10.0, -random.uniform(1, 3)), speed = size * std::pow(10.0, random.uniform(0.5, 3));
    const Vec3 aim(random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8), 0.0);
    Vec3 direction = testing::random_direction(random);
    direction.z() = -std::abs(direction.z()) - 0.1;
    direction.normalize();
    const Pose start{aim - random.uniform(0.05, 0.9) * speed * direction + Vec3(0, 0, size),
                     testing::random_turn(random)};
    Slot s = 0;
    if (k % 4 == 0) s = shot.add(Sphere{size}, start, speed * direction, true);
    if (k % 4 == 1) s = shot.add(Box(size * Vec3(1, 0.6, 0.4)), start, speed * direction, true);
    if (k % 4 == 2) s = shot.add(Cylinder(0.5 * size, size), start, speed * direction, true);
    if (k % 4 == 3) s = shot.add(Capsule(0.3 * size, size), start, speed * direction, true);
    const int obstacle = k / 4 % 3;
    if (obstacle == 0) shot.add(Box(Vec3(1, 1, 0.5e-4)), {}, Vec3::Zero(), false);
    if (obstacle == 1) shot.add(wall, {}, Vec3::Zero(), false);
    if (obstacle == 2) shot.add(HalfSpace{}, {}, Vec3::Zero(), false);
    if (!(start.position.z() > 1.2 * size)) continue;
    const Vec3 through = start.position - start.position.z() / direction.z() * direction;
    if (obstacle < 2 && std::max(std::abs(through.x()), std::abs(through.y())) > 1.0) continue;  // passes beside it
    stopped += shot.step(1.0) > 0;
    crossed += shot.world.position[s].z() < 0.0;
  }
  CHECK(crossed == 0);
  CHECK(stopped > 5000);
}

TEST_CASE("a flagged body that slides, rolls or grazes keeps its way", "[detection][continuous]") {
  for (const double gap : {1e-6, 0.0, -1e-6}) {
    Shot slide;
    slide.add(HalfSpace{}, {}, Vec3::Zero(), false);
    const Slot s = slide.add(Sphere{0.1}, {{0, 0, 0.1 + gap}, upright}, {50, 0, -1e-3}, true);
    CHECK(slide.step(1.0) == 0);
    CHECK(slide.world.position[s].x() == 50.0);
    Shot box;
    box.add(Box(Vec3(100, 1, 0.5)), {{0, 0, -0.5}, upright}, Vec3::Zero(), false);
    const Slot b = box.add(Box(Vec3(0.1, 0.1, 0.1)), {{0, 0, 0.1 + gap}, upright}, {50, 0, 0}, true);
    CHECK(box.step(1.0) == 0);
    CHECK(box.world.position[b].x() == 50.0);
  }
}

TEST_CASE("a flagged body that comes out of an overlap is not held, one that goes deeper is",
          "[detection][continuous]") {
  // from a third of its radius deep, 10 m/s for 1 ms
  for (const bool plane : {false, true})
    for (const double up : {1.0, -1.0}) {
      Shot shot;
      if (plane)
        shot.add(HalfSpace{Vec3::UnitZ()}, {}, Vec3::Zero(), false);
      else
        shot.add(Box(Vec3(0.5, 0.5, 0.05)), {{0, 0, -0.05}, upright}, Vec3::Zero(), false);
      const double height = 0.02;
      const Slot ball = shot.add(Sphere{0.03}, {{0, 0, height}, upright}, {0, 0, 10.0 * up}, true);
      INFO((plane ? "plane " : "plate ") << up);
      CHECK(shot.step(1e-3) == (up > 0.0 ? 0u : 1u));
      CHECK(shot.world.position[ball].z() == Approx(up > 0.0 ? height + 0.01 : height).epsilon(1e-12));
    }
}

TEST_CASE("a body that is not flagged passes, and nothing is held for it", "[detection][continuous]") {
  Shot shot;
  shot.add(Box(Vec3(1, 1, 0.5e-4)), {}, Vec3::Zero(), false);
  const Slot s = shot.add(Sphere{0.005}, {{0, 0, 1}, upright}, {0, 0, -2}, false);
  CHECK(shot.step(1.0) == 0);
  CHECK(shot.world.position[s].z() == -1.0);
}
