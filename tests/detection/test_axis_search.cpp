#include "detection/narrow/polyhedra/axis_search.h"

#include "detection/narrow/pairs/convex_pairs.h"
#include "tests/support/catch.h"
#include "tests/support/convex_corpus.h"
#include "tests/support/polyhedra.h"
#include "tests/support/same_bits.h"

using namespace epafi;

namespace {

using support::same_bits;

SeparatingAxis random_start(Random& random, const ConvexHull& a, const ConvexHull& b) {
  SeparatingAxis start;
  const auto draw = [&](std::size_t n) {
    return static_cast<std::uint32_t>(random.uniform() * static_cast<double>(n));
  };
  start.kind = static_cast<SeparatingAxis::Kind>(2 + draw(3));
  const bool edges = start.kind == SeparatingAxis::Kind::edges;
  start.feature_a = draw(edges ? a.edges.size() : a.face_normals.size());
  start.feature_b = draw(edges ? b.edges.size() : b.face_normals.size());
  return start;
}

}  // namespace

TEST_CASE("a start of any age changes no bit of the axis nor of the distance", "[detection][axis]") {
  Random random(61, 0);
  const auto pairs = support::read_corpus(EPAFI_SOURCE_DIR "/tests/data/convex_pairs.bin");
  int overlapping = 0;
  for (const auto& p : pairs) {
    const ConvexHull a = ConvexHull::from_faces(p.a.vertices, p.a.faces).hull,
                     b = ConvexHull::from_faces(p.b.vertices, p.b.faces).hull;
    const Pose pa{p.a.centre, Quat(1, 0, 0, 0)};
    Pose pb{p.b.centre, Quat(1, 0, 0, 0)};
    SeparatingAxis before = random_start(random, a, b);
    for (int step = 0; step < 6; ++step) {
      const PolyhedronPair pair(a.view(), b.view(), pa, pb);
      const SeparatingAxis cold = separating_axis(pair);
      CHECK(same_bits(separating_axis(pair, before), cold));
      CHECK(same_bits(separating_axis(pair, random_start(random, a, b)), cold));
      const PolyhedronDistance d = polyhedron_distance(pair);
      PairMemory memory;
      memory.kind = static_cast<std::uint8_t>(before.kind);
      memory.feature_a = before.feature_a;
      memory.feature_b = before.feature_b;
      CHECK(same_bits(polyhedron_distance(pair, infinity, &memory), d));
      overlapping += d.axis.gap < 0.0;
      before = d.axis;
      pb.position += 1e-3 * p.size * testing::random_direction(random);
      if (step > 2) pb.orientation = Quat(Eigen::AngleAxisd(1e-3, testing::random_direction(random))) * pb.orientation;
    }
  }
  CHECK(overlapping > 300);
}

TEST_CASE("equal boxes and boxes in a row have ties, which a start does not break", "[detection][axis]") {
  Random random(62, 0);
  const Box box(Vec3(0.5, 0.5, 0.5));
  for (int k = 0; k < 400; ++k) {
    const Quat turn = k < 200 ? Quat(1, 0, 0, 0) : testing::random_turn(random);
    const Vec3 local(k % 3 == 0 ? 0.0 : 0.25, k % 5 == 0 ? 0.0 : 0.125,
                     k % 7 == 0 ? 1.0 : 1.0 - std::ldexp(1.0, -(k % 30)));
    const PolyhedronPair pair(box.view(), box.view(), {Vec3::Zero(), turn}, {turn * local, turn});
    const SeparatingAxis cold = separating_axis(pair);
    for (int j = 0; j < 8; ++j) CHECK(same_bits(separating_axis(pair, random_start(random, box.hull, box.hull)), cold));
    const double exact = std::max({local.x(), local.y(), local.z()}) - 1.0;
    CHECK(std::abs(cold.gap - exact) < 3e-15);  // the turn of the centre rounds by an ulp of it
  }
}

