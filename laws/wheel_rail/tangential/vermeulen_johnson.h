/// @file vermeulen_johnson.h  Rolling with an elliptic stick zone that touches the leading edge (Vermeulen and Johnson
/// 1964): F = mu N (1 - (1 - tau)^3) for tau <= 1. Closed form from elliptic integrals; about 15 % from Kalker's exact
/// stiffness; knows no spin: flagged where there is any.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/railway/elliptic_integrals.h"
#include "laws/wheel_rail/rolling.h"

namespace epafi {

/// Linear slopes: F_x = -G a b c_x xi, F_y = -G a b c_y eta; for a circle c_x = 16 / (4 - 3 nu), c_y = 16 / (4 - nu)
/// (Johnson 1958).
struct VermeulenJohnsonSlopes {
  double longitudinal, lateral;
};
inline VermeulenJohnsonSlopes vermeulen_johnson_slopes(double axis_ratio, double nu) {
  using std::numbers::pi;
  const double ratio = axis_ratio <= 1.0 ? axis_ratio : 1.0 / axis_ratio;
  const EllipticIntegrals I = elliptic_integrals(ratio);
  const double e2 = (1.0 - ratio) * (1.0 + ratio);
  // C = int sin^2 cos^2 / (1 - e^2 sin^2)^(3/2) = (D - B)/e^2; near the circle its series pi/16 (1 + 3/4 e^2)
  const double C = e2 > 1e-5 ? (I.D - I.B) / e2 : pi / 16.0 * (1.0 + 0.75 * e2);
  if (axis_ratio <= 1.0) return {pi / (I.B - nu * (I.D - C)), pi / (I.B - nu * ratio * ratio * C)};
  return {pi / (ratio * (I.D - nu * (I.D - C))), pi / (ratio * (I.D - nu * C))};
}

inline PatchForce vermeulen_johnson(const RollingCase& c) {
  const VermeulenJohnsonSlopes k = vermeulen_johnson_slopes(c.ellipse.a / c.ellipse.b, c.elastic.poissons_ratio);
  const double Gab = c.elastic.shear_modulus * c.ellipse.a * c.ellipse.b, bound = c.bound();
  const double fx = -Gab * k.longitudinal * c.creepage.longitudinal, fy = -Gab * k.lateral * c.creepage.lateral;
  const double size = std::hypot(fx, fy);
  if (!(size > 0.0)) return {};
  const double rest = std::max(0.0, 1.0 - size / (3.0 * bound));
  const double factor = bound > 0.0 ? bound * (1.0 - rest * rest * rest) / size : 0.0;
  return {fx * factor, fy * factor, 0.0};
}

}  // namespace epafi
