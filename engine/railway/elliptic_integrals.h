/// @file elliptic_integrals.h  Complete elliptic integrals by the arithmetic-geometric mean (Gauss 1799; Abramowitz and
/// Stegun 17.6). Quadratic convergence: eight rounds reach the last digit for axis ratios down to 1e-12.
#pragma once
#include <cmath>

namespace epafi {

/// Complete elliptic integrals of modulus e, e^2 = 1 - ratio^2: K, D = (K - E)/e^2, B = K - D; free of cancellation at
/// e = 0, where D = B = pi/4.
struct EllipticIntegrals {
  double K, D, B;
  double E(double ratio) const { return B + ratio * ratio * D; }
};

/// `ratio` = smaller axis / larger axis, in (0, 1].
inline EllipticIntegrals elliptic_integrals(double ratio) {
  // K - E = K sum 2^(n-1) c_n^2 with c_0 = e; every c_n^2 is divided by e^2 from the start (c_1 = e^2 / (4 a_1))
  const double e2 = (1.0 - ratio) * (1.0 + ratio);
  double a = 1.0, b = ratio, sum = 0.5, weight = 1.0, over_e2 = 1.0;  // over_e2 = c_n^2 / e^2
  for (int n = 0; n < 40 && a - b > 1e-17 * a; ++n) {
    const double next = 0.5 * (a + b);
    over_e2 = over_e2 * over_e2 * e2 / (16.0 * next * next);
    b = std::sqrt(a * b);
    a = next;
    sum += weight * over_e2;
    weight *= 2.0;
  }
  const double K = 1.57079632679489661923 / a;
  return {K, K * sum, K * (1.0 - sum)};
}

}  // namespace epafi
