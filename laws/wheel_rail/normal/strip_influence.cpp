#include "laws/wheel_rail/normal/strip_influence.h"

#include <cmath>
#include <vector>

#include "laws/wheel_rail/elliptic_integrals.h"

namespace epafi {
namespace {

constexpr int cells = 2000;
constexpr double longest = 200.0;  // beyond: F = pi/(2 t) to 1e-5 of what little is left

double slope(double t) { return 2.0 * elliptic_integrals(t / std::sqrt(1.0 + t * t)).D / std::sqrt(1.0 + t * t); }

/// H(t) = G(t) + 2 t log t - 2 t is smooth at 0 (F has the singularity -2 log t); kept at equal steps of log(1 + t).
struct Table {
  std::vector<double> H;
  double step = std::log1p(longest) / cells, end = 0.0;
  Table() : H(cells + 1, 0.0) {
    const double g = 0.57735026918962576, half = 0.5;  // Gauss with two points
    for (int k = 0; k < cells; ++k) {
      const double a = std::expm1(k * step), b = std::expm1((k + 1) * step), m = half * (a + b), r = half * (b - a);
      const auto smooth = [](double t) { return slope(t) + 2.0 * std::log(t); };
      H[static_cast<std::size_t>(k) + 1] = H[static_cast<std::size_t>(k)] + r * (smooth(m - g * r) + smooth(m + g * r));
    }
    end = H.back() - 2.0 * longest * (std::log(longest) - 1.0);
  }
};

}  // namespace

double strip_integral(double t) {
  static const Table table;
  const double s = std::abs(t);
  double G;
  if (s >= longest) {
    G = table.end + 1.57079632679489661923 * std::log(s / longest);
  } else if (s == 0.0) {
    return 0.0;
  } else {
    const double x = std::log1p(s) / table.step;
    const auto k = static_cast<std::size_t>(x);
    const double f = x - static_cast<double>(k);
    G = (1.0 - f) * table.H[k] + f * table.H[k + 1 < table.H.size() ? k + 1 : k] - 2.0 * s * (std::log(s) - 1.0);
  }
  return t < 0.0 ? -G : G;
}

}  // namespace epafi
