#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/polyhedra/polyhedra.h"
#include "tests/support/catch.h"
#include "tests/support/convex_corpus.h"
#include "tests/support/polyhedra.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using testing::upright;

namespace {

/// What doubles can resolve: 1e-12 of the smaller body, and a few ulp of the largest coordinate (size ratios, far
/// bodies).
double allowance(const support::CorpusPair& p) {
  double largest = std::max(p.a.centre.norm(), p.b.centre.norm());
  for (const auto* body : {&p.a, &p.b}) {
    for (const Vec3& v : body->vertices) largest = std::max(largest, v.norm());
  }
  return 1e-12 * p.size + 1e-15 * largest;
}

ConvexHull hull_of(const support::CorpusBody& body, double scale = 1.0) {
  std::vector<Vec3> vertices = body.vertices;
  for (Vec3& v : vertices) v *= scale;
  auto built = ConvexHull::from_faces(vertices, body.faces);
  REQUIRE(built.problem.empty());
  return built.hull;
}

struct Errors {
  int wrong_class = 0, off_distance = 0, off_normal = 0;
  bool none() const { return wrong_class == 0 && off_distance == 0 && off_normal == 0; }
};

const std::vector<support::CorpusPair>& corpus() {
  static const auto pairs = support::read_corpus(EPAFI_SOURCE_DIR "/tests/data/convex_pairs.bin");
  return pairs;
}

/// d of a pair whose lengths were multiplied by scale; n in the corpus' axes.
void judge(const support::CorpusPair& p, double gap, const Vec3& n, double scale, double allowed, Errors& errors) {
  const double distance = gap / scale;
  errors.wrong_class += std::abs(p.distance) > allowed && (distance < 0.0) != (p.distance < 0.0);
  errors.off_distance += !(std::abs(distance - p.distance) <= allowed);
  // A direction is judged by how much it separates: several are equally good in symmetric cases.
  errors.off_normal += !(static_cast<double>(p.distance - p.separation(n)) <= allowed);
}

PolyhedronDistance distance(const ConvexHull& a, const Pose& pa, const ConvexHull& b, const Pose& pb) {
  return polyhedron_distance({a.view(), b.view(), pa, pb});
}

}  // namespace

TEST_CASE("distances and depths of the exact corpus are right to 1e-12 of the size, at any scale",
          "[detection][accuracy]") {
  REQUIRE(corpus().size() == 209);
  for (const double scale : {1.0, 1e-6, 1e6, 1.0 / 3.0}) {
    Errors errors, swapped;
    for (const auto& p : corpus()) {
      const ConvexHull a = hull_of(p.a, scale), b = hull_of(p.b, scale);
      const Pose pa{scale * p.a.centre, upright}, pb{scale * p.b.centre, upright};
      const auto d = distance(a, pa, b, pb);
      judge(p, d.axis.gap, d.axis.normal, scale, allowance(p), errors);
      CHECK((d.witness_b - d.witness_a - d.axis.gap * d.axis.normal).norm() <= 1e-9 * a.radius + 1e-9 * b.radius);
      const auto s = distance(b, pb, a, pa);
      judge(p, s.axis.gap, -s.axis.normal, scale, allowance(p), swapped);
    }
    INFO("scale " << scale << ": " << errors.wrong_class << " wrong classes, " << errors.off_distance << " distances, "
                  << errors.off_normal << " normals");
    CHECK(errors.none());
    INFO("swapped: " << swapped.wrong_class << " wrong classes, " << swapped.off_distance << " distances, "
                     << swapped.off_normal << " normals");
    CHECK(swapped.none());
  }
}

TEST_CASE("a common rigid motion leaves the distances of the corpus", "[detection][accuracy]") {
  Random random(11, 0);
  Errors errors;
  for (const auto& p : corpus()) {
    const ConvexHull a = hull_of(p.a), b = hull_of(p.b);
    const Quat turn = testing::random_turn(random);
    // Both centres relative to A's: the motion's own rounding, not the algorithm's, is that of the distance between
    // them.
    const auto d = distance(a, {Vec3::Zero(), turn}, b, {turn * Vec3(p.b.centre - p.a.centre), turn});
    const double rounding = 1e-15 * ((p.b.centre - p.a.centre).norm() + a.radius + b.radius);
    judge(p, d.axis.gap, d.axis.normal, 1.0, allowance(p) + rounding, errors);  // A's axes are the corpus' axes
  }
  CHECK(errors.none());
}

TEST_CASE("random polyhedra agree with brute force", "[detection][accuracy]") {
  Random random(12, 0);
  double worst = 0.0;
  for (int k = 0; k < 300; ++k) {
    const auto body = [&] {
      const double kind = random.uniform();
      if (kind < 0.25) return Box(Vec3(random.uniform(0.2, 1), random.uniform(0.2, 1), random.uniform(0.2, 1))).hull;
      if (kind < 0.45) return support::unit_tetrahedron();
      return support::random_hull(random, 8 + static_cast<std::size_t>(random.uniform() * 20));
    };
    const ConvexHull a = body(), b = body();
    const Pose pa{testing::random_point(random), testing::random_turn(random)};
    const Pose pb{pa.position + random.uniform(0, 2.2) * testing::random_direction(random),
                  testing::random_turn(random)};
    const auto d = distance(a, pa, b, pb);
    worst = std::max(worst, std::abs(d.axis.gap - support::brute_force_distance(a, pa, b, pb)));
    CHECK(d.uncertainty < 1e-13);
  }
  CHECK(worst < 1e-14);  // bodies of size 1: some 50 ulp for the turns and differences
}

