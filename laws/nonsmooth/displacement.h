/// @file displacement.h  Moves bodies without touching their velocities.
#pragma once
#include "engine/state/world.h"
#include "laws/nonsmooth/contact_problem.h"

namespace epafi {

/// Moves the free and guided bodies of the problem by `by` [m], [rad]; returns the potential energy of gravity and
/// external forces that it puts in [J].
double displace(World& world, const ContactProblem& problem, const BodyVelocities& by);

}  // namespace epafi
