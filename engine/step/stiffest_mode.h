/// @file stiffest_mode.h  How stiff the bodies of a scene are on all their contacts and springs together, and with it
/// whether a time step is stable.
/// Velocity Verlet with dampers that see velocities predicted by the last acceleration has the root -1 where
/// det(M - dt^2/4 K - dt C) = 0: set x, v, a alternating, v = dt a/2 of the last step, x = -dt v/2. A step is stable
/// while the largest eigenvalue of M^-1 (dt^2/4 K + dt C) stays below 1; of one body, omega^2 dt^2/4 + c dt/m < 1.
/// Dampers that see more than that bring less than dt c (laws/smooth/damper.h). K and C count all contacts of a body
/// with their arms and its inertia. Geometric stiffness (force over size) is left out: below a percent of that of a
/// contact while overlaps are. The eigenvalue: Lanczos from a start that depends on body numbers alone, in one order:
/// the same bits for every number of threads. It comes from below, within a percent where it has converged.
#pragma once
#include <vector>

#include "engine/state/world.h"

namespace epafi {

/// A contact or a spring at a moment: what resists that B moves against A.
struct StiffLink {
  Slot a = no_slot, b = no_slot;                    ///< no_slot: the ground
  Vec3 arm_a = Vec3::Zero(), arm_b = Vec3::Zero();  ///< from the centres [m]
  Vec3 normal = Vec3::UnitZ();
  double along = 0.0;   ///< dt^2/4 k and what the damper adds, along the normal [kg], >= 0
  double across = 0.0;  ///< and in the plane [kg]
  double turn = 0.0;    ///< and against rolling about axes of the plane [kg m^2]
};

struct StiffestMode {
  double value = 0.0;     ///< largest eigenvalue of M^-1 (dt^2/4 K + dt C), stable below 1
  Slot body = no_slot;    ///< that its own links hold stiffest
  std::size_t link = 0;   ///< the stiffest of it
  std::size_t links = 0;  ///< how many it has
};

/// A driven body that gives way along one line with a mass of its own: a servo wall.
struct PressedBody {
  BodyId body{};
  Vec3 line = Vec3::UnitZ();  ///< unit
  double mass = 0.0;          ///< [kg]
};

/// enough: what the value is held against; the search ends early where it is surely below.
StiffestMode stiffest_mode(const World& world, const std::vector<StiffLink>& links, double enough = 0.0,
                           const std::vector<PressedBody>& pressed = {});

/// The value of `stiffest_mode` without pressed bodies is at most this: twice the largest one of a single body whose
/// neighbours rest, since (a + b)^2 <= 2 a^2 + 2 b^2 for what a contact sees of its bodies, and up to a quarter more.
/// In a part of several processes: of its own bodies.
double stiffness_bound(const World& world, const std::vector<StiffLink>& links);

}  // namespace epafi
