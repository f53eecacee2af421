#include "laws/wheel_rail/normal/strip_influence.h"

#include <cmath>
#include <vector>

#include "laws/wheel_rail/elliptic_integrals.h"

namespace epafi {
namespace {

constexpr int cells = 4000;
constexpr double far = 4.0;  // beyond: the series below, 5e-8 off here

double slope(double t) { return 2.0 * elliptic_integrals(t / std::sqrt(1.0 + t * t)).D / std::sqrt(1.0 + t * t); }

/// H(t) = G(t) + 2 t log t - 2 t is smooth at 0 (F has the singularity -2 log t); kept at equal steps of t. A second
/// logarithm for steps that grow took a sixth of the time of a patch.
struct Table {
  std::vector<double> H;
  double step = far / cells, beyond = 0.0;
  Table() : H(cells + 2, 0.0) {
    const double g = 0.57735026918962576;  // Gauss with two points
    for (std::size_t k = 0; k < cells; ++k) {
      const double m = (static_cast<double>(k) + 0.5) * step, r = 0.5 * step;
      const auto smooth = [](double t) { return slope(t) + 2.0 * std::log(t); };
      H[k + 1] = H[k] + r * (smooth(m - g * r) + smooth(m + g * r));
    }
    H[cells + 1] = H[cells];
    beyond = H[cells] - 2.0 * far * (std::log(far) - 1.0) - series(far);
  }
  /// Integral of F(t) = (1/t) (pi/2 - pi/16 t^-2 + 3 pi/128 t^-4 - 25 pi/2048 t^-6 ...).
  static double series(double t) {
    constexpr double pi = 3.14159265358979323846;
    const double q = 1.0 / (t * t);
    return 0.5 * pi * std::log(t) + pi * q * (1.0 / 32.0 - q * (3.0 / 512.0 - q * (25.0 / 12288.0)));
  }
};

}  // namespace

double strip_integral(double t) {
  static const Table table;
  const double s = std::abs(t);
  if (s == 0.0) return 0.0;
  double G;
  if (s >= far) {
    G = table.beyond + Table::series(s);
  } else {
    const double x = s / table.step;
    const auto k = static_cast<std::size_t>(x);
    const double f = x - static_cast<double>(k);
    G = (1.0 - f) * table.H[k] + f * table.H[k + 1] - 2.0 * s * (std::log(s) - 1.0);
  }
  return t < 0.0 ? -G : G;
}

}  // namespace epafi
