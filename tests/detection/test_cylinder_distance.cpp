// Cylinders against the exact methods: GJK apart, the expanding polytope where they overlap.
#include "detection/narrow/gjk/cylinder_distance.h"

#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/gjk/gjk.h"
#include "detection/shapes/capsule.h"
#include "detection/shapes/cylinder.h"
#include "detection/shapes/sphere.h"
#include "tests/support/catch.h"
#include "tests/support/pair_contacts.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using support::difference;

namespace {

struct CylinderTally {
  int asked = 0, found = 0, overlapping = 0;
  double worst = 0.0;   ///< difference to the exact gap, of the size
  double parted = 0.0;  ///< difference of the points to gap times normal, of the size
};

template <CylinderShape A, CylinderShape B>
CommonNormal quick(const A& a, const B& b, const MinkowskiDifference& d, double limit = infinity) {
  return cylinder_distance(a.cylinder_core(), b.cylinder_core(), d.rotation, d.offset, limit);
}

template <CylinderShape A, CylinderShape B>
void judge_cylinders(const A& a, const B& b, const Pose& pa, const Pose& pb, CylinderTally& tally) {
  const MinkowskiDifference d = difference(a, pa, b, pb);
  const CommonNormal c = quick(a, b, d);
  ++tally.asked;
  if (c.status != CommonNormal::Status::found) return;
  ++tally.found;
  tally.overlapping += c.gap < 0.0;
  const GjkResult apart = gjk(d);
  const double exact = apart.status == GjkResult::Status::overlapping ? -epa(d).upper : apart.lower;
  const double size = a.bounding_radius() + b.bounding_radius();
  const double off = std::abs(c.gap - exact) / size;
  INFO("quick " << c.gap << ", exact " << exact);
  CHECK(off < 1e-9);
  tally.worst = std::max(tally.worst, off);
  tally.parted = std::max(tally.parted, (c.on_b - c.on_a - c.gap * c.normal).norm() / size);
  // no direction separates by more than the distance: the answer is a bound and is reached
  CHECK(std::abs(-c.normal.dot(d.support(c.normal).y) - c.gap) < 1e-12 * size);
}

/// B is moved to a gap from `least` to `most` of the smaller body.
struct GapRange {
  double least, most;
};

template <CylinderShape A, CylinderShape B>
void meet_at(const A& a, const B& b, const Quat& turn, const Vec3& towards, GapRange gaps, Random& random,
             CylinderTally& tally) {
  const Pose pa{testing::random_point(random), testing::random_turn(random)};
  Pose pb{pa.position + pa.orientation * (1.2 * (a.bounding_radius() + b.bounding_radius()) * towards),
          pa.orientation * turn};
  const GjkResult way = gjk(difference(a, pa, b, pb));
  const double wanted = random.uniform(gaps.least, gaps.most) * std::min(a.bounding_radius(), b.bounding_radius());
  pb.position -= (way.lower - wanted) * (pa.orientation * way.normal);
  judge_cylinders(a, b, pa, pb, tally);
}

Cylinder random_cylinder(Random& random) {
  return {std::pow(3.0, random.uniform(-1, 1)), std::pow(5.0, random.uniform(-1, 1))};
}

}  // namespace

TEST_CASE("cylinders in any pose have the gap of the exact methods", "[detection][round]") {
  Random random(301, 0);
  CylinderTally deep, shallow;
  for (int k = 0; k < 500; ++k) {
    meet_at(random_cylinder(random), random_cylinder(random), testing::random_turn(random),
            testing::random_direction(random), {-0.05, 0.05}, random, deep);
    meet_at(random_cylinder(random), random_cylinder(random), testing::random_turn(random),
            testing::random_direction(random), {-0.001, 0.0}, random, shallow);
  }
  INFO(deep.found << " of " << deep.asked << ", overlapping " << deep.overlapping << "; shallow " << shallow.found);
  CHECK(deep.found > 0.85 * deep.asked);
  CHECK(deep.overlapping > 180);
  CHECK(shallow.found > 0.93 * shallow.asked);
  CHECK(std::max(deep.worst, shallow.worst) < 1e-11);
  CHECK(std::max(deep.parted, shallow.parted) < 1e-11);  // a rim seen at a sine of 1e-4 has its point to 1e-12
}

TEST_CASE("segments and points are cylinders without a radius", "[detection][round]") {
  Random random(302, 0);
  CylinderTally capsules, spheres;
  for (int k = 0; k < 300; ++k) {
    const Capsule capsule(0.3, random.uniform(0, 2));
    const GapRange apart{0.0, 0.05};  // the cores of what touches
    meet_at(random_cylinder(random), capsule, testing::random_turn(random), testing::random_direction(random), apart,
            random, capsules);
    meet_at(capsule, random_cylinder(random), testing::random_turn(random), testing::random_direction(random), apart,
            random, capsules);
    meet_at(Sphere{1.0}, random_cylinder(random), testing::random_turn(random), testing::random_direction(random),
            {-0.05, 0.05}, random, spheres);
  }
  INFO(capsules.found << " of " << capsules.asked << " capsules, " << spheres.found << " spheres");
  CHECK(capsules.found > 0.9 * capsules.asked);
  CHECK(spheres.found > 0.9 * spheres.asked);
  CHECK(std::max(capsules.worst, spheres.worst) < 1e-11);
}

