/// @file stiffest_mode.h  Stability of a time step, from the stiffness of all contacts and springs of the bodies
/// together. Velocity Verlet with dampers that use velocities predicted from the last acceleration has the
/// amplification factor -1 if det(M - dt^2/4 K - dt C) = 0 (with alternating x, v, a: v = dt a/2 of the last step, x =
/// -dt v/2). A step is stable while the largest eigenvalue of M^-1 (dt^2/4 K + dt C) is below 1; for one body, omega^2
/// dt^2/4 + c dt/m < 1. Dampers with a better prediction contribute less than dt c (laws/smooth/damper.h). K and C
/// contain all contacts of a body with their arms and its inertia. Geometric stiffness (force over size) is neglected:
/// below one percent of a contact's while overlaps are. The eigenvalue is computed by Lanczos from a start that depends
/// on body ids alone, in a fixed order: the same bits for every number of threads. It converges from below, to within
/// one percent.
#pragma once
#include <vector>

#include "engine/state/world.h"

namespace epafi {

/// A contact or a spring: its resistance to relative motion of A and B.
struct StiffLink {
  Slot a = no_slot, b = no_slot;                    ///< no_slot: the ground
  Vec3 arm_a = Vec3::Zero(), arm_b = Vec3::Zero();  ///< from the centres [m]
  Vec3 normal = Vec3::UnitZ();
  double along = 0.0;   ///< dt^2/4 k plus the damper's part, along the normal [kg], >= 0
  double across = 0.0;  ///< the same in the tangent plane [kg]
  double turn = 0.0;    ///< the same against rolling about axes in the plane [kg m^2]
};

struct StiffestMode {
  double value = 0.0;     ///< largest eigenvalue of M^-1 (dt^2/4 K + dt C), stable below 1
  Slot body = no_slot;    ///< the body with the stiffest links
  std::size_t link = 0;   ///< its stiffest link
  std::size_t links = 0;  ///< number of its links
};

/// A servo wall: a driven body that moves along one line with a mass of its own.
struct PressedBody {
  BodyId body{};
  Vec3 line = Vec3::UnitZ();  ///< unit
  double mass = 0.0;          ///< [kg]
};

/// enough: threshold; the search ends early once the value is certainly below it.
StiffestMode stiffest_mode(const World& world, const std::vector<StiffLink>& links, double enough = 0.0,
                           const std::vector<PressedBody>& pressed = {});

/// Upper bound of the value of `stiffest_mode` without pressed bodies: twice the largest value of a single body with
/// fixed neighbours, since (a + b)^2 <= 2 a^2 + 2 b^2 for the motions of the two bodies, and up to a quarter more. With
/// several processes: over the bodies of this one.
double stiffness_bound(const World& world, const std::vector<StiffLink>& links);

}  // namespace epafi
