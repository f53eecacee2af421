#include "detection/narrow/gjk/common_normal.h"

#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/gjk/gjk.h"
#include "detection/shapes/ellipsoid.h"
#include "detection/shapes/sphere.h"
#include "detection/shapes/superquadric.h"
#include "tests/support/catch.h"
#include "tests/support/pair_contacts.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using support::difference;

namespace {

Vec3 random_axes(Random& random, double ratio) {
  Vec3 axes;
  for (int k = 0; k < 3; ++k) axes[k] = std::pow(ratio, random.uniform(0, 1));
  return axes;
}

/// The exact methods: distance by GJK, depth by the expanding polytope.
double exact_gap(const MinkowskiDifference& d) {
  const GjkResult apart = gjk(d);
  return apart.status == GjkResult::Status::overlapping ? -epa(d).upper : apart.lower;
}

struct Tally {
  int found = 0, overlapping = 0, uncertain = 0;
  double worst = 0.0;  ///< difference to the exact gap, of the size
};

/// B stands where it overlaps A by about `depth` of the smaller body, or is as far away.
template <RoundShape A, RoundShape B>
void compare(const A& a, const B& b, Random& random, double depth, Tally& tally) {
  const Pose pa{testing::random_point(random), testing::random_turn(random)};
  const double far = 1.1 * (a.bounding_radius() + b.bounding_radius());
  Pose pb{pa.position + far * testing::random_direction(random), testing::random_turn(random)};
  const GjkResult way = gjk(difference(a, pa, b, pb));
  const double smaller = std::min(a.core_semi_axes().minCoeff(), b.core_semi_axes().minCoeff());
  const double wanted = random.uniform(-depth, depth) * smaller;
  pb.position -= (way.lower - wanted) * (pa.orientation * way.normal);
  const MinkowskiDifference d = difference(a, pa, b, pb);
  const CommonNormal c = common_normal(RoundRef::to(a), RoundRef::to(b), d.rotation, d.offset, infinity);
  if (c.status != CommonNormal::Status::found) {
    ++tally.uncertain;
    return;
  }
  ++tally.found;
  if (c.gap < 0.0) ++tally.overlapping;
  tally.worst = std::max(tally.worst, std::abs(c.gap - exact_gap(d)) / d.size());
  CHECK((c.on_b - c.on_a - c.gap * c.normal).norm() < 2e-13 * std::max(a.bounding_radius(), b.bounding_radius()));
}

}  // namespace

TEST_CASE("the common normal of ellipsoids gives the gap of the exact methods", "[detection][round]") {
  for (const double ratio : {1.0, 1.5, 5.0, 20.0}) {
    Random random(211, static_cast<std::uint64_t>(ratio));
    Tally tally;
    for (int k = 0; k < 150; ++k)
      compare(Ellipsoid(random_axes(random, ratio)), Ellipsoid(random_axes(random, ratio)), random, 0.02, tally);
    CHECK(tally.uncertain == 0);
    CHECK(tally.overlapping > 40);
    CHECK(tally.worst < 2e-12);  // the exact depth is known to 1e-12
  }
}

TEST_CASE("spheres and superquadrics have common normals too", "[detection][round]") {
  Random random(212, 0);
  Tally with_spheres, rounded;
  for (int k = 0; k < 150; ++k) {
    // the core of the sphere is its centre: it lies in the ellipsoid or outside
    compare(Ellipsoid(random_axes(random, 3)), Sphere{1.0}, random, 0.02, with_spheres);
    const Superquadric first(random_axes(random, 2), 3, 2), second(random_axes(random, 2), 4, 4);
    compare(first, second, random, 0.005, rounded);
    compare(Superquadric(random_axes(random, 2), 2, 6), Ellipsoid(random_axes(random, 2)), random, 0.005, rounded);
  }
  CHECK(with_spheres.uncertain == 0);
  CHECK(with_spheres.worst < 2e-12);
  CHECK(rounded.uncertain < 30);  // where two flat sides face each other: the exact method is asked
  CHECK(rounded.overlapping > 60);
  CHECK(rounded.worst < 2e-12);
}

TEST_CASE("an overlap deeper than the least radius of curvature is left to the exact method", "[detection][round]") {
  // Two flat discs crossed: the normal of the centres is a normal of both, yet no least depth.
  const Ellipsoid disc(Vec3(1.0, 1.0, 0.05));
  for (const double apart : {0.3, 0.6, 1.0}) {
    const MinkowskiDifference d = difference(disc, {}, disc, {{apart, 0, 0}, testing::upright});
    const CommonNormal c = common_normal(RoundRef::to(disc), RoundRef::to(disc), d.rotation, d.offset, infinity);
    CHECK(c.status == CommonNormal::Status::uncertain);
  }
}

TEST_CASE("a limit ends the search with a normal that proves the distance", "[detection][round]") {
  Random random(213, 0);
  for (int k = 0; k < 100; ++k) {
    const Ellipsoid a(random_axes(random, 4)), b(random_axes(random, 4));
    const Pose pb{random.uniform(2, 9) * testing::random_direction(random), testing::random_turn(random)};
    const MinkowskiDifference d = difference(a, {}, b, pb);
    const double gap = exact_gap(d), limit = random.uniform(0, 2);
    const CommonNormal c = common_normal(RoundRef::to(a), RoundRef::to(b), d.rotation, d.offset, limit);
    CHECK((c.status == CommonNormal::Status::beyond) == (gap > limit));
    if (c.status == CommonNormal::Status::beyond) CHECK(-c.normal.dot(d.support(c.normal).y) > limit);
  }
}

TEST_CASE("the derivative of a support point is that of its differences", "[detection][round]") {
  Random random(214, 0);
  const auto worst_error = [&](const auto& shape) {
    double worst = 0.0;
    for (int k = 0; k < 50; ++k) {
      Vec3 d = testing::random_direction(random);
      for (int i = 0; i < 3; ++i)
        if (std::abs(d[i]) < 0.1) d[i] = d[i] < 0.0 ? -0.1 : 0.1;  // off the poles, where it is infinite
      d.normalize();
      const Vec3 t = d.cross(testing::random_direction(random)).normalized();
      const double h = 1e-5;
      const Vec3 ahead = shape.support((d + h * t).normalized()), behind = shape.support((d - h * t).normalized());
      const Vec3 difference = (ahead - behind) / (2 * h);
      const Mat3 m = shape.curved_support(d).derivative;
      worst = std::max(worst, (difference - m * t).norm() / (1.0 + m.norm()));
      worst = std::max(worst, (m * d).norm() / (1.0 + m.norm()));
      CHECK((shape.curved_support(d).point - shape.support(d)).norm() < 1e-15);
    }
    return worst;
  };
  CHECK(worst_error(Ellipsoid(Vec3(1.0, 0.6, 0.3))) < 1e-8);
  CHECK(worst_error(Superquadric(Vec3(1.0, 0.6, 0.3), 2, 2)) < 1e-8);
  CHECK(worst_error(Superquadric(Vec3(1.0, 0.6, 0.3), 4, 3)) < 1e-7);
  CHECK(worst_error(Superquadric(Vec3(0.5, 0.6, 0.9), 3, 6)) < 1e-7);
}
