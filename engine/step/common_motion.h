/// @file common_motion.h  The predicted common motion of the bodies. Bodies that fall together do not move relative to
/// it.
#pragma once
#include "engine/state/types.h"

namespace epafi {

/// Motion of the frame since its start.
struct CommonMotion {
  Vec3 velocity = Vec3::Zero();      ///< at the start [m/s]
  Vec3 acceleration = Vec3::Zero();  ///< [m/s^2]
  Vec3 velocity_at(double time) const { return velocity + time * acceleration; }
  /// Displacement since the start [m].
  Vec3 displacement(double time) const { return time * velocity_at(0.5 * time); }
};

}  // namespace epafi
