/// @file body_ball.h  A ball that stands where its body says: one of a clump, or a sphere that is held. What detects
/// the pairs of spheres (SpherePairs) gives each a place of its own: first come the balls of free bodies by slot and
/// part, then those of held ones, behind them by slot all bodies, of which the free spheres are meant.
#pragma once
#include "engine/state/types.h"

namespace epafi {

struct BodyBall {
  Slot body = 0;
  std::uint16_t part = 0;      ///< its number in the clump
  bool of_clump = false;       ///< else it is all of the body
  Vec3 centre = Vec3::Zero();  ///< body axes [m]
  double radius = 0.0;         ///< [m]
  bool operator==(const BodyBall&) const = default;
};

}  // namespace epafi
