/// @file spring_forces.h  Springs with dampers between bodies, or between a body and a frame that moves along a way:
/// suspensions. Linear, along the three axes of the second body or of the frame; relaxed as the scene starts.
///
/// Energies: springs store k d^2/2 along each axis, dampers dissipate (trapezoid over the step), the frame does the
/// work of its motion at the place of the attachment. Smooth contact: forces of the moment of detection. Non-smooth
/// contact: impulses of the forces at the middle of the step, in the balance beside gravity, so that a contact that
/// sticks takes them up whole (second order in the springs, first in the dampers). Explicit: see impulse_limit().
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/railway/guideway.h"
#include "engine/step/contact_layer.h"

namespace epafi {

struct SpringElement {
  std::string name;
  BodyId body{};
  Vec3 attachment = Vec3::Zero();  ///< body axes [m]
  std::optional<BodyId> to{};      ///< the other body; none: a frame on the way
  double speed = 0.0;              ///< of the frame along the way [m/s]
  Vec3 stiffness = Vec3::Zero();   ///< k along the axes of the other body or the frame [N/m], >= 0
  Vec3 damping = Vec3::Zero();     ///< c [N s/m], >= 0
  Vec3 preload = Vec3::Zero();     ///< force on the body as the scene starts, same axes [N]
};

/// Uses the body's unwrapped path, so wrapping into a periodic cell does not change the force.
inline Pose unwrapped_pose(const World& world, Slot s) {
  Pose pose = world.pose(s);
  pose.position = world.unwrapped(s);
  return pose;
}

/// smooth: forces are added to those of the contacts; else velocities are kicked before them.
std::unique_ptr<ContactModel> make_spring_forces(std::vector<SpringElement> springs,
                                                 std::shared_ptr<const Guideway> way, bool smooth,
                                                 std::unique_ptr<ContactModel> below);

/// Largest omega^2 of all springs and masses together [1/s^2], and largest damping rate [1/s]: eigenvalues of M^-1 K
/// and M^-1 C with masses, moments, arms and axes of the moment.
struct SpringRates {
  double square = 0.0, damping = 0.0;
};
SpringRates spring_rates(const std::vector<SpringElement>& springs, const World& world, const Guideway& way);

/// Non-smooth steps are stable below it [s]. x_m = x + dt v/2, v' = (1 - dt c) v - dt omega^2 x_m, x' = x_m + dt v'/2
/// has determinant 1 - dt c and trace 2 - dt c - (dt omega)^2: (dt omega)^2 + 2 dt c < 4 (Jury). Contacts only take
/// freedom away.
double impulse_limit(const SpringRates& rates);

}  // namespace epafi
