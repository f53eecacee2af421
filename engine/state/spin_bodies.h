/// @file spin_bodies.h  Kick and free turn of bodies with unequal principal moments, as many at a time as a register
/// has numbers: three turns about body axes and one in space are a third of a step of clumps, body by body.
#pragma once
#include "engine/state/world.h"

namespace epafi {

/// Of the bodies in slots [begin, end) that have unequal moments and are free to turn; with columns().force. First the
/// angular momentum grows by torque times `kick` [s], `kicks` times, then they turn without torque for `turn` [s], 0:
/// not at all. The bits are those of rotate_freely and World::apply_angular_impulse.
void spin_bodies(World& world, double kick, int kicks, double turn, std::size_t begin, std::size_t end);

}  // namespace epafi