TEST_CASE("cylinders that stand or lie on each other, exactly or nearly, have the gap of the exact methods",
          "[detection][round]") {
  Random random(303, 0);
  CylinderTally exactly, nearly;
  for (int k = 0; k < 400; ++k) {
    const bool exact = k % 2 == 0;
    const double tilt = exact ? 0.0 : std::pow(10.0, -2 - k % 12);
    const Quat quarter(Eigen::AngleAxisd(k % 3 == 0 ? 0.0 : 0.5 * std::numbers::pi, Vec3::UnitX()));
    const Quat turn = Quat(Eigen::AngleAxisd(tilt, testing::random_direction(random))) * quarter *
                      Quat(Eigen::AngleAxisd(random.uniform(0, 6), Vec3::UnitZ()));
    const Vec3 towards[] = {Vec3::UnitX(), Vec3::UnitZ(), Vec3(1, 0, 0.3), Vec3(0.4, 0, 1), Vec3(0, -1, 0.1)};
    meet_at(random_cylinder(random), random_cylinder(random), turn, towards[k % 5].normalized(), {-0.01, 0.01}, random,
            exact ? exactly : nearly);
  }
  INFO(exactly.found << " and " << nearly.found << " of " << exactly.asked);
  CHECK(exactly.found > 0.9 * exactly.asked);
  CHECK(nearly.found > 0.8 * nearly.asked);
  CHECK(std::max(exactly.worst, nearly.worst) < 1e-11);
}

TEST_CASE("a cylinder that lies nearly level over the end of another, to its rim and beyond, needs no other method",
          "[detection][round]") {
  // Across the lying axis the rim is an ellipse flatter than 1 in 10, down to 1 in 1000.
  Random random(306, 0);
  CylinderTally lying;
  for (int k = 0; k < 400; ++k) {
    const double tilt = std::pow(10.0, random.uniform(-3, -1));
    const Quat turn = Quat(Eigen::AngleAxisd(random.uniform(0, 6), Vec3::UnitZ())) *
                      Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi + tilt, Vec3::UnitX()));
    const Vec3 towards(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), 1.0);
    meet_at(random_cylinder(random), random_cylinder(random), turn, towards.normalized(), {-0.02, 0.0}, random, lying);
  }
  INFO(lying.found << " of " << lying.asked << ", overlapping " << lying.overlapping << ", worst " << lying.worst);
  CHECK(lying.found > 0.93 * lying.asked);
  CHECK(lying.worst < 1e-11);
  CHECK(lying.parted < 1e-11);
}

TEST_CASE("the way between two cylinders changes by no more than one of them is moved", "[detection][round]") {
  // Gap times normal is the point of the difference nearest to the origin; the projection on a convex body is
  // nonexpansive. B goes round A past ends, rims and sides.
  Random random(305, 0);
  double excess = -1.0;
  int found = 0, asked = 0;
  for (int pair = 0; pair < 20; ++pair) {
    const Cylinder a = random_cylinder(random), b = random_cylinder(random);
    const double far = 1.1 * (a.bounding_radius() + b.bounding_radius());
    const Vec3 first = testing::random_direction(random), second = first.cross(testing::random_direction(random));
    const Quat turn = testing::random_turn(random);
    Vec3 last_way = Vec3::Zero(), last_place = Vec3::Zero();
    bool known = false;
    for (int k = 0; k < 200; ++k, ++asked) {
      const double angle = 0.0315 * k;
      const Vec3 place = far * (std::cos(angle) * first + std::sin(angle) * second.normalized());
      const CommonNormal c = quick(a, b, difference(a, {}, b, {place, turn}));
      const Vec3 way = c.gap * c.normal;
      const bool now = c.status == CommonNormal::Status::found;
      if (known && now) excess = std::max(excess, (way - last_way).norm() - (place - last_place).norm());
      known = now;
      last_way = way;
      last_place = place;
      found += now;
    }
  }
  CHECK(found > 0.95 * asked);
  CHECK(excess < 1e-11);  // 200 rounding errors of bodies of size 1 to 5
}

TEST_CASE("a limit ends the search of two cylinders with a normal that proves the distance", "[detection][round]") {
  Random random(304, 0);
  for (int k = 0; k < 200; ++k) {
    const Cylinder a = random_cylinder(random), b = random_cylinder(random);
    const double far = a.bounding_radius() + b.bounding_radius();
    const Pose pb{random.uniform(0.8, 2) * far * testing::random_direction(random), testing::random_turn(random)};
    const MinkowskiDifference d = difference(a, {}, b, pb);
    const GjkResult g = gjk(d);
    if (g.status == GjkResult::Status::overlapping) continue;
    const double limit = random.uniform(0, 1) * far;
    const CommonNormal c = quick(a, b, d, limit);
    CHECK((c.status == CommonNormal::Status::beyond) == (g.lower > limit));
    if (c.status == CommonNormal::Status::beyond) CHECK(-c.normal.dot(d.support(c.normal).y) > limit);
  }
}

TEST_CASE("an overlap that is shallower elsewhere is left to the exact method", "[detection][round]") {
  // Two crossed discs: their sides part along both axes, their ends across.
  const Cylinder disc(1.0, 0.1);
  for (const double apart : {0.3, 0.9, 1.5}) {
    const Pose pb{{apart, 0.02, 0.01}, Quat(Eigen::AngleAxisd(0.5 * std::numbers::pi, Vec3::UnitX()))};
    const MinkowskiDifference d = difference(disc, {}, disc, pb);
    const CommonNormal c = quick(disc, disc, d);
    if (c.status == CommonNormal::Status::found) CHECK(std::abs(c.gap + epa(d).upper) < 1e-11);
  }
}
