/// @file equal_volume.h  Radius of the sphere of a given volume: the contact radius of shapes that are not spheres.
#pragma once
#include <cmath>
#include <numbers>

namespace epafi {

/// Cube root by Newton's method after scaling to [1/8, 1): + - * / only, so that no libm decides a bit of a run.
/// x >= 0 and finite; error below 2 ulp.
inline double cube_root(double x) {
  if (!(x > 0.0)) return 0.0;
  int exponent = 0;
  double fraction = std::frexp(x, &exponent);  // exact
  while (exponent % 3 != 0) {
    fraction *= 0.5;
    ++exponent;
  }
  double y = 0.75;
  for (int k = 0; k < 8; ++k)
    y -= (y * y * y - fraction) / (3.0 * y * y);  // quadratic: 8 steps from within a factor 1.6
  return std::ldexp(y, exponent / 3);
}

/// R of V = 4/3 pi R^3 [m]
inline double equal_volume_radius(double volume) { return cube_root(0.75 * volume / std::numbers::pi); }

}  // namespace epafi
