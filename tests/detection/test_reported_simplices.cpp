// Failures that users of other libraries reported in public trackers and that lie inside GJK or EPA, rebuilt from their
// descriptions: simplices without area, polytopes that are not convex, wrong starts. The answers are closed forms.
#include "detection/narrow/gjk/convex_answer.h"
#include "detection/narrow/gjk/epa.h"
#include "detection/shapes/all_shapes.h"
#include "tests/support/catch.h"
#include "tests/support/pair_contacts.h"
#include "tests/support/polyhedra.h"

using namespace epafi;
using support::difference;
using testing::random_direction;
using testing::random_turn;
using testing::upright;

namespace {

constexpr ConvexMethod methods[] = {ConvexMethod::automatic, ConvexMethod::gjk_epa};

Simplex simplex_of(const std::vector<Vec3>& points) {
  Simplex s;
  for (const Vec3& p : points) s.vertex[static_cast<std::size_t>(s.count++)] = {p, p, Vec3::Zero(), 0, 0};
  return s;
}

/// Signed distance of two equal cubes of edge 1 whose axes agree: apart, the distance of two points; deep, the shortest
/// way out.
double cubes_apart(const Vec3& offset) {
  const Vec3 beyond = offset.cwiseAbs() - Vec3::Ones();
  return beyond.maxCoeff() > 0.0 ? beyond.cwiseMax(0.0).norm() : beyond.maxCoeff();
}

void check_witnesses(bool parallel) {
  Random random(82, 0);
  const auto outside = [](const ConvexHull& h, const Vec3& x) {
    double most = -infinity;
    for (std::size_t f = 0; f < h.face_normals.size(); ++f)
      most = std::max(most, h.face_normals[f].dot(x) - h.face_offsets[f]);
    return most;
  };
  for (int k = 0; k < 200; ++k) {
    const ConvexHull a = Box(Vec3(0.5, 0.4, 0.3)).hull,
                     b = k % 2 ? Box(Vec3(0.3, 0.5, 0.2)).hull : support::random_hull(random, 12);
    const Pose pa{Vec3::Zero(), random_turn(random)};
    const Pose pb{0.3 * random_direction(random), parallel ? pa.orientation : random_turn(random)};
    for (const ConvexMethod method : methods) {
      const auto d = ask(method, a.view(), b.view(), pa, pb);
      if (d.distance >= 0.0) continue;
      const Vec3 between = pb.position + d.witness_b - pa.position - d.witness_a;
      CHECK((between - d.distance * d.normal).norm() < 1e-12);
      CHECK(std::abs(outside(a, pa.orientation.conjugate() * d.witness_a)) < 1e-12);
      CHECK(outside(b, pb.orientation.conjugate() * d.witness_b) < 1e-9);
    }
  }
}

}  // namespace

TEST_CASE("reported: deep witnesses lie on their bodies, a depth apart", "[detection][reported]") {
  check_witnesses(false);
}

TEST_CASE("reported: deep witnesses of parallel faces lie on their bodies", "[detection][reported]") {
  check_witnesses(true);
}

TEST_CASE("reported: collinear and repeated vertices in a simplex have a finite nearest point",
          "[detection][reported]") {
  const Vec3 p(1, 2, 0.5), e(0.3, -1, 0.2);
  const double nearest = (p - e * (p.dot(e) / e.squaredNorm())).norm();
  for (const auto& steps : {std::vector{-3.0, 1.0, 5.0}, {5.0, -3.0, 1.0}, {-3.0, -3.0, 5.0}, {1.0, 5.0, 5.0, -3.0}}) {
    std::vector<Vec3> points;
    for (const double t : steps) points.push_back(p + t * e);
    Simplex s = simplex_of(points);
    bool inside = true;
    const Vec3 x = closest_to_origin(s, inside);
    CHECK_FALSE(inside);
    CHECK(x.norm() == Approx(nearest).epsilon(1e-14));
    double sum = 0.0;
    for (int k = 0; k < s.count; ++k) sum += s.weight[static_cast<std::size_t>(k)];
    CHECK(sum == Approx(1.0).epsilon(1e-15));
  }
}

