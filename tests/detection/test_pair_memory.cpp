// What a pair remembers is a shortcut: over any motion the answer is the one of a search from nothing, bit for bit.
#include "detection/narrow/polyhedra/pair_memory.h"

#include "detection/narrow/polyhedra/axis_search.h"
#include "detection/narrow/polyhedra/nearest_features.h"
#include "tests/support/catch.h"
#include "tests/support/convex_corpus.h"
#include "tests/support/polyhedra.h"
#include "tests/support/same_bits.h"

using namespace epafi;

namespace {

struct Count {
  long asked = 0, differ = 0, overlapping = 0, recalled = 0;
};

/// Steps of a body whose size is `size`: still, drifting, trembling, jumping and coming back.
Pose moved(const Pose& start, const Pose& now, int step, double size, Random& random) {
  static constexpr double stride[] = {1e-3, 1e-3, 1e-6, 1e-10, 0.0, 1e-3, 0.03, 1e-4};
  const double s = stride[(step / 4) % 8];
  const Pose& from = step % 16 == 15 ? start : now;
  Pose p = from;
  p.position += s * size * testing::random_direction(random);
  if (step % 3) p.orientation = Quat(Eigen::AngleAxisd(s, testing::random_direction(random))) * from.orientation;
  return p;
}

void follow(const ConvexHull& a, const ConvexHull& b, const Pose& pa, const Pose& start, double size, int steps,
            Random& random, Count& count, double limit = infinity) {
  PairMemory memory;
  Pose pb = start;
  for (int step = 0; step < steps; ++step) {
    const PolyhedronPair pair(a.view(), b.view(), pa, pb);
    const PolyhedronDistance cold = polyhedron_distance(pair, limit);
    const auto uses = memory.uses;
    PolyhedronDistance certified;
    count.recalled += certify(pair, memory.nearest, certified);
    const PolyhedronDistance warm = polyhedron_distance(pair, limit, &memory);
    count.recalled += memory.uses > uses;
    ++count.asked;
    count.overlapping += cold.axis.gap < 0.0;
    count.differ += !(cold.beyond && warm.beyond) && !support::same_bits(cold, warm);
    pb = moved(start, pb, step, size, random);
  }
}

}  // namespace

TEST_CASE("a pair that moves a little has the answer of a search from nothing, bit for bit", "[detection][memory]") {
  Random random(81, 0);
  Count count;
  for (const auto& p : support::read_corpus(EPAFI_SOURCE_DIR "/tests/data/convex_pairs.bin")) {
    const ConvexHull a = ConvexHull::from_faces(p.a.vertices, p.a.faces).hull,
                     b = ConvexHull::from_faces(p.b.vertices, p.b.faces).hull;
    const Pose pa{p.a.centre, Quat(1, 0, 0, 0)}, pb{p.b.centre, Quat(1, 0, 0, 0)};
    follow(a, b, pa, pb, p.size, 64, random, count);
    follow(b, a, pb, pa, p.size, 32, random, count, 1e-3 * p.size);
  }
  for (int k = 0; k < 100; ++k) {
    const auto body = [&] {
      return k % 3 == 0 ? Box(Vec3(0.3, 0.4, random.uniform(0.1, 0.6))).hull
                        : support::random_hull(random, 4 + static_cast<std::size_t>(random.uniform() * 40));
    };
    const ConvexHull a = body(), b = body();
    const Pose pa{testing::random_point(random), testing::random_turn(random)};
    const Pose pb{pa.position + random.uniform(0.2, 1.1) * (a.radius + b.radius) * testing::random_direction(random),
                  k % 2 ? testing::random_turn(random) : pa.orientation};
    follow(a, b, pa, pb, b.radius, 64, random, count);
  }
  INFO(count.asked << " asked, " << count.differ << " differ, " << count.overlapping << " overlapping, "
                   << count.recalled << " from memory");
  CHECK(count.differ == 0);
  CHECK(count.overlapping > count.asked / 3);
  CHECK(count.recalled > count.asked / 2);  // the shortcut is taken, or this test shows nothing
}

TEST_CASE("boxes that rest on each other, exactly or nearly parallel, are remembered without a trace",
          "[detection][memory]") {
  Random random(82, 0);
  const Box box(Vec3(0.5, 0.4, 0.3)), other(Vec3(0.3, 0.4, 0.3));
  Count count;
  for (int k = 0; k < 60; ++k) {
    const double tilt = k % 4 == 0 ? 0.0 : std::pow(10.0, -4 - k % 9);
    const double gap = (k % 2 ? -1.0 : 1.0) * std::pow(10.0, -1 - k % 12);
    const Quat turn(Eigen::AngleAxisd(tilt, testing::random_direction(random)));
    const Pose pose{Vec3(k % 3 ? 0.1 : 0.0, k % 5 ? 0.05 : 0.0, 0.6 + gap), turn};
    follow(box.hull, k % 2 ? box.hull : other.hull, {}, pose, 1e-3, 64, random, count);
    follow(box.hull, k % 2 ? box.hull : other.hull, {}, pose, 1e-9, 64, random, count);
  }
  INFO(count.asked << " asked, " << count.differ << " differ");
  CHECK(count.differ == 0);
}

