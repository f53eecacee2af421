/// @file common_motion.h  The predicted common motion of the bodies: relative to it, bodies that fall together do not
/// move.
#pragma once
#include "engine/state/types.h"

namespace epafi {

/// A frame that moves; nothing moves in it where all bodies fall side by side.
struct CommonMotion {
  Vec3 velocity = Vec3::Zero();      ///< at first [m/s]
  Vec3 acceleration = Vec3::Zero();  ///< [m/s^2]
  Vec3 velocity_at(double time) const { return velocity + time * acceleration; }
  /// Since the beginning [m].
  Vec3 displacement(double time) const { return time * velocity_at(0.5 * time); }
};

}  // namespace epafi
