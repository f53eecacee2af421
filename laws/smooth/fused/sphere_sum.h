/// @file sphere_sum.h  What the loop over spheres adds up for each.
#pragma once
#include "engine/lanes/lanes.h"

namespace epafi {

/// What the loop writes of a body; it reads BodyState. The pull is the torque over the radius: both bodies of a contact
/// feel the same one. Six numbers side by side are three registers of SSE2, not four.
struct alignas(64) SphereSum {
  Lanes first;   ///< force x y z, pull x [N]
  Lanes second;  ///< pull y z [N], 0, 0
};

}  // namespace epafi
