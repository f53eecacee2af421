/// @file hertzian.h  Nearest (deepest) points of two smooth surfaces with the principal curvatures there: what Hertz's
/// theory starts from (Johnson 1985, section 4.1).
/// The two points lie on one common normal: x_b = x_a + gap n_a(x_a), n_b(x_b) = -n_a(x_a), F_a = F_b = 0. Newton's
/// method on (x_a, gap); it passes through gap = 0 without a singularity, so touching and overlapping surfaces are no
/// special case. Several such pairs of points may exist: the one near the guess is found.
#pragma once
#include "detection/surfaces/smooth_surface.h"

namespace epafi {

/// Principal curvatures of a surface at a point, > 0 where the body is convex.
struct PrincipalCurvatures {
  double larger = 0.0, smaller = 0.0;  ///< [1/m]
  Vec3 direction_larger = Vec3::UnitX(),
       direction_smaller = Vec3::UnitY();  ///< unit, right-handed with the outward normal
};

/// Principal curvatures of the surface F = 0 at a point of it, in the axes of F. The gradient must not vanish.
[[nodiscard]] PrincipalCurvatures principal_curvatures(const ImplicitValue& f);

struct HertzianPoints {
  enum class Status {
    found,          ///< a nearest pair of points; the last step was below 1e-13 of the size
    not_converged,  ///< Newton's method did not settle within its steps: another guess may
    not_nearest     ///< a common normal, but the distance is not smallest there (an inner side, a saddle)
  };
  Status status = Status::not_converged;
  double gap = 0.0;             ///< signed [m], < 0: overlap
  Vec3 normal = Vec3::UnitZ();  ///< unit, from A to B, world axes
  Vec3 point_a, point_b;        ///< relative to the own body's position, world axes [m]
  PrincipalCurvatures a, b;     ///< directions in world axes
  /// Curvatures of the gap between the undeformed surfaces over the common tangent plane, h = gap + (larger x^2 +
  /// smaller y^2) / 2.
  PrincipalCurvatures relative;
  int iterations = 0;
};

/// guess: a point near the contact, world axes, relative to A's position [m]; Newton's method starts from its feet on
/// both.
[[nodiscard]] HertzianPoints find_hertzian_points(const SmoothSurface& a, const Pose& pose_a, const SmoothSurface& b,
                                                  const Pose& pose_b, const Vec3& guess);

}  // namespace epafi
