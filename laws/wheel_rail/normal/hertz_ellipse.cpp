#include "laws/wheel_rail/normal/hertz_ellipse.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/railway/elliptic_integrals.h"
#include "engine/units/error.h"

namespace epafi {
namespace {

using std::numbers::pi;

/// Axis ratio k = smaller / larger of the contact ellipse: A/B = k^2 D / B_e  (Johnson 1985, eq. 4.26), A <= B.
/// k lies between A/B (slender: the logarithm of D only makes it larger) and 1; bisection safeguards a secant in log k.
double axis_ratio(double A, double B) {
  if (A >= B) return 1.0;
  const double target = std::log(A / B);
  const auto f = [&](double log_k) {
    const double k = std::exp(log_k);
    const EllipticIntegrals I = elliptic_integrals(k);
    return 2.0 * log_k + std::log(I.D / I.B) - target;
  };
  double low = target, high = 0.0, f_low = f(low), f_high = -target;
  double x = 0.6 * target;  // k = (A/B)^0.6 fits within a few per cent (Hamrock and Brewe 1983: 0.636)
  for (int n = 0; n < 100 && high - low > 1e-16; ++n) {
    const double fx = f(x);
    if (fx == 0.0) break;
    (fx > 0.0 ? high : low) = x;
    (fx > 0.0 ? f_high : f_low) = fx;
    const double slope = (f(x + 1e-6) - fx) / 1e-6;  // d/d log k is near 2: Newton, four rounds
    double next = x - fx / slope;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - x) < 1e-15 * std::max(1.0, std::abs(x))) return std::exp(next);
    x = next;
  }
  return std::exp(x);
}

struct Shape {
  double ratio;  ///< smaller / larger axis
  EllipticIntegrals integrals;
  double A;  ///< along the larger axis
  bool x_is_larger;
};

Shape shape_of(double A, double B) {
  EPAFI_REQUIRE(A > 0.0 && B > 0.0, "curvatures of a closed contact");
  const double ratio = axis_ratio(std::min(A, B), std::max(A, B));
  return {ratio, elliptic_integrals(ratio), std::min(A, B), A <= B};
}

/// A = (p0 b / (E* a^2)) D and p0 = 3 N / (2 pi a b), a the larger axis: a^3 = 3 N D / (2 pi E* A).
HertzContact contact_of(const Shape& shape, double modulus, double force) {
  const double large = std::cbrt(1.5 * force * shape.integrals.D / (pi * modulus * shape.A));
  const double small = shape.ratio * large;
  HertzContact c;
  c.ellipse = shape.x_is_larger ? Ellipse{large, small} : Ellipse{small, large};
  c.normal_force = force;
  c.max_pressure = force > 0.0 ? 1.5 * force / (pi * large * small) : 0.0;
  c.approach = c.max_pressure * small * shape.integrals.K / modulus;
  c.stiffness = force > 0.0 ? 1.5 * force / c.approach : 0.0;
  return c;
}

}  // namespace

HertzContact hertz_of_force(double A, double B, double effective_modulus, double normal_force) {
  return contact_of(shape_of(A, B), effective_modulus, normal_force);
}

HertzContact hertz_of_approach(double A, double B, double effective_modulus, double approach) {
  const Shape shape = shape_of(A, B);
  // approach grows as N^(2/3)
  const double unit = contact_of(shape, effective_modulus, 1.0).approach;
  const double ratio = std::max(0.0, approach) / unit;
  return contact_of(shape, effective_modulus, ratio * std::sqrt(ratio));
}

HertzContact hertz_of_ellipse(Ellipse e, double effective_modulus, double normal_force) {
  EPAFI_REQUIRE(e.a > 0.0 && e.b > 0.0, "axes of an ellipse");
  const double large = std::max(e.a, e.b), small = std::min(e.a, e.b);
  HertzContact c;
  c.ellipse = e;
  c.normal_force = normal_force;
  c.max_pressure = 1.5 * normal_force / (pi * large * small);
  c.approach = c.max_pressure * small * elliptic_integrals(small / large).K / effective_modulus;
  c.stiffness = normal_force > 0.0 ? 1.5 * normal_force / c.approach : 0.0;
  return c;
}

HertzShape hertz_shape(double A, double B) {
  const HertzContact c = hertz_of_force(A / (A + B), B / (A + B), 1.0, 1.0);
  const double unit = std::cbrt(0.75);
  return {c.ellipse.a / unit, c.ellipse.b / unit, c.approach};
}

LineContact hertz_line(double A, double effective_modulus, double force_per_length) {
  const double half_width = std::sqrt(2.0 * force_per_length / (pi * effective_modulus * A));  // R = 1 / (2 A)
  return {half_width, 2.0 * force_per_length / (pi * half_width)};
}

}  // namespace epafi
