/// @file body_ball.h  A ball that follows its body: a ball of a clump, or a fixed or driven sphere. Each has a place in
/// SpherePairs: first the balls of free bodies by slot and part, then those of held ones, then all bodies by slot, of
/// which only free spheres are used.
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
