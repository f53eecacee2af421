/// @file step_estimate.h  What time step the contacts of a scene will bear, before it has any: impacts at an expected
/// speed, packings under an expected load, flat bodies on four points. All limits are those of
/// engine/step/stiffest_mode.h with the law's stiffness and dashpot at the overlap of that speed or load.
///
/// Limits hold to 20 % where speed and load are what was expected; they go with its power 1/6 (load) and 1/5 (speed)
/// for Hertz. What comes otherwise is met by the watch in the run.
///
/// On the safe side, beyond 20 %, are bodies that never get the speed that is expected of them, a fall through the
/// height of all bodies: a ball or a box set down at rest stays at rest up to 2.1 and 2.4 times its limit, whatever e,
/// as its contacts are a ninth as deep as after that fall.
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
  int corners = 4;              ///< that carry it on its largest face, 4 at least
};

/// What two kinds of bodies are to each other.
struct ExpectedPair {
  std::uint16_t i = 0, j = 0;  ///< materials
  double mass = 0.0;           ///< of the lighter body [kg]
  ContactKinematics at;        ///< m*, R*; the overlap comes with speed or load
};

/// Overlap at which the pair presses with a force [m].
double overlap_under(const ContactLinks& links, const ExpectedPair& pair, double force);

/// Of one contact of round bodies at an overlap: the largest step [s].
double impact_step(const ContactLinks& links, const ExpectedPair& pair, double overlap);

/// Of a packing of round bodies with so many contacts each at an overlap [s].
double packing_step(const ContactLinks& links, const ExpectedPair& pair, double overlap, double coordination);

/// Contacts of a body that decide about the step of a packing at rest: as many as hold it, 6 without friction and 4
/// with it (isostatic), a tenth more, and half more under dampers that stop an impact at once, where walls count. By
/// random beds with and without a load (perf/step_limits.py). A dense crystal of 12 bears less, which the watch sees in
/// the run.
double resting_contacts(double friction, double restitution);

/// Equal balls on each other, the lowest on a floor.
struct Column {
  std::size_t balls = 1;
  double mass = 0.0, radius = 0.0;  ///< of a ball [kg], [m]
  double weight = 0.0;              ///< of a ball [N]
  double press = 0.0;               ///< of a plate on the uppermost [N]; 0: there is none
  std::optional<Servo> plate{};     ///< that presses, where it gives way
  std::uint16_t ball_material = 0, floor_material = 0;
};

/// By the eigenvalue of all its contacts under what lies above them [s].
double column_step(const ContactLinks& links, const Column& column);

/// Of a flat body that lies on the corners of its stiffest face at an overlap; the lowest of `stacked` bodies where
/// more than one is free [s].
double corner_step(const ContactLinks& links, const ExpectedPair& pair, const FlatBody& body, double overlap,
                   std::size_t stacked);

}  // namespace epafi
