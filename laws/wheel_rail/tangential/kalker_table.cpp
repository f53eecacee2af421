#include "laws/wheel_rail/tangential/kalker_table.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace epafi {
namespace {

constexpr std::size_t places = 19;                         // a/b = 0.1 ... 1.0, then b/a = 0.9 ... 0.1
using Column = std::array<std::array<double, 3>, places>;  // by axis ratio; Poisson's ratio 0, 1/4, 1/2

constexpr Column table_c11{{{2.51, 3.31, 4.85},
                            {2.59, 3.37, 4.81},
                            {2.68, 3.44, 4.8},
                            {2.78, 3.53, 4.82},
                            {2.88, 3.62, 4.83},
                            {2.98, 3.72, 4.91},
                            {3.09, 3.81, 4.97},
                            {3.19, 3.91, 5.05},
                            {3.29, 4.01, 5.12},
                            {3.4, 4.12, 5.2},
                            {3.51, 4.22, 5.3},
                            {3.65, 4.36, 5.42},
                            {3.82, 4.54, 5.58},
                            {4.06, 4.78, 5.8},
                            {4.37, 5.1, 6.11},
                            {4.84, 5.57, 6.57},
                            {5.57, 6.34, 7.34},
                            {6.96, 7.78, 8.82},
                            {10.7, 11.7, 12.9}}};
constexpr Column table_c22{{{2.51, 2.52, 2.53},
                            {2.59, 2.63, 2.66},
                            {2.68, 2.75, 2.81},
                            {2.78, 2.88, 2.98},
                            {2.88, 3.01, 3.14},
                            {2.98, 3.14, 3.31},
                            {3.09, 3.28, 3.48},
                            {3.19, 3.41, 3.65},
                            {3.29, 3.54, 3.82},
                            {3.4, 3.67, 3.98},
                            {3.51, 3.81, 4.16},
                            {3.65, 3.99, 4.39},
                            {3.82, 4.21, 4.67},
                            {4.06, 4.5, 5.04},
                            {4.37, 4.9, 5.56},
                            {4.84, 5.48, 6.31},
                            {5.57, 6.4, 7.51},
                            {6.96, 8.14, 9.79},
                            {10.7, 12.8, 16.0}}};
constexpr Column table_c23{{{0.334, 0.473, 0.731},
                            {0.483, 0.603, 0.809},
                            {0.607, 0.715, 0.889},
                            {0.72, 0.823, 0.977},
                            {0.827, 0.929, 1.07},
                            {0.93, 1.03, 1.18},
                            {1.03, 1.14, 1.29},
                            {1.13, 1.25, 1.4},
                            {1.23, 1.36, 1.51},
                            {1.33, 1.47, 1.63},
                            {1.44, 1.59, 1.77},
                            {1.58, 1.75, 1.94},
                            {1.76, 1.95, 2.18},
                            {2.01, 2.23, 2.5},
                            {2.35, 2.62, 2.96},
                            {2.88, 3.24, 3.7},
                            {3.79, 4.32, 5.01},
                            {5.72, 6.63, 7.89},
                            {12.2, 14.6, 18.0}}};
constexpr Column table_c33{{{6.42, 8.28, 11.7},
                            {3.46, 4.27, 5.66},
                            {2.49, 2.96, 3.72},
                            {2.02, 2.32, 2.77},
                            {1.74, 1.93, 2.22},
                            {1.56, 1.68, 1.86},
                            {1.43, 1.5, 1.6},
                            {1.34, 1.37, 1.42},
                            {1.27, 1.27, 1.27},
                            {1.21, 1.19, 1.16},
                            {1.16, 1.11, 1.06},
                            {1.1, 1.04, 0.954},
                            {1.05, 0.965, 0.852},
                            {1.01, 0.892, 0.751},
                            {0.958, 0.819, 0.65},
                            {0.912, 0.747, 0.549},
                            {0.868, 0.674, 0.446},
                            {0.828, 0.601, 0.341},
                            {0.795, 0.526, 0.228}}};

/// 1/c at one axis ratio, interpolated through nu = 0, 1/4, 1/2 (Lagrange).
double inverse_at(const std::array<double, 3>& row, double nu) {
  const double l0 = 8.0 * (nu - 0.25) * (nu - 0.5), l1 = -16.0 * nu * (nu - 0.5), l2 = 8.0 * nu * (nu - 0.25);
  return l0 / row[0] + l1 / row[1] + l2 / row[2];
}

/// Catmull-Rom through the axis ratios: smooth across a = b, because a/b and 2 - b/a have the same slope there.
double interpolate(const Column& table, double place, double nu) {
  const int cell = std::clamp(static_cast<int>(place), 0, static_cast<int>(places) - 2);
  const double t = place - cell;
  const auto value = [&](int k) {
    const int last = static_cast<int>(places) - 1;
    if (k < 0) return 2.0 * inverse_at(table[0], nu) - inverse_at(table[1], nu);
    if (k > last) return 2.0 * inverse_at(table[places - 1], nu) - inverse_at(table[places - 2], nu);
    return inverse_at(table[static_cast<std::size_t>(k)], nu);
  };
  const double p0 = value(cell - 1), p1 = value(cell), p2 = value(cell + 1), p3 = value(cell + 2);
  const double slope1 = 0.5 * (p2 - p0), slope2 = 0.5 * (p3 - p1);
  const double u = 1.0 - t;
  return 1.0 / (u * u * ((1.0 + 2.0 * t) * p1 + t * slope1) + t * t * ((1.0 + 2.0 * u) * p2 - u * slope2));
}

}  // namespace

KalkerCoefficients kalker_coefficients(double axis_ratio, double poissons_ratio) {
  const double place = axis_ratio <= 1.0 ? 10.0 * axis_ratio - 1.0 : 19.0 - 10.0 / axis_ratio;
  const double inside = std::clamp(place, 0.0, static_cast<double>(places - 1));
  const double nu = std::clamp(poissons_ratio, 0.0, 0.5);
  return {interpolate(table_c11, inside, nu), interpolate(table_c22, inside, nu), interpolate(table_c23, inside, nu),
          interpolate(table_c33, inside, nu), axis_ratio < 0.1 - 1e-12 || axis_ratio > 10.0 + 1e-9};
}

}  // namespace epafi
