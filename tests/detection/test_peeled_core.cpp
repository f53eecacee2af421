// Round bodies against bodies with faces: less a ball that rolls inside them they are apart, and GJK has the depth.
#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/gjk/gjk.h"
#include "detection/shapes/box.h"
#include "detection/shapes/capsule.h"
#include "detection/shapes/cylinder.h"
#include "detection/shapes/ellipsoid.h"
#include "detection/shapes/superquadric.h"
#include "tests/support/catch.h"
#include "tests/support/pair_contacts.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using support::difference;

namespace {

/// The deepest contact of B at about `wanted` times the smaller body, less the exact gap, of the size.
template <class A, class B>
double peeling_error(const A& a, const B& b, double wanted, Random& random) {
  const Pose pa{testing::random_point(random), testing::random_turn(random)};
  const double far = 1.2 * (a.bounding_radius() + b.bounding_radius());
  Pose pb{pa.position + far * testing::random_direction(random), testing::random_turn(random)};
  const double smaller = std::min(a.bounding_radius(), b.bounding_radius());
  const GjkResult way = gjk(difference(a, pa, b, pb));
  pb.position -= (way.lower - a.rounding() - b.rounding() - wanted * smaller) * (pa.orientation * way.normal);
  const MinkowskiDifference d = difference(a, pa, b, pb);
  const GjkResult g = gjk(d);
  const double core = g.status == GjkResult::Status::overlapping ? -epa(d).upper : g.lower;
  const ContactSet c = support::contacts(a, pa, b, pb, 0.1 * smaller);
  REQUIRE(c.size() > 0);
  return std::abs(support::deepest(c) - (core - a.rounding() - b.rounding())) / far;
}

/// Largest difference in bits between answers with what a pair remembers and without, over a body that comes and goes.
template <class A, class B>
int answers_that_memory_changes(const A& a, const B& b, Random& random) {
  const Pose pa{testing::random_point(random), testing::random_turn(random)};
  const Vec3 towards = testing::random_direction(random);
  Pose pb{pa.position, testing::random_turn(random)};
  PairCache cache;
  int differ = 0;
  for (int k = 0; k < 60; ++k) {
    const double share = 0.75 + 0.25 * std::abs(k % 20 - 10) / 10.0;
    pb.position = pa.position + share * (a.bounding_radius() + b.bounding_radius()) * towards;
    pb.orientation = Quat(Eigen::AngleAxisd(0.02, towards)) * pb.orientation;
    ContactSet warm;
    ContactSink sink(warm);
    sink.begin(0, 1);
    collide(a, b, PairQuery{pa, pb, 0.01, false, &cache}, sink);
    sink.end();
    const ContactSet cold = support::contacts(a, pa, b, pb, 0.01);
    differ += warm.gap != cold.gap || warm.feature != cold.feature || warm.normal != cold.normal;
  }
  return differ;
}

}  // namespace

TEST_CASE("ellipsoids and superquadrics have their exact depth in faces, edges and corners", "[detection][round]") {
  Random random(311, 0);
  double worst = 0.0;
  for (int k = 0; k < 120; ++k) {
    const double wanted = k % 2 ? -0.01 * random.uniform() : 0.05 * random.uniform(-1, 1);
    const Vec3 axes(1.0, random.uniform(0.4, 1.5), random.uniform(0.4, 1.5));
    const Box box(Vec3(random.uniform(0.3, 2), random.uniform(0.3, 2), random.uniform(0.3, 2)));
    const auto meet = [&](const auto& round) {
      worst = std::max(worst, peeling_error(round, box, wanted, random));
      worst = std::max(worst, peeling_error(box, round, wanted, random));
      worst = std::max(worst, peeling_error(round, Cylinder(0.8, random.uniform(0.5, 2)), wanted, random));
      worst = std::max(worst, peeling_error(Capsule(0.4, 1.0), round, wanted, random));
    };
    meet(Ellipsoid(axes));
    if (k % 4 == 0) meet(Superquadric(axes, 2 + k / 4 % 3, 2 + k / 12 % 3));
  }
  CHECK(worst < 1e-10);  // the polytope of the exact method ends at 1e-12 of the size, or at 256 corners
}

TEST_CASE("what a pair of round bodies remembers changes no bit", "[detection][round][memory]") {
  Random random(312, 0);
  int differ = 0;
  for (int k = 0; k < 30; ++k) {
    const Cylinder cylinder(0.6, random.uniform(0.5, 2)), other(random.uniform(0.3, 1), 1.0);
    const Ellipsoid ellipsoid(Vec3(1.0, 0.7, random.uniform(0.4, 1.2)));
    const Box box(Vec3(0.5, 0.8, 0.6));
    differ += answers_that_memory_changes(cylinder, other, random);
    differ += answers_that_memory_changes(Capsule(0.3, 1.0), cylinder, random);
    differ += answers_that_memory_changes(ellipsoid, box, random);
    differ += answers_that_memory_changes(cylinder, ellipsoid, random);
    differ += answers_that_memory_changes(ellipsoid, Ellipsoid(Vec3(0.5, 0.6, 0.9)), random);
  }
  CHECK(differ == 0);
}
