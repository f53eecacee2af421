// Hertz by exact elliptic integrals against values from an independent calculation (quadrature of the integrals) and
// limits in closed form.
#include <cmath>
#include <numbers>

#include "engine/railway/elliptic_integrals.h"
#include "laws/wheel_rail/normal/hertz_ellipse.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {
using std::numbers::pi;
}

TEST_CASE("Hertz ellipses of wheel and rail agree with independent values to 1e-8", "[laws][wheel_rail]") {
  struct Row {
    double N, x1, y1, x2, y2, E, nu, a, b, p0, approach, stiffness;  // N, mm, MPa
  };
  const double inf = INFINITY;
  const Row rows[] = {
      {80000, 460, inf, inf, 300, 210000, 0.3, 6.648311279, 5.001007674, 1148.847827, 0.08972698777, 1337390.266},
      {1000, 50, 50, inf, inf, 210000, 0.3, 0.6875344335, 0.6875344335, 1010.072341, 0.009454071946, 158661.7924},
      {80000, 460, -330, inf, 300, 210000, 0.3, 4.29971178, 15.6702515, 566.9125378, 0.05730070498, 2094215.072},
      {80000, 500, inf, inf, 80, 210000, 0.28, 8.264393799, 2.476776937, 1866.093822, 0.1066403548, 1125277.576},
      {60000, 460, inf, inf, 13, 210000, 0.28, 8.53529052, 0.8701773066, 3857.15042, 0.1083094754, 830952.2288}};
  for (const Row& r : rows) {
    const double E = r.E / 2.0 / (1.0 - r.nu * r.nu);
    const HertzContact c = hertz_of_force(0.5 / r.x1 + 0.5 / r.x2, 0.5 / r.y1 + 0.5 / r.y2, E, r.N);
    // the reference has ten digits
    CHECK(c.ellipse.a == Approx(r.a).epsilon(1e-8));
    CHECK(c.ellipse.b == Approx(r.b).epsilon(1e-8));
    CHECK(c.max_pressure == Approx(r.p0).epsilon(1e-8));
    CHECK(c.approach == Approx(r.approach).epsilon(1e-8));
    CHECK(c.stiffness == Approx(r.stiffness).epsilon(1e-8));
    const HertzContact back = hertz_of_approach(0.5 / r.x1 + 0.5 / r.x2, 0.5 / r.y1 + 0.5 / r.y2, E, c.approach);
    CHECK(back.normal_force == Approx(r.N).epsilon(1e-12));
    const HertzContact given = hertz_of_ellipse(c.ellipse, E, r.N);
    CHECK(given.approach == Approx(c.approach).epsilon(1e-12));
  }
}

TEST_CASE("the table of Hertz' m, n and approach is met at every angle", "[laws][wheel_rail]") {
  const double rows[][4] = {{5, 11.238062, 0.23813618, 0.24508092},
                            {10, 6.6114553, 0.3109835, 0.35331682},
                            {20, 3.8160112, 0.41214974, 0.49846021},
                            {30, 2.7306481, 0.49305979, 0.59955531},
                            {45, 1.9264621, 0.60382811, 0.70555056},
                            {60, 1.485824, 0.71709992, 0.7739655},
                            {75, 1.2020448, 0.84480832, 0.81283607},
                            {85, 1.0608712, 0.94421976, 0.82408395},
                            {90, 1, 1, 0.82548181}};
  for (const auto& row : rows) {
    const double c = std::cos(row[0] * pi / 180.0);
    const HertzShape s = hertz_shape(0.5 * (1.0 - c), 0.5 * (1.0 + c)),
                     turned = hertz_shape(0.5 * (1.0 + c), 0.5 * (1.0 - c));
    CHECK(s.m == Approx(row[1]).epsilon(1e-7));  // eight digits in the table
    CHECK(s.n == Approx(row[2]).epsilon(1e-7));
    CHECK(s.approach == Approx(row[3]).epsilon(1e-7));
    CHECK(turned.m == Approx(s.n).epsilon(1e-14));
    CHECK(turned.n == Approx(s.m).epsilon(1e-14));
  }
}

TEST_CASE("a sphere, a cylinder and a nearly circular ellipse have their closed forms", "[laws][wheel_rail]") {
  // sphere: a^3 = 3 N R / (4 E*), approach a^2 / R  (Johnson 1985, eq. 4.22)
  for (const double R : {1e-6, 1.0, 1e3}) {
    const HertzContact c = hertz_of_force(0.5 / R, 0.5 / R, 1e11, 5.0);
    const double a = std::cbrt(3.0 * 5.0 * R / 4e11);
    CHECK(c.ellipse.a == Approx(a).epsilon(1e-14));
    CHECK(c.approach == Approx(a * a / R).epsilon(1e-14));
  }
  const HertzContact near = hertz_of_force(1.0, 1.0 + 1e-10, 1e11, 5.0), round = hertz_of_force(1.0, 1.0, 1e11, 5.0);
  CHECK(near.ellipse.a == Approx(round.ellipse.a).epsilon(1e-9));
  CHECK(near.ellipse.a > near.ellipse.b);
  // cylinder: half-width^2 = 4 N' R / (pi E*), p0 = sqrt(N' E* / (pi R))
  const LineContact l = hertz_line(0.5 / 0.3, 1e11, 1e6);
  CHECK(l.half_width == Approx(std::sqrt(4e6 * 0.3 / (pi * 1e11))).epsilon(1e-14));
  CHECK(l.max_pressure == Approx(std::sqrt(1e6 * 1e11 / (pi * 0.3))).epsilon(1e-14));
  // a very slender ellipse has across it the pressure of a line contact with the force per length at its middle, 3 N /
  // (4 b)
  const HertzContact slender = hertz_of_force(1e-7, 1.0, 1e11, 1e3);
  const LineContact middle = hertz_line(1.0, 1e11, 0.75 * 1e3 / slender.ellipse.a);
  CHECK(slender.max_pressure == Approx(middle.max_pressure).epsilon(1e-4));
}

TEST_CASE("elliptic integrals meet Legendre's relation and their quadrature", "[laws][wheel_rail]") {
  for (const double ratio : {1e-6, 0.1, 0.5, 0.9, 1.0 - 1e-9}) {
    const EllipticIntegrals I = elliptic_integrals(ratio), J = elliptic_integrals(std::sqrt(1.0 - ratio * ratio));
    // E K' + E' K - K K' = pi / 2
    CHECK(I.E(ratio) * J.K + J.E(std::sqrt(1.0 - ratio * ratio)) * I.K - I.K * J.K == Approx(0.5 * pi).epsilon(1e-11));
    if (ratio < 0.05) continue;  // trapezoids converge exponentially on a period, the slower the nearer to 0
    double K = 0.0, D = 0.0;
    for (int k = 0; k < 400; ++k) {
      const double s = std::sin((k + 0.5) * pi / 800.0), w = 1.0 / std::sqrt(1.0 - (1.0 - ratio * ratio) * s * s);
      K += w;
      D += s * s * w;
    }
    CHECK(I.K == Approx(K * pi / 800.0).epsilon(1e-12));
    CHECK(I.D == Approx(D * pi / 800.0).epsilon(1e-12));
  }
}