TEST_CASE("contacts are the same bits with the memory of a pair and without", "[detection][axis]") {
  Random random(63, 0);
  const Box box(Vec3(0.5, 0.4, 0.3));
  const ConvexHull hull = support::random_hull(random, 20, Vec3::Constant(0.5));
  PairCache cache;
  Pose pose{{0, 0, 0.8}, Quat(1, 0, 0, 0)};
  int touching = 0;
  for (int step = 0; step < 400; ++step) {
    pose.position += 1e-3 * testing::random_direction(random);
    pose.position.z() = 0.8 + 0.1 * std::sin(0.05 * step);  // comes, touches, and leaves again
    pose.orientation = Quat(Eigen::AngleAxisd(3e-3, testing::random_direction(random))) * pose.orientation;
    ContactSet with, without;
    ContactSink sink_with(with), sink_without(without);
    sink_with.begin(0, 1);
    sink_without.begin(0, 1);
    PairQuery q{{}, pose, 0.01, false, &cache};
    collide(box, hull, q, sink_with);
    q.cache = nullptr;
    collide(box, hull, q, sink_without);
    REQUIRE(with.size() == without.size());
    CHECK((with.gap == without.gap && with.normal == without.normal && with.arm == without.arm &&
           with.feature == without.feature));
    touching += with.size() > 0;
  }
  CHECK(touching > 50);
  CHECK(touching < 400);
}

TEST_CASE("a turned box is known as one, and its 15 axes hold the best", "[detection][axis]") {
  Random random(64, 0);
  int trusted = 0;
  for (int k = 0; k < 300; ++k) {
    const auto half = [&] { return Vec3(random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1)); };
    const auto turned = [&] {  // a hull that is a box about some point in some direction
      const Box box(half());
      const Quat turn = testing::random_turn(random);
      std::vector<Vec3> points;
      for (const Vec3& v : box.hull.vertices)
        points.push_back(turn * v + 0.05 * Vec3(1, -1, 0.5) * box.hull.inner_radius);
      std::vector<std::vector<std::uint32_t>> faces{{1, 3, 7, 5}, {0, 4, 6, 2}, {2, 6, 7, 3},
                                                    {0, 1, 5, 4}, {4, 5, 7, 6}, {0, 2, 3, 1}};
      return ConvexHull::from_faces(points, faces).hull;
    };
    const ConvexHull a = turned(), b = turned();
    REQUIRE(a.box_frame.has_value());
    const PolyhedronPair pair(
        a.view(), b.view(), {},
        {random.uniform(0, 1.2) * testing::random_direction(random), testing::random_turn(random)});
    const auto [start, alone] = box_axis(pair);
    const SeparatingAxis found = separating_axis(pair);
    if (found.gap > 0.0) continue;
    if (alone) {  // then no search is made: it would end with these bits
      ++trusted;
      AxisSearch search(pair);
      search.start_from(start);
      CHECK(same_bits(search.best(), found));
    }
    CHECK(std::abs(start.gap - found.gap) < 1e-14);
    CHECK(std::abs(pair.separation(start.normal) - found.gap) < 1e-14);
  }
  CHECK(trusted > 60);
  // Parallel axes, to rounding or less than a thousandth of a degree, have more than one best: they are searched.
  const Box box(Vec3(0.5, 0.4, 0.3));
  for (const double angle : {0.0, 1e-12, 1e-8, 1e-5})
    for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(1, 1, 1)})
      CHECK_FALSE(
          box_axis(
              {box.view(), box.view(), {}, {Vec3(0.1, 0.2, 0.5), Quat(Eigen::AngleAxisd(angle, axis.normalized()))}})
              .alone);
  CHECK_FALSE(support::unit_tetrahedron().box_frame.has_value());
  CHECK_FALSE(support::random_hull(random, 8).box_frame.has_value());
}

TEST_CASE("two edges that touch have their points on them", "[detection][axis]") {
  // Cubes of side 1 turned by 45 degrees about x and about y, one above the other: edges cross over the origin.
  const Box cube(Vec3::Constant(0.5));
  const double quarter = std::atan(1.0), height = 1.41421356237309505;
  const Quat qa(Eigen::AngleAxisd(quarter, Vec3::UnitX())), qb(Eigen::AngleAxisd(quarter, Vec3::UnitY()));
  for (const double gap : {0.1, 1e-3, -1e-3, -0.05}) {
    const PolyhedronPair pair(cube.view(), cube.view(), {Vec3::Zero(), qa}, {Vec3(0.1, 0.05, height + gap), qb});
    const auto d = polyhedron_distance(pair);
    CHECK(std::abs(d.axis.gap - gap) < 1e-15);
    const Vec3 on_a = qa * d.witness_a, on_b = qa * d.witness_b;
    CHECK((on_a - Vec3(0.1, 0.0, 0.5 * height)).norm() < 0.06);  // A's edge runs along x at y = 0
    CHECK(std::abs(on_a.y()) < 1e-15);
    CHECK(std::abs(on_b.x() - 0.1) < 1e-15);  // B's along y at x = 0.1
    CHECK(std::abs(on_b.z() - (0.5 * height + gap)) < 1e-15);
  }
}
