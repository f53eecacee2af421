/// @file sphere.h  Sphere about its centre.
#pragma once
#include <numbers>

#include "detection/shapes/shape_concept.h"

namespace epafi {

struct Sphere {
  static constexpr const char* name = "sphere";
  double radius = 0.0;  ///< r [m], > 0

  static Entry entry() {
    return {name, "sphere about its centre", {{"radius", "r", "m", Kind::number, {}, positive, "radius"}}, {}, ""};
  }

  double contact_radius() const { return radius; }
  double bounding_radius() const { return radius; }
  Aabb bounding_box(const Pose& pose) const { return {pose.position.array() - radius, pose.position.array() + radius}; }
  MassProperties mass_properties() const {
    const double m = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
    return {m, Vec3::Zero(), 0.4 * m * radius * radius * Mat3::Identity()};
  }
  Vec3 support(const Vec3&) const { return Vec3::Zero(); }  // the core is the centre
  CylinderCore cylinder_core() const { return {0.0, 0.0}; }
  double rounding() const { return radius; }
  CurvedSupport curved_support(const Vec3&) const { return {Vec3::Zero(), Mat3::Zero()}; }
  Vec3 core_semi_axes() const { return Vec3::Constant(radius); }
  bool curved() const { return true; }
  double least_radius() const { return 0.0; }
};
static_assert(SolidShape<Sphere> && ConvexShape<Sphere>);

}  // namespace epafi
