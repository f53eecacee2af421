#include "detection/shapes/superquadric.h"

#include <numbers>

#include "detection/shapes/ellipsoid.h"
#include "detection/shapes/whole_root.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;

namespace {

/// (|x/a|^n + |y/b|^n)^(m/n) + |z/c|^m
double level(const Superquadric& s, const Vec3& x) {
  const Vec3 u = x.cwiseQuotient(s.semi_axes).cwiseAbs();
  return std::pow(std::pow(u.x(), s.across) + std::pow(u.y(), s.across), static_cast<double>(s.along) / s.across) +
         std::pow(u.z(), s.along);
}

}  // namespace

TEST_CASE("whole roots are those of libm to a few ulp", "[detection][superquadric]") {
  Random random(121, 0);
  for (int k = 1; k <= 32; ++k)
    for (int j = 0; j < 100; ++j) {
      const double x = std::exp(random.uniform(-200, 50));
      CHECK(whole_root(x, k) == Approx(std::pow(x, 1.0 / k)).epsilon(1e-14));
    }
  CHECK(whole_root(0.0, 7) == 0.0);
  CHECK(whole_root(5e-324, 3) == Approx(std::cbrt(5e-324)).epsilon(1e-14));
  CHECK(whole_root(1.0, 7) == 1.0);
}

TEST_CASE("the support lies on the surface and no point of the surface goes farther", "[detection][superquadric]") {
  Random random(122, 0);
  for (const auto& [n, m] :
       {std::pair(2, 2), std::pair(2, 8), std::pair(4, 4), std::pair(3, 5), std::pair(16, 2), std::pair(32, 32)}) {
    const Superquadric s(Vec3(1.0, 0.6, 0.3), n, m);
    for (int k = 0; k < 100; ++k) {
      const Vec3 d = k < 3 ? Vec3(Vec3::Unit(k)) : testing::random_direction(random);
      const Vec3 x = s.support(d);
      CHECK(level(s, x) == Approx(1.0).epsilon(1e-12));
      CHECK(x.norm() <= s.bounding_radius());
      for (int j = 0; j < 100; ++j) {
        Vec3 y = testing::random_direction(random).cwiseProduct(s.semi_axes);
        y /= std::pow(level(s, y), 1.0 / s.along);  // homogeneous of degree m
        CHECK(d.dot(y) <= d.dot(x) + 1e-13);
        CHECK(y.norm() <= s.bounding_radius());
      }
    }
  }
}

TEST_CASE("mass and inertia: exponents of 2 give the ellipsoid, large ones approach the box",
          "[detection][superquadric]") {
  const Vec3 abc(1.0, 0.6, 0.3);
  const MassProperties two = Superquadric(abc, 2, 2).mass_properties(), round = Ellipsoid(abc).mass_properties();
  CHECK(two.mass == Approx(round.mass).epsilon(1e-13));
  CHECK((two.inertia - round.inertia).norm() < 1e-13);
  CHECK(Superquadric(abc, 32, 32).volume() == Approx(8 * abc.prod()).epsilon(0.02));
  CHECK(Superquadric(abc, 2, 32).volume() ==
        Approx(2 * std::numbers::pi * abc.prod()).epsilon(0.01));  // elliptic cylinder
  // Inside by counting on a grid: an independent quadrature, good to the grid's 1e-3.
  const Superquadric s(abc, 4, 3);
  double volume = 0.0;
  Vec3 second = Vec3::Zero();
  constexpr int cells = 60;
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j)
      for (int k = 0; k < cells; ++k) {
        const Vec3 x = Vec3((i + 0.5) / cells, (j + 0.5) / cells, (k + 0.5) / cells).cwiseProduct(abc);
        if (level(s, x) > 1.0) continue;
        volume += 1.0;
        second += x.cwiseProduct(x);
      }
  const double cell = 8 * abc.prod() / (cells * cells * cells);
  const MassProperties mass = s.mass_properties();
  CHECK(mass.mass == Approx(volume * cell).epsilon(2e-3));
  CHECK(mass.inertia(0, 0) == Approx((second.y() + second.z()) * cell).epsilon(3e-3));
  CHECK(mass.inertia(2, 2) == Approx((second.x() + second.y()) * cell).epsilon(3e-3));
}
