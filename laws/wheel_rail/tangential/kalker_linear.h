/// @file kalker_linear.h  Kalker's linear theory (1967): no slip anywhere. Exact for vanishing creepage, without bound
/// beyond.
#pragma once
#include <cmath>

#include "laws/wheel_rail/rolling.h"
#include "laws/wheel_rail/tangential/kalker_table.h"

namespace epafi {

inline PatchForce kalker_linear(const RollingCase& c, const KalkerCoefficients& k) {
  const double ab = c.ellipse.a * c.ellipse.b, root = std::sqrt(ab), Gab = c.elastic.shear_modulus * ab;
  const Creepage& s = c.creepage;
  return {-Gab * k.c11 * s.longitudinal, -Gab * (k.c22 * s.lateral + root * k.c23 * s.spin),
          Gab * (root * k.c23 * s.lateral - ab * k.c33 * s.spin)};
}
inline PatchForce kalker_linear(const RollingCase& c) {
  return kalker_linear(c, kalker_coefficients(c.ellipse.a / c.ellipse.b, c.elastic.poissons_ratio));
}

}  // namespace epafi
