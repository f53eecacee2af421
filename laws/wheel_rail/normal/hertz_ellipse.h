/// @file hertz_ellipse.h  The contact of two quadratic surfaces, exactly (Hertz 1882; Johnson 1985, section 4.2).
/// Valid while the patch is small against the radii, the gap is quadratic over it, and the material stays elastic.
#pragma once

namespace epafi {

/// Semi-axes of a contact ellipse, a along x (rolling), b along y (lateral) [m].
struct Ellipse {
  double a = 0.0, b = 0.0;
};

/// One Hertzian contact: force [N], approach [m], peak pressure [Pa]; p = p0 sqrt(1 - x^2/a^2 - y^2/b^2).
struct HertzContact {
  Ellipse ellipse;
  double normal_force = 0.0;
  double approach = 0.0;
  double max_pressure = 0.0;
  double stiffness = 0.0;  ///< dN / d(approach) = 3 N / (2 approach) [N/m]
};

/// Gap h = A x^2 + B y^2, A and B [1/m] > 0; E* [Pa]. Of force N [N] >= 0.
HertzContact hertz_of_force(double A, double B, double effective_modulus, double normal_force);
/// The Hertzian contact at an approach [m] >= 0.
HertzContact hertz_of_approach(double A, double B, double effective_modulus, double approach);
/// The Hertzian contact that has this ellipse under force N; A and B follow.
HertzContact hertz_of_ellipse(Ellipse ellipse, double effective_modulus, double normal_force);

/// Relative axes of the ellipse of A and B: a and b for 3 N / (4 E* (A + B)) = 1 (the m and n of Hertz' table),
/// and the approach for N = E* = A + B = 1.
struct HertzShape {
  double m, n, approach;
};
HertzShape hertz_shape(double A, double B);

/// Line contact of gap A x^2 under the force per length N' [N/m]: half-width [m] and peak pressure [Pa] (Johnson 1985,
/// eq. 4.43). The approach of two infinite bodies is unbounded in two dimensions.
struct LineContact {
  double half_width, max_pressure;
};
LineContact hertz_line(double A, double effective_modulus, double force_per_length);

}  // namespace epafi
