/// @file kalker_table.h  Kalker's creepage coefficients c11, c22, c23, c33 (Kalker 1967; 1990, table E.3).
#pragma once

namespace epafi {

/// F_x = -G a b c11 xi;  F_y = -G a b (c22 eta + sqrt(a b) c23 phi);  M_z = G a b (sqrt(a b) c23 eta - a b c33 phi).
struct KalkerCoefficients {
  double c11, c22, c23, c33;
  bool extrapolated;  ///< a/b outside [0.1, 10]: the values of the table's end
};

/// Interpolated: 1/c is quadratic through the three columns of Poisson's ratio (for a circle 1/c11 is linear in it),
/// and cubic in the place in the table, whose steps are 0.1 in a/b below 1 and in b/a above. Within a digit of the
/// table. a/b > 0, Poisson's ratio in [0, 0.5].
KalkerCoefficients kalker_coefficients(double axis_ratio, double poissons_ratio);

}  // namespace epafi
