#include "detection/narrow/gjk/gjk.h"

#include "detection/shapes/capsule.h"
#include "detection/shapes/cylinder.h"
#include "detection/shapes/ellipsoid.h"
#include "detection/shapes/sphere.h"
#include "tests/support/catch.h"
#include "tests/support/polyhedra.h"

using namespace epafi;

namespace {

template <class A, class B>
GjkResult run(const A& a, const Pose& pa, const B& b, const Pose& pb, const GjkOptions& options = {}) {
  return gjk(MinkowskiDifference(ConvexRef::to(a), ConvexRef::to(b), pa, pb), options);
}

Simplex simplex_of(std::initializer_list<Vec3> points) {
  Simplex s;
  for (const Vec3& p : points) s.vertex[static_cast<std::size_t>(s.count++)] = {p, p, Vec3::Zero()};
  return s;
}

}  // namespace

TEST_CASE("the sub-distance drops the vertices it does not need", "[detection][gjk]") {
  bool inside = false;
  Simplex segment = simplex_of({{1, 1, 0}, {1, -1, 0}});
  CHECK(closest_to_origin(segment, inside) == Vec3(1, 0, 0));
  CHECK(segment.count == 2);
  Simplex beyond = simplex_of({{1, 1, 0}, {1, 3, 0}});
  CHECK(closest_to_origin(beyond, inside) == Vec3(1, 1, 0));
  CHECK(beyond.count == 1);
  Simplex triangle = simplex_of({{1, 0, 1}, {-1, 1, 1}, {-1, -1, 1}});
  CHECK((closest_to_origin(triangle, inside) - Vec3(0, 0, 1)).norm() < 1e-15);
  CHECK(triangle.count == 3);
  Simplex around = simplex_of({{1, 0, 1}, {-1, 1, 1}, {-1, -1, 1}, {0, 0, -1}});
  CHECK(closest_to_origin(around, inside) == Vec3::Zero());
  CHECK(inside);
  Simplex sliver = simplex_of({{1, -1, 0}, {1, 0.25, 0}, {1, 1, 0}});  // collinear: the edges answer
  CHECK((closest_to_origin(sliver, inside) - Vec3(1, 0, 0)).norm() < 1e-15);
  CHECK_FALSE(inside);
}

TEST_CASE("the sub-distance agrees with sampling of barycentric coordinates", "[detection][gjk]") {
  Random random(21, 0);
  for (int k = 0; k < 200; ++k) {
    Simplex s = simplex_of({});
    const Vec3 shift = 1.5 * testing::random_point(random);
    for (int v = 0; v < 4; ++v) s.vertex[static_cast<std::size_t>(s.count++)].y = testing::random_point(random) + shift;
    const Simplex whole = s;
    bool inside = false;
    const Vec3 closest = closest_to_origin(s, inside);
    for (int j = 0; j < 200; ++j) {  // no point of the simplex is nearer
      Vec3 p = Vec3::Zero();
      double sum = 0.0;
      for (std::size_t v = 0; v < 4; ++v) {
        const double w = random.uniform() * random.uniform();
        p += w * whole.vertex[v].y;
        sum += w;
      }
      CHECK((p / sum).norm() >= closest.norm() - 1e-12);
    }
    // And it is in the simplex: its weights are those of a convex combination that gives it.
    if (inside) continue;
    Vec3 sum = Vec3::Zero();
    for (std::size_t v = 0; v < static_cast<std::size_t>(s.count); ++v) {
      CHECK(s.weight[v] >= 0.0);
      sum += s.weight[v] * s.vertex[v].y;
    }
    CHECK((sum - closest).norm() < 1e-12);
  }
}

TEST_CASE("cores that are points and segments have closed forms", "[detection][gjk]") {
  const auto spheres = run(Sphere{1}, {}, Sphere{2}, {{3, 4, 12}, Quat(1, 0, 0, 0)});
  CHECK(spheres.upper == Approx(13.0).epsilon(1e-15));  // 3 4 12 13
  CHECK((spheres.normal - Vec3(3, 4, 12) / 13).norm() < 1e-15);
  // Segments along z and x, 5 apart in y.
  const auto crossed =
      run(Capsule(1, 4), {}, Capsule(1, 4), {{0, 5, 0}, Quat(Eigen::AngleAxisd(2 * std::atan(1.0), Vec3::UnitY()))});
  CHECK(crossed.lower == Approx(5.0).epsilon(1e-15));
  CHECK(crossed.status == GjkResult::Status::separated);
}

TEST_CASE("smooth bodies on an axis: ellipsoid (3,2,1) and a unit ball 5 apart are 1 apart", "[detection][gjk]") {
  const auto r = run(Ellipsoid(Vec3(3, 2, 1)), {}, Ellipsoid(Vec3(1, 1, 1)), {{5, 0, 0}, Quat(1, 0, 0, 0)});
  CHECK(std::abs(r.upper - 1.0) < 1e-13);
  CHECK(r.lower <= r.upper);
  CHECK(std::abs(r.lower - 1.0) < 1e-13);
}

TEST_CASE("the interval holds the distance of random smooth bodies and the cap is kept", "[detection][gjk]") {
  Random random(22, 0);
  double widest = 0.0;
  int most = 0;
  for (int k = 0; k < 500; ++k) {
    const Ellipsoid a(Vec3(random.uniform(0.2, 1), random.uniform(0.2, 1), random.uniform(0.2, 1)));
    const Cylinder b(random.uniform(0.2, 1), random.uniform(0.2, 2));
    const Pose pa{testing::random_point(random), testing::random_turn(random)};
    const Pose pb{pa.position + random.uniform(1, 4) * testing::random_direction(random), testing::random_turn(random)};
    const auto r = run(a, pa, b, pb);
    most = std::max(most, r.iterations);
    if (r.status == GjkResult::Status::overlapping) continue;
    widest = std::max(widest, r.upper - r.lower);
    CHECK((r.witness_b - r.witness_a).norm() == Approx(r.upper).epsilon(1e-9));
    // The direction separates by `lower`, the witnesses are `upper` apart: any error would show as a reversed interval.
    CHECK(r.lower <= r.upper + 1e-15);
  }
  INFO("widest interval " << widest << ", iterations " << most);
  CHECK(widest < 1e-7);
  CHECK(most <= gjk_cap + 1);
}

TEST_CASE("a limit stops the search with a proof that it is exceeded", "[detection][gjk]") {
  Random random(23, 0);
  for (int k = 0; k < 100; ++k) {
    const ConvexHull a = support::random_hull(random, 16), b = support::random_hull(random, 16);
    const Pose pb{random.uniform(1, 5) * testing::random_direction(random), testing::random_turn(random)};
    const auto full = run(a, {}, b, pb);
    const auto limited = run(a, {}, b, pb, {0.5, 1e-15, Vec3::Zero()});
    if (limited.status == GjkResult::Status::beyond) {
      CHECK(limited.lower > 0.5);
      CHECK(full.upper > 0.5);
      CHECK(limited.iterations <= full.iterations);
    } else {
      CHECK(full.upper <= 0.5 + 1e-12);
    }
  }
}