TEST_CASE("stones that roll on each other in one direction are remembered without a trace", "[detection][memory]") {
  Random random(85, 0);
  long asked = 0, differ = 0, recalled = 0;
  for (int k = 0; k < 400; ++k) {
    const ConvexHull a = support::random_hull(random, 16), b = support::random_hull(random, 16);
    Pose pb{(a.radius + b.radius) * testing::random_direction(random), testing::random_turn(random)};
    const Vec3 glide = 1e-3 * a.radius * testing::random_direction(random);
    const Quat roll(Eigen::AngleAxisd(2e-3, testing::random_direction(random)));
    PairMemory memory;
    for (int step = 0; step < 60; ++step) {
      const PolyhedronDistance now = polyhedron_distance(PolyhedronPair(a.view(), b.view(), {}, pb));
      pb.position -= (now.axis.gap + 3e-4 * a.radius) * now.axis.normal;  // held at a small overlap, as in a pile
      const PolyhedronPair pair(a.view(), b.view(), {}, pb);
      const auto uses = memory.uses;
      const PolyhedronDistance warm = polyhedron_distance(pair, infinity, &memory);
      ++asked;
      recalled += memory.uses > uses;
      differ += !support::same_bits(polyhedron_distance(pair), warm);
      pb.position += glide;
      pb.orientation = roll * pb.orientation;
    }
  }
  CHECK(differ == 0);
  CHECK(recalled > asked / 4);
}

TEST_CASE("features that do not hold the closest points are refused", "[detection][memory]") {
  using Kind = NearestFeatures::Kind;
  Random random(83, 0);
  int passed = 0;
  for (int k = 0; k < 60; ++k) {
    const ConvexHull a = support::random_hull(random, 8), b = support::random_hull(random, 10);
    const PolyhedronPair pair(
        a.view(), b.view(), {},
        {random.uniform(1.5, 2.5) * testing::random_direction(random), testing::random_turn(random)});
    const double exact = support::brute_force_distance(a, {}, b, Pose{pair.offset, Quat(pair.rotation)});
    const auto any = [&](Kind kind, std::size_t count_a, std::size_t count_b) {
      for (std::uint32_t i = 0; i < count_a; ++i)
        for (std::uint32_t j = 0; j < count_b; ++j) {
          PolyhedronDistance d;
          if (!certify(pair, {kind, i, j}, d)) continue;
          ++passed;
          CHECK(std::abs(d.axis.gap - exact) < 1e-13);
          CHECK((d.witness_b - d.witness_a - exact * d.axis.normal).norm() < 1e-13);
        }
    };
    const int before = passed;
    any(Kind::vertices, a.vertices.size(), b.vertices.size());
    any(Kind::vertex_edge, a.vertices.size(), b.edges.size());
    any(Kind::edge_vertex, a.edges.size(), b.vertices.size());
    any(Kind::edges, a.edges.size(), b.edges.size());
    any(Kind::face_vertex, a.face_normals.size(), b.vertices.size());
    any(Kind::vertex_face, a.vertices.size(), b.face_normals.size());
    CHECK(passed - before == (exact > 1e-4 ? 1 : passed - before));  // exactly one pair of features holds them
  }
  CHECK(passed > 40);
}

TEST_CASE("a memory of anything at all changes no bit", "[detection][memory]") {
  Random random(84, 0);
  int differ = 0;
  for (int k = 0; k < 2000; ++k) {
    static const ConvexHull a = support::random_hull(random, 14);
    static const Box b(Vec3(0.5, 0.4, 0.3));
    const PolyhedronPair pair(
        a.view(), b.view(), {},
        {random.uniform(0.3, 1.7) * testing::random_direction(random), testing::random_turn(random)});
    PairMemory memory;
    const auto draw = [&](std::size_t n) {
      return static_cast<std::uint32_t>(random.uniform() * static_cast<double>(n));
    };
    memory.nearest = {static_cast<NearestFeatures::Kind>(draw(7)), draw(6), draw(6)};
    memory.kind = static_cast<std::uint8_t>(draw(5));
    memory.feature_a = draw(6);
    memory.feature_b = draw(6);
    memory.normal = testing::random_direction(random);
    differ += !support::same_bits(polyhedron_distance(pair, infinity, &memory), polyhedron_distance(pair));
  }
  CHECK(differ == 0);
}
