#include "laws/wheel_rail/normal/strip_influence.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/railway/elliptic_integrals.h"

namespace epafi {
namespace {

using std::numbers::pi;
constexpr double far = 4.0;  // beyond: series, with error 5e-8 here
constexpr std::size_t cells = 8000;
constexpr std::size_t near = 100;  // cells beyond which, at t = 0.05, linear interpolation is 6e-7 off

double slope(double t) { return 2.0 * elliptic_integrals(t / std::sqrt(1.0 + t * t)).D / std::sqrt(1.0 + t * t); }
double bend(double t) {
  const double ratio = t / std::sqrt(1.0 + t * t);
  return 2.0 * ratio * elliptic_integrals(ratio).K;
}

/// Tables at equal steps of t; in the first cells without the singular part: G + 2 t log t - 2 t, S + 2 t log t.
struct Table {
  std::vector<StripInfluence> at, low;
  double step = far / cells, beyond = 0.0;
  Table() : at(cells + 2, StripInfluence{0.0, 0.0}), low(1, StripInfluence{0.0, 0.0}) {
    const double g = 0.57735026918962576;  // Gauss with two points
    double smooth_G = 0.0;
    for (std::size_t k = 1; k <= cells; ++k) {
      const double m = (static_cast<double>(k) - 0.5) * step, r = 0.5 * step;
      const auto smooth = [](double t) { return slope(t) + 2.0 * std::log(t); };
      smooth_G += r * (smooth(m - g * r) + smooth(m + g * r));
      const double t = static_cast<double>(k) * step, singular = 2.0 * t * std::log(t), S = bend(t);
      at[k] = {smooth_G - singular + 2.0 * t, S};
      if (k <= near) low.push_back({smooth_G, S + singular});
    }
    at[cells + 1] = at[cells];
    beyond = at[cells].displacement - series(far);
  }
  /// Integral of F(t) = (1/t) (pi/2 - pi/16 t^-2 + 3 pi/128 t^-4 - 25 pi/2048 t^-6 ...).
  static double series(double t) {
    const double q = 1.0 / (t * t);
    return 0.5 * pi * std::log(t) + pi * q * (1.0 / 32.0 - q * (3.0 / 512.0 - q * (25.0 / 12288.0)));
  }
  /// 2 k' K with K = pi/2 (1 + m/4 + 9 m^2/64 + 25 m^3/256 ...), m = 1 / (1 + t^2).
  static double far_bend(double t) {
    const double m = 1.0 / (1.0 + t * t);
    return pi * t * std::sqrt(m) * (1.0 + m * (1.0 / 4.0 + m * (9.0 / 64.0 + m * (25.0 / 256.0))));
  }
};

}  // namespace

StripInfluence strip_influence(double t) {
  static const Table table;
  const double s = std::abs(t), sign = t < 0.0 ? -1.0 : 1.0;
  if (s >= far) return {sign * (table.beyond + Table::series(s)), sign * Table::far_bend(s)};
  const double x = s * (cells / far);
  const auto k = static_cast<std::size_t>(x);
  const double f = x - static_cast<double>(k);
  const auto chord = [&](const std::vector<StripInfluence>& v) {
    return StripInfluence{(1.0 - f) * v[k].displacement + f * v[k + 1].displacement,
                          (1.0 - f) * v[k].bend + f * v[k + 1].bend};
  };
  StripInfluence out = chord(k < near ? table.low : table.at);
  if (k < near && s > 0.0) {
    const double singular = 2.0 * s * std::log(s);
    out.displacement -= singular - 2.0 * s;
    out.bend -= singular;
  }
  return {sign * out.displacement, sign * out.bend};
}

double misfit_of(std::span<const PressedStrip> strips, double approach, double modulus) {
  constexpr std::size_t looked_at = 16;  // sample points: enough to find a slope of the residual over the patch
  const std::size_t stride = std::max<std::size_t>(1, strips.size() / looked_at);
  double weight = 0.0, sum = 0.0;
  for (std::size_t k = stride / 2; k < strips.size(); k += stride) {
    double u = 0.0;
    for (const PressedStrip& s : strips) {
      const double d = strips[k].y - s.y, w = 0.5 * s.width;
      u += s.p * s.a * (strip_influence((d + w) / s.a).displacement - strip_influence((d - w) / s.a).displacement);
    }
    const double open = u / (pi * modulus) + strips[k].gap - approach;
    const double share = strips[k].p * strips[k].width;
    weight += share;
    sum += share * open * open;
  }
  return weight > 0.0 ? std::sqrt(sum / weight) / approach : 0.0;
}

}  // namespace epafi
