/// @file superquadric.h  Superquadric about its centre (Barr 1981): (|x/a|^n + |y/b|^n)^(m/n) + |z/c|^m <= 1, whole n,
/// m >= 2. n = m = 2 is the ellipsoid; large exponents come near the box (n, m) or the elliptic cylinder (n = 2, m
/// large). Roots are taken by Newton's method with + - * / only, so that no libm decides a bit of a run.
#pragma once
#include "detection/shapes/equal_volume.h"
#include "detection/shapes/shape_concept.h"

namespace epafi {

struct Superquadric {
  static constexpr const char* name = "superquadric";
  Vec3 semi_axes;     ///< (a, b, c) [m], each > 0
  int across, along;  ///< n, the exponent across the z axis, and m, along it; 2 to 32

  Superquadric(const Vec3& abc, int n, int m);

  static Entry entry();

  double volume() const { return volume_; }
  double contact_radius() const { return contact_radius_; }  ///< of the sphere of equal volume [m]
  double bounding_radius() const { return radius_; }
  /// Exact: the support along the axes.
  Aabb bounding_box(const Pose& pose) const;
  /// By Beta functions of the exponents.
  MassProperties mass_properties() const;
  /// The point whose outward normal is d: coordinates are (n - 1)th roots of the stretched direction's.
  Vec3 support(const Vec3& d) const;
  double rounding() const { return 0.0; }
  /// Where the surface is flat the derivative is large and not infinite.
  CurvedSupport curved_support(const Vec3& d) const;
  Vec3 core_semi_axes() const { return semi_axes; }
  bool curved() const { return across == 2 && along == 2; }
  double least_radius() const { return least_radius_; }

 private:
  /// The support point of the unit superquadric, without signs: (u s, v s, height).
  struct UnitPoint {
    double u = 1.0, v = 0.0, scale = 1.0, height = 0.0;
    double beside = 0.0, reach = 0.0;  ///< of the stretched direction: across z, and in all
  };
  static constexpr double least_side = 1e-4;  ///< a coordinate below counts as this in a curvature
  UnitPoint unit_point(const Vec3& d) const;
  Vec3 on_surface(const UnitPoint& p, const Vec3& d) const;
  double find_least_radius() const;
  double volume_, radius_, contact_radius_, least_radius_;
};
static_assert(SolidShape<Superquadric> && ConvexShape<Superquadric>);

/// x^k and the kth root of x, x >= 0, k >= 1; relative error of the root below 4 ulp.
double whole_power(double x, int k);
double whole_root(double x, int k);

}  // namespace epafi