TEST_CASE("reported: a search that ends in its first step has a unit normal", "[detection][reported]") {
  const Sphere ball{0.5};
  const Box cube(Vec3::Constant(0.5));
  const auto check = [](const GjkResult& g, double distance) {
    CHECK(g.iterations <= 2);
    CHECK(std::abs(g.normal.norm() - 1.0) < 1e-15);
    CHECK(g.upper == Approx(distance).epsilon(1e-15));
  };
  check(gjk(difference(ball, {}, ball, {{3, 0, 0}, upright})), 3.0);  // cores are points: one vertex is the difference
  check(gjk(difference(cube, {}, cube, {{3, 3, 3}, upright})), 2 * std::sqrt(3.0));
}

TEST_CASE("reported: the start of the search changes no answer", "[detection][reported]") {
  Random random(81, 0);
  for (int k = 0; k < 300; ++k) {
    const ConvexHull a = support::random_hull(random, 8 + random.bits() % 17), b = support::random_hull(random, 7);
    const Pose pa{Vec3::Zero(), random_turn(random)}, pb{2.5 * random_direction(random), random_turn(random)};
    const auto d = difference(a, pa, b, pb);
    const GjkResult first = gjk(d);
    for (const Vec3& guess : {Vec3(random_direction(random)), Vec3(-first.normal), Vec3(1e-9 * Vec3::UnitX())}) {
      const GjkResult g = gjk(d, {infinity, 1e-15, guess});
      CHECK((g.status == GjkResult::Status::overlapping) == (first.status == GjkResult::Status::overlapping));
      if (first.status != GjkResult::Status::overlapping) CHECK(std::abs(g.lower - first.lower) < 1e-13);
    }
  }
}

TEST_CASE(
    "reported: equal cubes at offsets of quarters, where the origin lies on vertices, edges and faces of simplices",
    "[detection][reported]") {
  const Box cube(Vec3::Constant(0.5));
  for (int i = 0; i <= 5; ++i)
    for (int j = 0; j <= i; ++j)
      for (int k = 0; k <= j; ++k)
        for (const ConvexMethod method : methods) {
          const Vec3 offset(0.25 * i, 0.25 * j, 0.25 * k);
          const auto d = ask(method, cube.view(), cube.view(), {}, {offset, upright});
          INFO(offset.transpose() << " by method " << static_cast<int>(method));
          CHECK(std::abs(d.distance - cubes_apart(offset)) < 1e-15);
          CHECK(std::abs(d.normal.norm() - 1.0) < 1e-15);
          // pushed out by the depth it touches
          if (d.distance < 0.0) CHECK(std::abs(cubes_apart(offset - d.distance * d.normal)) < 1e-15);
        }
}

TEST_CASE("reported: the depth of cubes face to face is never one to two edges too large", "[detection][reported]") {
  const Box cube(Vec3::Constant(0.5)), slab(Vec3(2, 2, 0.1));
  for (double depth = 0.3; depth > 1e-9; depth *= 0.1)
    for (const double aside : {0.0, 1e-9, 0.1, 0.25}) {
      const Penetration equal = epa(difference(cube, {}, cube, {{aside, 0, 1 - depth}, upright}), 1e-12);
      CHECK(equal.upper == Approx(depth).epsilon(1e-12).margin(1e-14));
      CHECK(equal.lower == Approx(depth).epsilon(1e-12).margin(1e-12));
      const Penetration large =
          epa(difference(cube, {}, slab, {{aside, aside, 0.6 - std::min(depth, 0.15)}, upright}), 1e-12);
      CHECK(large.upper == Approx(std::min(depth, 0.15)).epsilon(1e-12).margin(1e-14));
    }
}

TEST_CASE("reported: of two equally deep axes one is taken, and kept when the other is better by rounding only",
          "[detection][reported]") {
  const Box cube(Vec3::Constant(0.5));
  const auto normal_at = [&](double dx, double dy) {
    return ask(ConvexMethod::automatic, cube.view(), cube.view(), {}, {{0.75 + dx, 0.75 + dy, 0.1}, upright}).normal;
  };
  CHECK(normal_at(0, 0).isApprox(Vec3::UnitX(), 1e-15));
  CHECK(normal_at(1e-3, 0).isApprox(Vec3::UnitX(), 1e-15));
  CHECK(normal_at(0, 1e-3).isApprox(Vec3::UnitY(), 1e-15));
}

