// Superquadrics of large exponents under rigid laws: they stand on several points of their flat ends, which hold no
// more than the deepest point does.
#include "detection/narrow/pairs/resting_side.h"

#include "detection/narrow/narrow_phase.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using namespace epafi::testing;

namespace {

/// A superquadric over a plane z = 0 as a half-space, table or floor of two triangles, all of it turned.
struct Standing {
  ShapeStore shapes;
  World world{Columns{.rotation = true}};
  Superquadric body;
  ContactSet found;
  Pose at;
  double height = 0.0;  ///< of the deepest point of the body [m]

  Standing(Random& random, int floor, const Quat& tilt)
      : body({random.uniform(0.05, 0.2), random.uniform(0.05, 0.2), random.uniform(0.05, 0.2)},
             4 + static_cast<int>(random.bits() % 29), 4 + static_cast<int>(random.bits() % 29)),
        at{random_point(random), random_turn(random)} {
    const TriangleSurface two{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
    const Vec3 side = Vec3::Unit(static_cast<Eigen::Index>(random.bits() % 3));
    const Quat down = Quat::FromTwoVectors(side, random.bits() % 2 == 0 ? Vec3(-Vec3::UnitZ()) : Vec3::UnitZ());
    const Quat turn = tilt * Eigen::AngleAxisd(random.uniform(0.0, 6.3), Vec3::UnitZ()) * down;
    const double reach = 1e-3 * body.bounding_radius(), sunk = random.uniform(0.0, 1e-6) * body.bounding_radius();
    const Vec3 lowest = turn * body.support(turn.conjugate() * Vec3(-Vec3::UnitZ()));
    height = -sunk;
    Body b;
    b.shape = (floor == 0   ? shapes.add(HalfSpace{Vec3::UnitZ()})
               : floor == 1 ? shapes.add(Box(Vec3(1, 1, 0.25)))
                            : shapes.add(TriangleMesh::from_surface(two)))
                  .packed;
    b.position = at.to_world(Vec3(0, 0, floor == 1 ? -0.25 : 0.0));
    b.orientation = at.orientation;
    world.add(b);
    b.mass = 1.0;
    b.inertia = Vec3::Ones();
    b.shape = shapes.add(body).packed;
    b.position = at.to_world(Vec3(0.137, -0.211, height - lowest.z()));
    b.orientation = at.orientation * turn;
    world.add(b);
    BatchNarrowPhase narrow(shapes, reach, false);
    narrow.collide(world, PairList{{{0, 1}}, 0.01, 1}, found);
  }
  /// Of contact k, from the centre of the body, in axes of the floor.
  Vec3 point(std::size_t k) const {
    const Vec3 x = world.position[0] + found.arm[k] - world.position[1];
    return at.orientation.conjugate() * (found.a[k] == 0 ? x : Vec3(found.arm[k]));
  }
};

}  // namespace

TEST_CASE("a superquadric of large exponents stands on points all around its centre", "[detection][rest]") {
  Random random(95, 0);
  for (int k = 0; k < 300; ++k) {
    const Standing s(random, k % 3, upright);
    const double size = s.body.bounding_radius();
    INFO("draw " << k << ", exponents " << s.body.across << " and " << s.body.along);
    REQUIRE(s.found.size() == 4);
    double low[2] = {0.0, 0.0}, high[2] = {0.0, 0.0};
    for (std::size_t i = 0; i < 4; ++i) {
      CHECK(std::abs(s.found.gap[i] - s.height) < 1e-6 * size);
      const Vec3 x = s.point(i);
      for (int axis : {0, 1}) {
        low[axis] = std::min(low[axis], x[axis]);
        high[axis] = std::max(high[axis], x[axis]);
      }
    }
    // (4 5e-8)^(1/4) = 0.021 of the semi-axis, which is at least a seventh of the size
    for (int axis : {0, 1}) CHECK((low[axis] < -1e-3 * size && high[axis] > 1e-3 * size));
  }
}

TEST_CASE("a superquadric that leans is held by its deepest point, and by others no sooner than its surface",
          "[detection][rest]") {
  Random random(96, 0);
  for (int k = 0; k < 300; ++k) {
    const double angle = std::pow(10.0, random.uniform(-6.0, -1.0));
    const Quat tilt(Eigen::AngleAxisd(angle, Vec3(random_direction(random).x(), 1.0, 0.0).normalized()));
    const Standing s(random, k % 3, tilt);
    const double size = s.body.bounding_radius();
    INFO("draw " << k << ", exponents " << s.body.across << " and " << s.body.along << ", tilt " << angle);
    REQUIRE(s.found.size() > 0);
    const double deepest = *std::ranges::min_element(s.found.gap);
    CHECK(std::abs(deepest - s.height) < 2e-6 * size);  // what the pair's distance is certified to
  }
}
