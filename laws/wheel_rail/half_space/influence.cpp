#include "laws/wheel_rail/half_space/influence.h"

#include <cmath>
#include <numbers>

namespace epafi {
namespace {

/// asinh(n / |d|) d, and its limit 0: one of the two logarithms of the integral of 1/r.
double log_term(double n, double d) { return d == 0.0 ? 0.0 : d * std::asinh(n / std::abs(d)); }

/// Antiderivatives in x and y: of y^2/r^3, x^2/r^3, x y / r^3.
struct Corner {
  double yy, xx, xy;
};
Corner corner(double x, double y) { return {log_term(y, x), log_term(x, y), -std::sqrt(x * x + y * y)}; }

}  // namespace

Influence influence(double x, double y, double hx, double hy, const ElasticPair& pair) {
  const Corner a = corner(x + hx, y + hy), b = corner(x - hx, y + hy), c = corner(x + hx, y - hy),
               d = corner(x - hx, y - hy);
  const double xx = a.xx - b.xx - c.xx + d.xx, yy = a.yy - b.yy - c.yy + d.yy, xy = a.xy - b.xy - c.xy + d.xy;
  // u_x = 1/(pi G) ((1 - nu)/r + nu x^2/r^3) q_x + ...; u_z = (1 - nu)/(pi G r) p, and 1/r = x^2/r^3 + y^2/r^3
  const double nu = pair.poissons_ratio, s = 1.0 / (std::numbers::pi * pair.shear_modulus);
  return {s * (1.0 - nu) * (xx + yy), s * (xx + (1.0 - nu) * yy), s * nu * xy, s * ((1.0 - nu) * xx + yy)};
}

}  // namespace epafi
