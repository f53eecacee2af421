// Contact points that are kept while bodies hardly move, against those of a query.
#include "detection/narrow/pairs/convex_pairs.h"
#include "detection/narrow/polyhedra/resting_patch.h"
#include "detection/shapes/box.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/convex_corpus.h"
#include "tests/support/polyhedra.h"

using namespace epafi;

namespace {

template <class A, class B>
ContactSet contacts_of(const A& a, const B& b, const PairQuery& q) {
  ContactSet out;
  ContactSink sink(out);
  sink.begin(0, 1);
  collide(a, b, q, sink);
  sink.end();
  return out;
}

/// B over A along d, moved together until the gap is `gap`.
template <class A, class B>
Pose at_gap(const A& a, const B& b, const Vec3& d, const Quat& turn, double gap) {
  Pose pose{2.0 * d, turn};
  for (int k = 0; k < 60; ++k) {
    const double far = polyhedron_distance(PolyhedronPair(a.view(), b.view(), {}, pose)).axis.gap;
    pose.position += 0.7 * (gap - far) * d;
  }
  return pose;
}

struct Differences {
  int kept = 0, others = 0;
  double gap = 0.0, arm = 0.0, normal = 0.0, other_gap = 0.0;  ///< all but the first over the way
};

/// A pair is asked, moved by up to `way`, and asked again with its resting patch and without.
template <class A, class B>
void compare(const A& a, const B& b, Pose pose, double way, Random& random, Differences& e) {
  auto resting = std::make_unique<RestingPatch>();
  PairQuery q{{{0.3, -0.2, 0.1}, testing::random_turn(random)}, {}, 0.005};
  const auto placed = [&] {
    return Pose{q.a.to_world(pose.position), (q.a.orientation * pose.orientation).normalized()};
  };
  q.b = placed();
  q.resting = &resting;
  contacts_of(a, b, q);
  pose.position += 0.5 * way * testing::random_direction(random);
  pose.orientation = Quat(Eigen::AngleAxisd(0.5 * way, testing::random_direction(random))) * pose.orientation;
  q.b = placed();
  const Mat3 query_pose = resting->rotation;
  const ContactSet kept = contacts_of(a, b, q);
  if (resting->count == 0 || resting->rotation != query_pose) return;  // asked again
  q.resting = nullptr;
  const ContactSet asked = contacts_of(a, b, q);
  if (kept.feature != asked.feature) {
    ++e.others;  // another point as deep
    const auto deepest = [](const ContactSet& c) { return *std::min_element(c.gap.begin(), c.gap.end()); };
    e.other_gap = std::max(e.other_gap, std::abs(deepest(kept) - deepest(asked)) / way);
    return;
  }
  ++e.kept;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const double apart = way * std::abs(asked.gap[k]);  // the normal may be that of the other of two parallel faces
    e.gap = std::max(e.gap, std::abs(kept.gap[k] - asked.gap[k]) - apart);
    e.arm = std::max(e.arm, (kept.arm[k] - asked.arm[k]).norm() / way);
    e.normal = std::max(e.normal, (kept.normal[k] - asked.normal[k]).norm() / way);
  }
}

}  // namespace

TEST_CASE("contact points that rest follow their features to second order in the way", "[detection][resting]") {
  Random random(71, 0);
  const Box box(Vec3(0.5, 0.4, 0.3)), other(Vec3(0.3, 0.3, 0.2));
  for (const double way : {0.25e-6, 0.125e-6}) {
    Differences hulls, boxes;
    for (int k = 0; k < 400; ++k) {
      const ConvexHull a = support::random_hull(random, 20, Vec3::Constant(0.5));
      const ConvexHull b = support::random_hull(random, 14, Vec3::Constant(0.4));
      const Vec3 d = testing::random_direction(random);
      compare(a, b, at_gap(a, b, d, testing::random_turn(random), -1e-4), way, random, hulls);
      const double tilt = random.uniform(-0.01, 0.01),
                   turn = random.uniform(0.0, 3.0);  // rests on a face, an edge, a tip
      const Quat on_top = Quat(Eigen::AngleAxisd(turn, Vec3::UnitZ())) * Quat(Eigen::AngleAxisd(tilt, Vec3::UnitX()));
      Pose pose = at_gap(box, other, Vec3::UnitZ(), on_top, -1e-5);
      pose.position += Vec3(random.uniform(-0.4, 0.4), random.uniform(-0.4, 0.4), 0.0);  // over edges and corners too
      compare(box, other, pose, way, random, boxes);
    }
    for (const Differences& e : {hulls, boxes}) {
      INFO(way << ": kept " << e.kept << ", others " << e.others << ", gap " << e.gap << ", over the way: arm " << e.arm
               << ", normal " << e.normal << ", gap of others " << e.other_gap);
      CHECK(e.kept > 350);
      CHECK(e.others <= 8);
      CHECK(e.arm < 0.02);
      CHECK(e.other_gap <= 2.0);
    }
    CHECK(hulls.gap < 1e-12);
    CHECK(hulls.normal == 0.0);
    CHECK(boxes.gap < 0.5 * way);  // a fifth corner became the deepest; nearly parallel faces changed places
  }
}

TEST_CASE("a patch that does not rest is asked for anew", "[detection][resting]") {
  const Box box(Vec3(0.5, 0.5, 0.5));
  std::unique_ptr<RestingPatch> resting;
  PairQuery q{{}, {{0.1, 0.0, 0.9999}, Quat(1, 0, 0, 0)}, 0.01};
  q.resting = &resting;
  const auto depth = [&] { return contacts_of(box, box, q).gap.at(0); };
  CHECK(depth() == Approx(-1e-4).epsilon(1e-9));
  CHECK(resting->count == 4);
  const Vec3 asked = resting->offset;
  q.b.position.z() -= 0.5e-6;  // of a radius of 0.87
  CHECK(depth() == Approx(-1.005e-4).epsilon(1e-9));
  CHECK(resting->offset == asked);
  q.b.position.z() -= 0.5e-6;
  CHECK(depth() == Approx(-1.010e-4).epsilon(1e-9));
  CHECK(resting->offset != asked);
  q.b.position.z() += 0.5e-6;  // farther points are wanted than were asked for
  q.reach = 0.02;
  const Vec3 again = resting->offset;
  CHECK(depth() == Approx(-1.005e-4).epsilon(1e-9));
  CHECK(resting->offset != again);
  q.b.position.z() += 1.0;
  CHECK(contacts_of(box, box, q).size() == 0);
  CHECK(resting->count == 0);
}
