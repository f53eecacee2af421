#include "engine/rotation.h"

#include <cmath>

#include "tests/support/catch.h"

using namespace epafi;

TEST_CASE("sin_cos agrees with libm to 4 ulp over many turns", "[engine][rotation]") {
  for (int k = -20000; k <= 20000; ++k) {
    const double x = 0.0371 * k;
    CHECK(std::abs(sin_cos(x).sin - std::sin(x)) < 4.5e-16);  // 4 ulp of values below 1
    CHECK(std::abs(sin_cos(x).cos - std::cos(x)) < 4.5e-16);
  }
}

TEST_CASE("a symmetric top precesses with the exact space rate (case A19)", "[engine][rotation][A19]") {
  // I_perp = 1, I_axis = 2, w_axis = 5, w_perp = 1: the axis turns about L at |L|/I_perp = sqrt(101) = 10.049876 rad/s
  Quat q(1, 0, 0, 0);
  Vec3 w(1, 0, 5);
  const Vec3 inertia(1, 1, 2), l0 = inertia.cwiseProduct(w);
  const double dt = 1e-3;
  const int steps = 1000000;
  for (int k = 0; k < steps; ++k) rotate_freely(q, w, inertia.cwiseInverse(), dt);
  // body axis e3 turned about L by the angle |L| t
  const Vec3 expected = Eigen::AngleAxisd(std::fmod(l0.norm() * dt * steps, 2 * M_PI), l0.normalized()) * Vec3::UnitZ();
  const Vec3 axis = q * Vec3::UnitZ();
  CHECK((axis - expected).norm() < 1e-3 * std::sqrt(1.0 - std::pow(expected.dot(l0.normalized()), 2)));
  CHECK((axis - expected).norm() < 1e-6);  // the splitting is exact for symmetric tops; rounding over 1e6 steps remains
}

TEST_CASE("the intermediate axis flips with the exact period and keeps L and energy (case A18)", "[engine][rotation][A18][slow]") {
  // full polhode period 39.105734 s for I = (1,2,3), w0 = (.01, 1, .01)
  Quat q(1, 0, 0, 0);
  const Vec3 inertia(1, 2, 3), w0(0.01, 1, 0.01), l0 = inertia.cwiseProduct(w0);
  Vec3 w = w0;
  const double dt = 1e-3, energy0 = 0.5 * w.dot(inertia.cwiseProduct(w));
  double last = 0, first_crossing = 0, worst_energy = 0;
  int crossings = 0;
  double before = w0.y();
  for (long k = 1; crossings < 201; ++k) {
    rotate_freely(q, w, inertia.cwiseInverse(), dt);
    const Vec3 body = q.conjugate() * w;
    worst_energy = std::max(worst_energy, std::abs(0.5 * body.dot(inertia.cwiseProduct(body)) / energy0 - 1));
    if (before > 0 && body.y() <= 0) {
      last = (static_cast<double>(k) - body.y() / (body.y() - before)) * dt;
      if (crossings == 0) first_crossing = last;
      crossings += 2;
    }
    before = body.y();
  }
  const double period = (last - first_crossing) / (static_cast<double>(crossings - 2) / 2);
  const Vec3 l = q * inertia.cwiseProduct(q.conjugate() * w);
  CHECK(period == Approx(39.105734).epsilon(1e-3));
  CHECK(l.norm() == Approx(l0.norm()).epsilon(1e-12));
  CHECK((l.normalized() - l0.normalized()).norm() < 1e-6);
  CHECK(worst_energy < 1e-6);
}

TEST_CASE("a spinning needle keeps energy and momentum (case B12)", "[engine][rotation][B12]") {
  // rod L = 1, r = 5 mm: I_perp/I_axis = 6667; spin 1000 rad/s about the axis and 1 rad/s across, 1e6 steps of 1 ms
  const double r = 5e-3, length = 1.0, axial = 0.5 * r * r, across = length * length / 12 + r * r / 4;
  Quat q(1, 0, 0, 0);
  const Vec3 inertia(across, across, axial);
  Vec3 w(1, 0, 1000);
  const Vec3 l0 = inertia.cwiseProduct(w);
  const double energy0 = 0.5 * w.dot(l0);
  for (int k = 0; k < 1000000; ++k) rotate_freely(q, w, inertia.cwiseInverse(), 1e-3);
  const Vec3 body = q.conjugate() * w, l = q * inertia.cwiseProduct(body);
  CHECK(0.5 * body.dot(inertia.cwiseProduct(body)) == Approx(energy0).epsilon(1e-3));
  CHECK((l - l0).norm() < 1e-10 * l0.norm());
}
