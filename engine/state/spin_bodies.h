/// @file spin_bodies.h  Kick and torque-free rotation of bodies with unequal principal moments, in SIMD lanes: body by
/// body, the rotations take a third of a step of clumps.
#pragma once
#include "engine/state/world.h"

namespace epafi {

/// Advances the free bodies with unequal moments in slots [begin, end); with columns().force. The angular momentum
/// changes by torque times `kick` [s], `kicks` times; then bodies rotate without torque for `turn` [s] (0: not at all).
/// The bits are those of rotate_freely and World::apply_angular_impulse.
void spin_bodies(World& world, double kick, int kicks, double turn, std::size_t begin, std::size_t end);

}  // namespace epafi
