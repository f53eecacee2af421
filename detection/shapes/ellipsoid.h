/// @file ellipsoid.h  Ellipsoid about its centre: (x/a)^2 + (y/b)^2 + (z/c)^2 <= 1.
#pragma once
#include <numbers>

#include "detection/shapes/equal_volume.h"
#include "detection/shapes/shape_concept.h"

namespace epafi {

struct Ellipsoid {
  static constexpr const char* name = "ellipsoid";
  Vec3 semi_axes;  ///< (a, b, c) [m], each > 0

  explicit Ellipsoid(const Vec3& abc) : semi_axes(abc), contact_radius_(equal_volume_radius(volume())) {}

  static Entry entry() {
    return {name,
            "ellipsoid about its centre",
            {{"semi_axes", "a b c", "m", Kind::vec3, {}, positive, "half lengths along x, y and z"}},
            {},
            ""};
  }

  double volume() const { return 4.0 / 3.0 * std::numbers::pi * semi_axes.x() * semi_axes.y() * semi_axes.z(); }
  double contact_radius() const { return contact_radius_; }  ///< of the sphere of equal volume [m]
  double bounding_radius() const { return semi_axes.maxCoeff(); }
  /// Exact: support in direction e_i is |A R^T e_i| with A = diag(a, b, c).
  Aabb bounding_box(const Pose& pose) const {
    const Mat3 stretched = pose.orientation.toRotationMatrix() * semi_axes.asDiagonal();
    const Vec3 half = stretched.rowwise().norm();
    return {pose.position - half, pose.position + half};
  }
  MassProperties mass_properties() const {
    const double m = volume();
    const Vec3 squared = semi_axes.cwiseProduct(semi_axes);
    const Vec3 moments = 0.2 * m * (Vec3::Constant(squared.sum()) - squared);
    return {m, Vec3::Zero(), moments.asDiagonal()};
  }
  /// A^2 d / |A d|
  Vec3 support(const Vec3& d) const {
    const Vec3 stretched = semi_axes.cwiseProduct(d);
    const double size = std::sqrt(stretched.squaredNorm());
    if (!(size > 0.0)) return {semi_axes.x(), 0.0, 0.0};
    return semi_axes.cwiseProduct(stretched / size);
  }
  double rounding() const { return 0.0; }
  /// The derivative A^2/|A d| - x x^T/|A d| of the support point x = A^2 d/|A d|.
  CurvedSupport curved_support(const Vec3& d) const {
    const Vec3 stretched = semi_axes.cwiseProduct(d);
    const double size = std::sqrt(stretched.squaredNorm());
    const Vec3 point = semi_axes.cwiseProduct(stretched / size);
    Mat3 derivative = -(point / size) * point.transpose();
    derivative.diagonal() += semi_axes.cwiseProduct(semi_axes) / size;
    return {point, derivative};
  }
  Vec3 core_semi_axes() const { return semi_axes; }
  /// At the end of the longest axis, along the shortest.
  bool curved() const { return true; }
  double least_radius() const {
    const double shortest = semi_axes.minCoeff();
    return shortest * shortest / semi_axes.maxCoeff();
  }

 private:
  double contact_radius_;
};
static_assert(SolidShape<Ellipsoid> && ConvexShape<Ellipsoid>);

}  // namespace epafi