TEST_CASE("degenerate poses have their exact answers", "[detection][accuracy]") {
  const Box cube(Vec3::Constant(0.5));
  const auto boxes = [](const Box& a, const Box& b, const Vec3& centre, const Quat& turn,
                        const Quat& turn_a = upright) {
    return distance(a.hull, {Vec3::Zero(), turn_a}, b.hull, {centre, turn}).axis.gap;
  };
  const auto about = [](const Vec3& axis, double angle) { return Quat(Eigen::AngleAxisd(angle, axis.normalized())); };
  // Nested boxes of half widths 1 and 0.1: 1 + 0.1 along any face normal.
  CHECK(boxes(Box(Vec3::Ones()), Box(Vec3::Constant(0.1)), Vec3::Zero(), upright) == Approx(-1.1).epsilon(1e-15));
  CHECK(boxes(cube, cube, Vec3::Zero(), upright) == Approx(-1.0).epsilon(1e-15));
  // Two equal tetrahedra in one place: the width between opposite edges, 1/sqrt(2), not that across a face, 0.8165.
  const ConvexHull t = support::unit_tetrahedron();
  CHECK(distance(t, {}, t, {}).axis.gap == Approx(-std::sqrt(0.5)).epsilon(1e-15));
  // Cubes turned 45 degrees about x and about y, 1.5 apart in z: 1.5 - sqrt(2) between crossed edges.
  const double quarter = std::atan(1.0);
  CHECK(std::abs(boxes(cube, cube, {0, 0, 1.5}, about(Vec3::UnitY(), quarter), about(Vec3::UnitX(), quarter)) -
                 (1.5 - std::sqrt(2.0))) < 1e-15);
  // A needle 1 x 1e-3 x 1e-6 lying 1e-9 above a cube: the gap is the difference of stored heights.
  const Box needle(Vec3(0.5, 0.5e-3, 0.5e-6));
  const double height = 0.5 + 0.5e-6 + 1e-9;
  CHECK(std::abs(boxes(cube, needle, {0, 0, height}, upright) - (height - 0.5 - 0.5e-6)) < 2e-16);
  // Published separating-axis answers for turned cubes and a thin plate (8 digits).
  const Quat turned = about({1, 2, 3}, 1.0);
  CHECK(std::abs(boxes(cube, cube, {0.9, 0.3, 0.2}, turned) + 0.46521815) < 5e-9);
  CHECK(std::abs(boxes(cube, Box(Vec3(0.5, 0.5, 1e-6)), {0.9, 0.3, 0.2}, turned) + 0.037631283) < 5e-10);
  // Turned by 1e-8: about x the corner dips 0.5e-8 below the face, 1e-7 + 0.5e-8; about z nothing dips.
  CHECK(std::abs(boxes(cube, cube, {0, 0, 0.9999999}, about(Vec3::UnitX(), 1e-8)) + 1.05e-7) < 2e-15);
  CHECK(std::abs(boxes(cube, cube, {0, 0, 0.9999999}, about(Vec3::UnitZ(), 1e-8)) + 1.0e-7) < 2e-15);
}

TEST_CASE("gaps of both signs from 1 to 1e-15 are told apart", "[detection][accuracy]") {
  Random random(13, 0);
  for (int k = 0; k <= 15; ++k) {
    for (const double sign : {1.0, -1.0}) {
      const double wanted = sign * std::pow(10.0, -k);
      const Box a(Vec3::Constant(0.5)), b(Vec3(0.25, 0.3, 0.5));
      const Vec3 centre(0.1, -0.2, 1.0 + wanted);  // stored: the gap is exactly centre.z - 1
      const double exact = std::max({centre.z() - 1.0, std::abs(centre.x()) - 0.75, std::abs(centre.y()) - 0.8});
      CHECK(std::abs(distance(a.hull, {}, b.hull, {centre, upright}).axis.gap - exact) < 3e-16);
      const Quat turn = testing::random_turn(random);
      CHECK(std::abs(distance(a.hull, {Vec3::Zero(), turn}, b.hull, {turn * centre, turn}).axis.gap - exact) < 3e-15);
    }
  }
}

TEST_CASE("aspect ratios and size ratios to 1e6 keep the depth of slabs", "[detection][accuracy]") {
  for (double ratio = 1.0; ratio < 2e6; ratio *= 10.0) {
    const Box plate(Vec3(0.5, 0.5, 0.5 / ratio)), cube(Vec3::Constant(0.5)), small(Vec3::Constant(0.5 / ratio));
    const double overlap = 0.25 / ratio;
    const double z = 0.5 + 0.5 / ratio - overlap;
    CHECK(std::abs(distance(cube.hull, {}, plate.hull, {{0.3, 0.2, z}, upright}).axis.gap - (z - 0.5 - 0.5 / ratio)) <
          2e-16);
    CHECK(std::abs(distance(cube.hull, {}, small.hull, {{0.3, 0.2, z}, upright}).axis.gap - (z - 0.5 - 0.5 / ratio)) <
          2e-16);
  }
}

TEST_CASE("a million metres from the origin only the stored positions round", "[detection][accuracy]") {
  const Vec3 far(1e6, 1e6, 1e6);
  const Box a(Vec3::Constant(0.5)), b(Vec3::Constant(0.25));
  const Vec3 centre = far + Vec3(0.1, 0.05, 0.7);
  const double exact = (centre - far).z() - 0.75;
  CHECK(std::abs(distance(a.hull, {far, upright}, b.hull, {centre, upright}).axis.gap - exact) < 2e-16);
}
