/// @file rail_profile.h  A track of two rails of one profile, for fixed bodies; it touches wheelsets only.
#pragma once
#include <memory>

#include "detection/shapes/shape_concept.h"

namespace epafi {

class Track;

struct RailProfile {
  static constexpr const char* name = "rail_profile";
  std::shared_ptr<const Track> track;
  double drawn_length = 0.0;  ///< of the rails in pictures, from the start [m]

  static Entry entry();

  double contact_radius() const { return infinity; }
  double bounding_radius() const { return infinity; }
  Aabb bounding_box(const Pose&) const { return {Vec3::Constant(-infinity), Vec3::Constant(infinity)}; }
};

}  // namespace epafi
