/// @file superquadric.h  Superquadric about its centre (Barr 1981): (|x/a|^n + |y/b|^n)^(m/n) + |z/c|^m <= 1, whole n,
/// m >= 2. n = m = 2 is the ellipsoid; large exponents come near the box (n, m) or the elliptic cylinder (n = 2, m
/// large).
#pragma once
#include <array>

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
  /// Which unit direction a step of Newton's method leads to from d, where the support point is `at`. To first order
  /// d + step. Beyond that, a coordinate of the direction that grows leads towards an edge: there the point hardly
  /// moves, and the direction is taken. One that shrinks leads into a flat, where it falls as a high power of the
  /// point's coordinate: the point is taken, and the direction is its normal. Either side of a power law is then
  /// approached without passing the end, where steps in the direction alone overshoot by the power.
  Vec3 turned(const Vec3& d, const CurvedSupport& at, const Vec3& step) const;
  Vec3 core_semi_axes() const { return semi_axes; }
  bool curved() const { return across == 2 && along == 2; }
  double least_radius() const { return least_radius_; }

 private:
  /// The support point of the unit superquadric, without signs, and what it follows from.
  struct UnitPoint {
    Vec3 x{1.0, 0.0, 0.0};
    Vec3 slope{1.0, 0.0, 0.0};  ///< x^(n - 1) by coordinate; of x and y where both exponents are one
    double reach = 0.0;         ///< x times the stretched direction [m]
    // of two exponents: x and y are section * scale, with their own slopes
    std::array<double, 2> section{1.0, 0.0}, section_slope{1.0, 0.0};
    double scale = 1.0, scale_slope = 1.0;
  };
  static constexpr double flattest = 1e8;  ///< radii of curvature above this times the size count as this
  UnitPoint unit_point(const Vec3& d) const;
  UnitPoint point_of_one_exponent(const Vec3& sides) const;
  UnitPoint point_of_two_exponents(const Vec3& sides) const;
  static double flatness(double x, double slope, int n);
  Mat3 curvature(const UnitPoint& p) const;
  /// Along the normal at a point of the unit superquadric, or of one that is similar to it.
  Vec3 gradient(const Vec3& x) const;
  Vec3 signed_axes(const Vec3& d) const;
  double radius_at(const Vec3& d) const;
  double find_least_radius() const;
  double volume_, radius_, contact_radius_, least_radius_;
};
static_assert(SolidShape<Superquadric> && ConvexShape<Superquadric>);

}  // namespace epafi
