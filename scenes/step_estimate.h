/// @file step_estimate.h  Estimates the stable time step of a scene before it has contacts: impacts at an expected
/// speed, packings under an expected load, flat bodies on four points. Limits are those of engine/step/stiffest_mode.h
/// with the law's stiffness and dashpot at the overlap of that speed or load.
///
/// Limits are right to 20 % if speed and load are those expected; for Hertz they vary with their powers 1/6 (load) and
/// 1/5 (speed). StepWatch checks the step during the run.
///
/// The estimate is more conservative for bodies slower than expected, which is a fall through the height of all bodies:
/// a ball or a box placed at rest is stable up to 2.1 and 2.4 times its limit for every e, since its contacts are a
/// ninth as deep as after that fall.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/step/servo.h"
#include "laws/smooth/contact_links.h"

namespace epafi {

/// A body that may rest on several points at once.
struct FlatBody {
  double mass = 0.0;
  Vec3 inertia = Vec3::Zero();  ///< principal [kg m^2]
  Vec3 half = Vec3::Zero();     ///< half the sides of its box [m]
  double radius = 0.0;          ///< of the sphere of its volume [m]
  int corners = 4;              ///< contact points on its largest face, at least 4
};

/// A pair of kinds of bodies.
struct ExpectedPair {
  std::uint16_t i = 0, j = 0;  ///< materials
  double mass = 0.0;           ///< of the lighter body [kg]
  ContactKinematics at;        ///< m*, R*; the overlap comes with speed or load
};

/// Overlap of the pair under a force [m].
double overlap_under(const ContactLinks& links, const ExpectedPair& pair, double force);

/// Largest stable step for one contact of round bodies at an overlap [s].
double impact_step(const ContactLinks& links, const ExpectedPair& pair, double overlap);

/// The same for a packing of round bodies with this number of contacts each [s].
double packing_step(const ContactLinks& links, const ExpectedPair& pair, double overlap, double coordination);

/// Effective number of contacts of a body for the stable step of a packing at rest: the isostatic number (6 without
/// friction, 4 with it) plus a tenth, and plus a half with dampers that stop an impact at once, because of walls.
/// Fitted to random beds with and without load (perf/step_limits.py). A dense crystal with 12 contacts has a shorter
/// stable step, which StepWatch detects during the run.
double resting_contacts(double friction, double restitution);

/// Equal balls on each other, the lowest on a floor.
struct Column {
  std::size_t balls = 1;
  double mass = 0.0, radius = 0.0;  ///< of a ball [kg], [m]
  double weight = 0.0;              ///< of a ball [N]
  double press = 0.0;               ///< of a plate on the uppermost [N]; 0: there is none
  std::optional<Servo> plate{};     ///< servo of the plate, if it is force-controlled
  std::uint16_t ball_material = 0, floor_material = 0;
};

/// Stable step from the eigenvalue of all its contacts under the load above them [s].
double column_step(const ContactLinks& links, const Column& column);

/// Stable step of a flat body on the corners of its stiffest face at an overlap; the lowest of `stacked` bodies [s].
double corner_step(const ContactLinks& links, const ExpectedPair& pair, const FlatBody& body, double overlap,
                   std::size_t stacked);

}  // namespace epafi
