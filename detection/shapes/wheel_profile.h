/// @file wheel_profile.h  A wheelset: two wheels of revolution of one profile. It touches rails only (rail_profile.h).
#pragma once
#include <memory>

#include "detection/shapes/shape_concept.h"

namespace epafi {

struct Wheelset;

struct WheelProfile {
  static constexpr const char* name = "wheel_profile";
  std::shared_ptr<const Wheelset> wheelset;

  static Entry entry();

  double bounding_radius() const;
  double contact_radius() const;
  Aabb bounding_box(const Pose& pose) const {
    const Vec3 r = Vec3::Constant(bounding_radius());
    return {pose.position - r, pose.position + r};
  }
  /// The given mass properties, not those of density 1: an axle is no homogeneous body of revolution.
  MassProperties mass_properties() const;
};
static_assert(SolidShape<WheelProfile>);

}  // namespace epafi
