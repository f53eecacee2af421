/// @file cylinder.h  Right circular cylinder about its centre, axis z.
#pragma once
#include <numbers>

#include "detection/shapes/equal_volume.h"
#include "detection/shapes/flat_side.h"
#include "detection/shapes/shape_concept.h"

namespace epafi {

struct Cylinder {
  static constexpr const char* name = "cylinder";
  double radius;  ///< r [m], > 0
  double length;  ///< L [m], > 0

  Cylinder(double r, double l) : radius(r), length(l), contact_radius_(equal_volume_radius(volume())) {}

  static Entry entry() {
    return {name,
            "right circular cylinder, axis z",
            {{"radius", "r", "m", Kind::number, {}, positive, "radius"},
             {"length", "L", "m", Kind::number, {}, positive, "length along the axis"}},
            {},
            ""};
  }

  double half_length() const { return 0.5 * length; }
  double volume() const { return std::numbers::pi * radius * radius * length; }
  double contact_radius() const { return contact_radius_; }  ///< of the sphere of equal volume [m]
  double bounding_radius() const { return std::sqrt(half_length() * half_length() + radius * radius); }
  /// Exact: the disk of radius r normal to u reaches r sqrt(1 - u_i^2) along axis i.
  Aabb bounding_box(const Pose& pose) const {
    const Mat3 turn = pose.orientation.toRotationMatrix();
    const Vec3 half = half_length() * turn.col(2).cwiseAbs() + radius * turn.leftCols<2>().rowwise().norm();
    return {pose.position - half, pose.position + half};
  }
  MassProperties mass_properties() const {
    const double m = volume(), r2 = radius * radius;
    const double across = m * (r2 / 4.0 + length * length / 12.0);
    return {m, Vec3::Zero(), Vec3(across, across, 0.5 * m * r2).asDiagonal()};
  }
  /// A point of the rim; where d is along the axis the centre of the end, which is as far as any other.
  Vec3 support(const Vec3& d) const {
    const double z = d.z() < 0.0 ? -half_length() : half_length();
    const double across = std::sqrt(d.x() * d.x() + d.y() * d.y());
    if (!(across > 0.0)) return {0.0, 0.0, z};
    return {radius * (d.x() / across), radius * (d.y() / across), z};
  }
  /// Flat at the ends; along the side twice the radius, whose curvature is the mean of the side's two.
  double radius_towards(const Vec3& d) const {
    const double across2 = d.x() * d.x() + d.y() * d.y();
    return across2 < facing_sine * facing_sine * d.squaredNorm() ? infinity : 2.0 * radius;
  }
  CylinderCore cylinder_core() const { return {radius, half_length()}; }
  double rounding() const { return 0.0; }
  /// Eight points of the rim of the end on the side of d, or the line of the side.
  FlatSide facing(const Vec3& d) const {
    FlatSide side;
    const double across2 = d.x() * d.x() + d.y() * d.y(), limit = facing_sine * facing_sine * d.squaredNorm();
    if (across2 < limit) {
      const double z = d.z() < 0.0 ? -half_length() : half_length(), q = 0.70710678118654752440 * radius;
      side.corner = {Vec3(radius, 0, z),  Vec3(q, q, z),   Vec3(0, radius, z),  Vec3(-q, q, z),
                     Vec3(-radius, 0, z), Vec3(-q, -q, z), Vec3(0, -radius, z), Vec3(q, -q, z)};
      side.count = 8;
    } else if (d.z() * d.z() < limit) {
      const double across = std::sqrt(across2), x = radius * (d.x() / across), y = radius * (d.y() / across);
      side.corner[0] = {x, y, -half_length()};
      side.corner[1] = {x, y, half_length()};
      side.count = 2;
    }
    return side;
  }

 private:
  double contact_radius_;
};
static_assert(SolidShape<Cylinder> && ConvexShape<Cylinder>);

}  // namespace epafi
