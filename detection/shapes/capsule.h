/// @file capsule.h  Cylinder with two half spheres, axis z: all points within r of a segment.
#pragma once
#include <numbers>

#include "detection/shapes/flat_side.h"
#include "detection/shapes/shape_concept.h"

namespace epafi {

struct Capsule {
  static constexpr const char* name = "capsule";
  double radius;  ///< r [m], > 0
  double length;  ///< L of the cylindrical part [m], >= 0; the whole capsule is L + 2r long

  Capsule(double r, double l) : radius(r), length(l) {}

  static Entry entry() {
    return {name,
            "cylinder with two half spheres, axis z",
            {{"radius", "r", "m", Kind::number, {}, positive, "radius of the cylinder and of the half spheres"},
             {"length", "L", "m", Kind::number, {}, not_negative, "length of the cylindrical part"}},
            {},
            ""};
  }

  double half_length() const { return 0.5 * length; }
  /// Too short for two contact points side by side: the contact areas of its ends would be one (Hertz: a radius of
  /// 0.1 r at an overlap of 0.01 r). It touches with the deeper end, so that it becomes a sphere as L goes to 0.
  bool is_short() const { return length < 0.25 * radius; }
  double volume() const { return std::numbers::pi * radius * radius * (length + 4.0 / 3.0 * radius); }
  double contact_radius() const { return radius; }  ///< of its ends [m]; along the side half the curvature is left out
  double bounding_radius() const { return half_length() + radius; }
  Aabb bounding_box(const Pose& pose) const {
    const Vec3 axis = pose.orientation * Vec3::UnitZ();
    const Vec3 half = half_length() * axis.cwiseAbs() + Vec3::Constant(radius);
    return {pose.position - half, pose.position + half};
  }
  /// Sum of the cylinder and of the two half spheres, whose centres lie 3r/8 beyond its ends.
  MassProperties mass_properties() const {
    const double r = radius, l = length;
    const double cylinder = std::numbers::pi * r * r * l;
    const double spheres = 4.0 / 3.0 * std::numbers::pi * r * r * r;
    const double across =
        cylinder * (r * r / 4.0 + l * l / 12.0) + spheres * (0.4 * r * r + 0.25 * l * l + 0.375 * l * r);
    const double along = 0.5 * cylinder * r * r + 0.4 * spheres * r * r;
    return {cylinder + spheres, Vec3::Zero(), Vec3(across, across, along).asDiagonal()};
  }
  Vec3 support(const Vec3& d) const {
    return {0.0, 0.0, d.z() < 0.0 ? -half_length() : half_length()};
  }  // core: a segment
  CylinderCore cylinder_core() const { return {0.0, half_length()}; }
  double rounding() const { return radius; }
  /// The axis, where d looks across it and it is not short.
  FlatSide facing(const Vec3& d) const {
    FlatSide side;
    if (is_short() || !(d.z() * d.z() < facing_sine * facing_sine * d.squaredNorm())) return side;
    side.corner[0] = {0.0, 0.0, -half_length()};
    side.corner[1] = {0.0, 0.0, half_length()};
    side.count = 2;
    return side;
  }
};
static_assert(SolidShape<Capsule> && ConvexShape<Capsule>);

}  // namespace epafi
