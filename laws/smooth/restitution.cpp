#include "laws/smooth/restitution.h"

#include <algorithm>
#include <cmath>

namespace epafi {

namespace {

/// Root of a function that is negative at low and not negative at high. Fixed halvings, so that the last bits of a
/// machine's exp and log decide nothing.
template <class F>
double bisect(double low, double high, const F& f) {
  for (int k = 0; k < 46; ++k) {  // 1e-14 of the bracket
    const double middle = 0.5 * (low + high);
    (f(middle) < 0.0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double restitution_of(double z) {
  const double square = (1.0 - z) * (1.0 + z);
  if (square == 0.0) return std::exp(-2.0);
  const double root = std::sqrt(std::abs(square));
  const double angle = square > 0.0 ? std::atan2(root, z) : std::log(z + root);  // acos or acosh
  return std::exp(-2.0 * z * angle / root);
}

double damping_ratio_for(double restitution) {
  if (restitution >= 1.0) return 0.0;
  const double e = std::max(restitution, minimum_restitution);
  return bisect(0.0, 8.0, [e](double z) { return e - restitution_of(z); });  // e(8) = 0.004 < minimum_restitution
}

double hunt_crossley_factor(double restitution) {
  if (restitution >= 1.0) return 0.0;
  const double e = std::max(restitution, minimum_restitution);
  const double small = 1.5 * (1.0 - e) * (1.0 + e) / (1.0 + e * e * e);  // first term of the series about X = 0
  if (1.0 - e < 1e-6) return small;
  // log((1 + X)/(1 - e X)) - X (1 + e): negative from 0 to the root, infinite at 1/e
  return bisect(0.25 * small, 1.0 / e, [e](double x) { return std::log1p(x) - std::log1p(-e * x) - x * (1.0 + e); });
}

double hunt_crossley_restitution(double factor) {
  if (factor < 1e-6) return 1.0 - 2.0 / 3.0 * std::max(factor, 0.0);  // first term of the series
  const double x = factor;
  // log((1 + X)/(1 - e X)) - X (1 + e): negative at e = 0, rising to infinity at 1/X
  return bisect(0.0, std::min(1.0, 1.0 / x),
                [x](double e) { return std::log1p(x) - std::log1p(-e * x) - x * (1.0 + e); });
}

}  // namespace epafi