TEST_CASE("reported: bodies of a micrometre push each other apart, not together", "[detection][reported]") {
  for (const double size : {1e-3, 1e-6, 1e-9}) {
    const Box cube(Vec3::Constant(0.5 * size));
    const Sphere ball{0.5 * size};
    const auto d =
        ask(ConvexMethod::automatic, cube.view(), cube.view(), {}, {{0.1 * size, 0.2 * size, 0.99 * size}, upright});
    CHECK(d.normal.isApprox(Vec3::UnitZ(), 1e-15));
    CHECK(d.distance == Approx(-0.01 * size).epsilon(1e-12));
    const GjkResult g = gjk(difference(cube, {}, ball, {{0, 0, 0.99 * size}, upright}));  // the core is a point
    CHECK(g.normal.isApprox(Vec3::UnitZ(), 1e-15));
    CHECK(g.lower - ball.radius == Approx(-0.01 * size).epsilon(1e-12));
  }
}

TEST_CASE("reported: polyhedra of 24 vertices have the distance of brute force", "[detection][reported]") {
  Random random(83, 0);
  for (int k = 0; k < 40; ++k) {
    const ConvexHull a = support::random_hull(random, 24), b = support::random_hull(random, 24);
    const Pose pa{Vec3::Zero(), random_turn(random)},
        pb{random.uniform(1.0, 2.3) * random_direction(random), random_turn(random)};
    const double exact = support::brute_force_distance(a, pa, b, pb);
    for (const ConvexMethod method : methods)
      CHECK(std::abs(ask(method, a.view(), b.view(), pa, pb).distance - exact) < 1e-12);
  }
}

TEST_CASE("reported: a search close to contact converges, from a tenth of the size to 1e-13", "[detection][reported]") {
  Random random(84, 0);
  const Ellipsoid egg(Vec3(1, 0.7, 0.5));
  const Capsule rod(0.2, 1.0);
  for (double gap = 0.1; gap > 1e-13; gap *= 0.1)
    for (int k = 0; k < 20; ++k) {
      const ConvexHull a = support::random_hull(random, 10), b = support::random_hull(random, 10);
      const Pose pa{Vec3::Zero(), random_turn(random)};
      Pose pb{Vec3::Zero(), random_turn(random)};
      const auto place = [&](const auto& s, const auto& t, double wanted) {
        pb.position.setZero();
        const auto deep = difference(s, pa, t, pb);
        const Vec3 n = random_direction(random);  // A's axes: out along n by the support of the difference
        pb.position = pa.orientation * Vec3((deep.support(n).y.dot(n) + wanted) * n);
        return gjk(difference(s, pa, t, pb));
      };
      for (const GjkResult& g : {place(a, b, gap), place(egg, rod, gap), place(a, egg, gap)}) {
        CHECK(g.status != GjkResult::Status::overlapping);
        CHECK(g.iterations < gjk_cap);
        CHECK(g.upper - g.lower < 1e-10);
        CHECK(g.lower > 0.5 * gap);
      }
    }
}

TEST_CASE("reported: a cylinder on a box ends in every place, and stands its height above", "[detection][reported]") {
  const Cylinder can(0.25, 0.5);
  const Box box(Vec3(1, 1, 0.5));
  for (double x = 0.0; x <= 1.3; x += 0.05)
    for (const double gap : {-1e-2, -1e-6, 0.0, 1e-9, 1e-3}) {
      const Pose pb{{x, 0.3 * x, 0.75 + gap}, upright};
      const auto d = difference(box, {}, can, pb);
      const GjkResult g = gjk(d);
      CHECK(g.iterations < gjk_cap);
      if (x > 1.2 || g.status != GjkResult::Status::overlapping) continue;
      const Penetration p = epa(d, 1e-12);
      CHECK(p.upper < std::abs(gap) + 1e-9);  // up, or a shorter way aside
    }
}

TEST_CASE("reported: positions that are no numbers end the search", "[detection][reported]") {
  const Box cube(Vec3::Constant(0.5));
  const ConvexHull tetrahedron = support::unit_tetrahedron();
  const double nan = std::nan("");
  for (const Pose& pb :
       {Pose{{nan, 0, 0}, upright}, Pose{Vec3::Constant(nan), upright}, Pose{{0, 0, 1}, Quat(nan, 0, 0, 0)}}) {
    CHECK(gjk(difference(Sphere{0.1}, {}, cube, pb)).iterations <= gjk_cap + 1);
    for (const ConvexMethod method : methods) {
      const auto d = ask(method, cube.view(), tetrahedron.view(), {}, pb);  // it ends; the engine stops such a state
      CHECK_FALSE((d.distance < 0.0 && std::isfinite(d.distance) && std::string(d.status) == "ok" &&
                   d.witness_a.allFinite() && d.witness_b.allFinite()));
    }
  }
}
