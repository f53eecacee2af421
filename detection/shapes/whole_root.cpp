#include "detection/shapes/whole_root.h"

namespace epafi {

double whole_root(double x, int k) {
  using Two = LanesOf<2>::Real;
  constexpr double tiny = 0x1p-900;
  if (k == 2) return std::sqrt(x);
  if (k == 4) return std::sqrt(std::sqrt(x));
  if (!(x > 0.0)) return 0.0;
  if (x >= tiny) return whole_roots(Two{x, x}, k)[0];
  const int up = 320 / k;  // the root of a number that 2^(-up k) makes tiny
  return whole_roots(Two{x * std::ldexp(1.0, up * k), 1.0}, k)[0] * std::ldexp(1.0, -up);
}

}  // namespace epafi
