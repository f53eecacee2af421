#include "detection/narrow/pairs/hertz_radius.h"

#include "detection/narrow/pairs/half_space_pairs.h"
#include "detection/shapes/ellipsoid.h"
#include "detection/shapes/sphere.h"
#include "engine/railway/elliptic_integrals.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/pair_contacts.h"
#include "tests/support/random_geometry.h"

using namespace epafi;

namespace {

/// Complete elliptic integrals of modulus^2 = 1 - k^2 by the midpoint rule, which converges without end on a period:
/// K, and sin^2 and cos^2 over the same root.
struct Integrals {
  double K = 0.0, D = 0.0, B = 0.0;
  explicit Integrals(double k) {
    constexpr int n = 4000;
    for (int i = 0; i < n; ++i) {
      const double t = (i + 0.5) * testing::pi / (2 * n), s = std::sin(t), c = std::cos(t);
      const double root = std::sqrt(c * c + k * k * s * s), weight = testing::pi / (2 * n * root);
      K += weight;
      D += weight * s * s;
      B += weight * c * c;
    }
  }
};

/// F over 4/3 E* depth^1.5, squared, after Johnson 1985, eq. 4.25 to 4.27, the axis ratio by bisection.
double radius_by_quadrature(double A, double B) {
  double low = 1e-6, high = 1.0;
  for (int n = 0; n < 60; ++n) {
    const double k = 0.5 * (low + high);
    const Integrals i(k);
    (k * k * i.D / i.B < A / B ? low : high) = k;
  }
  const Integrals i(low);
  // a^2 = depth D / (K A) and F = pi E* a depth / (1.5 K)
  const double force_over = testing::pi / (1.5 * i.K) * std::sqrt(i.D / (i.K * A));
  return std::pow(0.75 * force_over, 2);
}

ContactSet curved_contacts(const Ellipsoid& a, const Pose& pa, const Ellipsoid& b, const Pose& pb) {
  ContactSet set;
  set.with_curvature = true;
  ContactSink sink(set);
  sink.begin(0, 1);
  collide(a, b, PairQuery{pa, pb, 0.0, true}, sink);
  sink.end();
  return set;
}

}  // namespace

TEST_CASE("R* is that of Hertz' ellipse at every ratio of curvatures", "[detection][round]") {
  for (const double ratio : {1.0, 1.001, 1.5, 4.0, 25.0, 400.0})
    CHECK(hertz_radius(3.0, 3.0 * ratio) == Approx(radius_by_quadrature(3.0, 3.0 * ratio)).epsilon(1e-9));
  CHECK(hertz_radius(0.5, 0.5) == Approx(1.0).epsilon(1e-14));
  CHECK(hertz_radius(0.0, 1.0) == infinity);
}

TEST_CASE("R* holds the equations of the ellipse to the last digits and goes on from octave to octave",
          "[detection][round]") {
  // from the axis ratio k to A/B and R* A without iteration, the integrals by their mean
  Random random(65, 4);
  for (int n = 0; n < 5000; ++n) {
    const double k = std::pow(10.0, -5.0 * random.uniform(0.0, 1.0) * random.uniform(0.0, 1.0));
    const EllipticIntegrals i = elliptic_integrals(k);
    const double ratio = k * k * i.D / i.B, scale = std::pow(10.0, random.uniform(-6.0, 6.0));
    const double expected = testing::pi * testing::pi * i.D / (4.0 * i.K * i.K * i.K * scale);
    INFO("k " << k << " A/B " << ratio);
    CHECK(hertz_radius(scale, scale / ratio) == Approx(expected).epsilon(2e-13));
  }
  for (int octave = 0; octave < 30; ++octave)
    for (const double part : {1.0, 1.25, 1.5, 1.75}) {
      const double ratio = std::ldexp(part, -octave - 1);
      const double below = hertz_radius(1.0, 1.0 / (ratio * (1.0 - 1e-15)));
      CHECK(hertz_radius(1.0, 1.0 / ratio) == Approx(below).epsilon(1e-13));
    }
}

TEST_CASE("an ellipsoid on a plane sinks by what its curvatures there say", "[detection][round]") {
  // 30 N, 2 GPa, Poisson's ratio 0.25; radii of curvature b^2/a and c^2/a where the semi-axis a stands up
  const Ellipsoid e(Vec3(0.05, 0.02, 0.03));
  const double modulus = 2e9 / (2.0 * (1.0 - 0.25 * 0.25));
  const auto depth = [&](const Vec3& d) {
    const double radius = hertz_radius_on_plane(RoundRef::to(e), 0.0, d);
    const double root = std::cbrt(30.0 * 0.75 / (modulus * std::sqrt(radius)));
    return root * root;
  };
  CHECK(depth(-Vec3::UnitZ()) == Approx(2.268e-5).epsilon(3e-4));
  CHECK(depth(Vec3::UnitX()) == Approx(3.305e-5).epsilon(3e-4));
  CHECK(depth(Vec3::UnitY()) == Approx(1.785e-5).epsilon(3e-4));
}

TEST_CASE("R* of two ellipsoids takes both curvatures and the angle between them", "[detection][round]") {
  const double a = 1.0, b = 0.5, c = 0.4;
  const Ellipsoid e(Vec3(a, b, c));
  const double depth = 1e-6, along = c / (a * a), across = c / (b * b);  // curvatures at the end of c
  for (const double angle : {0.0, 0.3, 1.2, testing::pi / 2}) {
    const Pose above{{0, 0, 2 * c - depth}, Quat(Eigen::AngleAxisd(angle, Vec3::UnitZ()))};
    const ContactSet contact = curved_contacts(e, {}, e, above);
    REQUIRE(contact.size() == 1);
    // Johnson 1985, eq. 4.4 and 4.5: A + B and B - A of two pairs of curvatures that are turned by an angle
    const double sum = along + across;
    const double difference = (across - along) * std::abs(std::cos(angle));
    const double expected = hertz_radius(0.5 * (sum - difference), 0.5 * (sum + difference));
    CHECK(contact.effective_radius[0] == Approx(expected).epsilon(1e-6));
  }
}

TEST_CASE("round balls have the radius of spheres, whichever function is asked", "[detection][round]") {
  const Ellipsoid ball(Vec3::Constant(0.3));
  const Ellipsoid larger(Vec3::Constant(0.6));
  const ContactSet contact = curved_contacts(ball, {}, larger, {{0.1, 0.2, 0.8}, testing::upright});
  REQUIRE(contact.size() == 1);
  CHECK(contact.effective_radius[0] == Approx(0.2).epsilon(1e-12));
  CHECK(hertz_radius_on_plane(RoundRef::to(ball), 0.0, Vec3::UnitY()) == Approx(0.3).epsilon(1e-12));
  CHECK(hertz_radius_on_plane(RoundRef::to(Sphere{0.7}), 0.7, Vec3::UnitY()) == Approx(0.7).epsilon(1e-12));
}
