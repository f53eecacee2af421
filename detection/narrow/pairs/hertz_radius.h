/// @file hertz_radius.h  The effective radius R* of an elliptic contact in F = 4/3 E* sqrt(R*) depth^1.5 (Hertz 1882;
/// Johnson 1985, section 4.2). The gap near the contact is A x^2 + B y^2 with A <= B, from the relative curvatures of
/// the two surfaces; the axis ratio k of the ellipse follows from A/B = k^2 D(k)/B(k), and R* = pi^2 D/(4 K^3 A). For
/// equal curvatures this is 1/(1/R_a + 1/R_b).
#pragma once
#include "detection/narrow/gjk/common_normal.h"

namespace epafi {

/// A <= B [1/m], A > 0. R* [m].
double hertz_radius(double A, double B);

/// Principal curvatures of a surface across a unit normal n as a matrix in the plane across n [1/m]; `swept`: of a
/// sphere swept over the core [m].
struct CurvatureAcross {
  double uu = 0.0, uv = 0.0, vv = 0.0;

  CurvatureAcross() = default;
  CurvatureAcross(const Mat3& derivative, const Vec3& u, const Vec3& v, double swept);
};

/// R* of the sum of two curvatures; infinite where both are flat along one direction.
double hertz_radius(const CurvatureAcross& a, const CurvatureAcross& b);

/// R* of two round bodies on their common normal n, a unit vector in A's axes.
double hertz_radius(const RoundRef& a, double swept_a, const RoundRef& b, double swept_b, const Mat3& rotation,
                    const Vec3& n);

/// R* of a round body on a plane; d: unit, in its own axes, towards the plane.
double hertz_radius_on_plane(const RoundRef& a, double swept, const Vec3& d);

/// R* of a ball of radius r on a wall with this curvature across the side, negative inside [m].
double wall_contact_radius(double r, double curvature);

}  // namespace epafi
