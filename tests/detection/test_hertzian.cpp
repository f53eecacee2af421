#include "detection/surfaces/hertzian.h"

#include "detection/narrow/gjk/gjk.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;

namespace {

using Status = HertzianPoints::Status;

/// Curvatures of an ellipsoid at the point with outward normal n: with w = diag(1/a^2, 1/b^2, 1/c^2) x and h = 1/|w|,
/// the Gaussian curvature is h^4 / (a b c)^2 and twice the mean curvature h^3 (a^2 + b^2 + c^2 - x^2) / (a b c)^2.
std::pair<double, double> ellipsoid_curvatures(const Vec3& axes, const Vec3& x) {
  const Vec3 square = axes.cwiseProduct(axes);
  const double h = 1.0 / x.cwiseQuotient(square).norm(), volume = square.prod();
  const double gauss = std::pow(h, 4) / volume, mean = 0.5 * std::pow(h, 3) * (square.sum() - x.squaredNorm()) / volume;
  const double root = std::sqrt(std::max(0.0, mean * mean - gauss));
  return {mean + root, mean - root};
}

}  // namespace

TEST_CASE("two spheres, apart, touching and overlapping, have the line of centres and 1/r", "[detection][hertzian]") {
  Random random(91, 0);
  for (int k = 0; k < 60; ++k) {
    const Sphere a{random.uniform(0.1, 2)}, b{random.uniform(0.1, 2)};
    const Vec3 n = testing::random_direction(random);
    const double gap =
        k % 3 == 0 ? 0.0 : (k % 3 == 1 ? 1.0 : -1.0) * 0.5 * std::min(a.radius, b.radius) * random.uniform();
    const Pose pa{testing::random_point(random), testing::random_turn(random)};
    const Pose pb{pa.position + (a.radius + b.radius + gap) * n, testing::random_turn(random)};
    const auto h = find_hertzian_points(smooth_surface(a), pa, smooth_surface(b), pb, pb.position - pa.position);
    REQUIRE(h.status == Status::found);
    CHECK(std::abs(h.gap - gap) < 1e-14);
    CHECK((h.normal - n).norm() < 1e-13);
    CHECK((h.point_a - a.radius * n).norm() < 1e-13);
    CHECK((h.point_b + b.radius * n).norm() < 1e-13);
    CHECK(h.a.larger == Approx(1 / a.radius).epsilon(1e-13));
    CHECK(h.b.smaller == Approx(1 / b.radius).epsilon(1e-13));
    CHECK(h.relative.larger == Approx(1 / a.radius + 1 / b.radius).epsilon(1e-13));  // h = gap + r^2 / 2R*
  }
}

TEST_CASE("an ellipsoid over a plane: height of its lowest point and its curvatures there", "[detection][hertzian]") {
  Random random(92, 0);
  const HalfSpace ground{Vec3::UnitZ()};
  for (int k = 0; k < 100; ++k) {
    const Ellipsoid e(Vec3(random.uniform(0.3, 2), random.uniform(0.3, 2), random.uniform(0.3, 2)));
    const Pose pe{{3, -2, random.uniform(0.1, 3)}, testing::random_turn(random)};
    const Vec3 down = pe.orientation.conjugate() * Vec3(0, 0, -1), lowest = e.support(down);
    const auto h =
        find_hertzian_points(smooth_surface(ground), {}, smooth_surface(e), pe,
                             pe.position + pe.orientation * lowest + 0.1 * testing::random_direction(random));
    REQUIRE(h.status == Status::found);
    CHECK(h.gap == Approx(pe.position.z() - e.semi_axes.cwiseProduct(down).norm()).margin(1e-13));
    CHECK((h.point_b - pe.orientation * lowest).norm() < 1e-12);
    const auto [larger, smaller] = ellipsoid_curvatures(e.semi_axes, lowest);
    CHECK(h.b.larger == Approx(larger).epsilon(1e-10));
    CHECK(h.b.smaller == Approx(smaller).epsilon(1e-10));
    CHECK(std::abs(h.a.larger) + std::abs(h.a.smaller) < 1e-15);
    CHECK(h.relative.larger == Approx(larger).epsilon(1e-10));
    // The gap over the tangent plane is the quadratic form: along either direction the surface rises by k x^2 / 2.
    for (const auto& [direction, curvature] :
         {std::pair(h.b.direction_larger, larger), std::pair(h.b.direction_smaller, smaller)}) {
      const double step = 1e-4 * e.semi_axes.minCoeff();
      const Vec3 x = pe.orientation.conjugate() * (h.point_b + step * direction);
      const Vec3 inverse = e.semi_axes.cwiseProduct(e.semi_axes).cwiseInverse();
      // root of |A^-1 (x - s down)| = 1 nearest to 0
      const double qa = down.dot(inverse.cwiseProduct(down)), qb = -x.dot(inverse.cwiseProduct(down)),
                   qc = x.dot(inverse.cwiseProduct(x)) - 1.0;
      const double rise = qc / (-qb + std::sqrt(qb * qb - qa * qc));
      CHECK(rise == Approx(0.5 * curvature * step * step).epsilon(1e-2).margin(1e-15));
    }
  }
}

TEST_CASE("two ellipsoids have the distance and the points that GJK certifies", "[detection][hertzian]") {
  Random random(93, 0);
  int apart = 0;
  for (int k = 0; k < 200; ++k) {
    const auto axes = [&] { return Vec3(random.uniform(0.4, 1), random.uniform(0.4, 1), random.uniform(0.4, 1)); };
    const Ellipsoid a(axes()), b(axes());
    const Pose pa{{}, testing::random_turn(random)};
    const Pose pb{random.uniform(0.8, 2.5) * testing::random_direction(random), testing::random_turn(random)};
    const MinkowskiDifference difference(ConvexRef::to(a), ConvexRef::to(b), pa, pb);
    const GjkResult g = gjk(difference);
    if (g.status == GjkResult::Status::overlapping) continue;
    ++apart;
    const auto h = find_hertzian_points(smooth_surface(a), pa, smooth_surface(b), pb,
                                        pa.orientation * a.support(difference.offset));
    REQUIRE(h.status == Status::found);
    CHECK(h.gap == Approx(g.upper).margin(1e-12));
    CHECK((h.normal - pa.orientation * g.normal).norm() < 1e-6);  // GJK's interval of 1e-15 leaves sqrt(1e-15) of angle
    const auto [larger, smaller] = ellipsoid_curvatures(a.semi_axes, pa.orientation.conjugate() * h.point_a);
    CHECK(h.a.larger == Approx(larger).epsilon(1e-9));
    CHECK(h.a.smaller == Approx(smaller).epsilon(1e-9));
  }
  CHECK(apart > 100);
}

TEST_CASE("crossed cylinders have Hertz's relative curvatures", "[detection][hertzian]") {
  // Johnson 1985, eq. 4.5: sum of relative curvatures 1/R1 + 1/R2, difference sqrt(1/R1^2 + 1/R2^2 + 2 cos(2 t)/(R1
  // R2)).
  const CylinderSide a{0.7}, b{0.4};
  for (const double angle : {0.1, 0.5, 1.0, 1.5}) {
    const Pose pb{{a.radius + b.radius - 0.01, 0.3, 0.2}, Quat(Eigen::AngleAxisd(angle, Vec3::UnitX()))};
    const auto h = find_hertzian_points(smooth_surface(a), {}, smooth_surface(b), pb, {0.7, 0.1, 0.1});
    REQUIRE(h.status == Status::found);
    CHECK(h.gap == Approx(-0.01).margin(1e-14));
    const double p = 1 / a.radius, q = 1 / b.radius;
    CHECK(h.relative.larger + h.relative.smaller == Approx(p + q).epsilon(1e-12));
    CHECK(h.relative.larger - h.relative.smaller ==
          Approx(std::sqrt(p * p + q * q + 2 * p * q * std::cos(2 * angle))).epsilon(1e-12));
  }
}

TEST_CASE("a ball at a ring touches it at the tube, outside, on top and in the hole", "[detection][hertzian]") {
  Random random(94, 0);
  const Torus torus{1.0, 0.3};
  for (int k = 0; k < 100; ++k) {
    const Sphere ball{random.uniform(0.05, 0.2)};
    // About the tube at angle t from outside: the tube's curvatures are 1/tube and cos t / (ring + tube cos t).
    const double t = random.uniform(-3, 3), p = random.uniform(-3, 3), gap = random.uniform(-0.02, 0.1);
    const Vec3 out(std::cos(p), std::sin(p), 0.0), n = std::cos(t) * out + std::sin(t) * Vec3::UnitZ();
    const Vec3 centre = torus.ring * out + (torus.tube + ball.radius + gap) * n;
    const Pose pt{testing::random_point(random), testing::random_turn(random)};
    const Pose pb{pt.to_world(centre), testing::random_turn(random)};
    const auto h = find_hertzian_points(smooth_surface(torus), pt, smooth_surface(ball), pb, pb.position - pt.position);
    REQUIRE(h.status == Status::found);
    CHECK(h.gap == Approx(gap).margin(1e-13));
    CHECK((h.normal - pt.orientation * n).norm() < 1e-12);
    const double round = std::cos(t) / (torus.ring + torus.tube * std::cos(t));
    CHECK(h.a.larger == Approx(1 / torus.tube).epsilon(1e-11));
    CHECK(h.a.smaller == Approx(round).epsilon(1e-10).margin(1e-12));  // negative in the hole: a saddle
    CHECK(h.relative.smaller == Approx(round + 1 / ball.radius).epsilon(1e-11));
    CHECK(std::abs(h.a.direction_larger.dot(pt.orientation * Vec3(-out.y(), out.x(), 0))) < 1e-9);
  }
}

TEST_CASE("points on a common normal that are not nearest are told", "[detection][hertzian]") {
  // The far side of a ring seen from a ball on its other side: a common normal through the hole, a saddle of the
  // distance.
  const Torus torus{1.0, 0.3};
  const Sphere ball{0.2};
  const Pose pose{{2.0, 0, 0}, Quat::Identity()};
  const auto near = find_hertzian_points(smooth_surface(torus), {}, smooth_surface(ball), pose, {1.3, 0.1, 0.1});
  CHECK(near.status == Status::found);
  CHECK(near.gap == Approx(0.5).margin(1e-13));
  const auto far = find_hertzian_points(smooth_surface(torus), {}, smooth_surface(ball), pose, {-0.7, 0.0, 0.0});
  CHECK(far.status == Status::not_nearest);
}
