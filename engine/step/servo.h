/// @file servo.h  Servo wall: presses with a given force and moves along one line as a damped body of its own mass, m
/// dv/dt = F - F_contact - F v/v_max with the reaction F_contact. At rest it carries exactly F; without contact it
/// approaches at v_max, with the time constant m v_max/F. With gains it is a PI controller instead, which carries F
/// also while it moves: v = p (F - F_contact) + i (integral of the same), limited to v_max (the integral then stays
/// constant). Smooth contact uses the forces of the last step (servo_event.h), non-smooth contact those of the step
/// itself (nonsmooth_servo.h). A motion of the same body acts first; the servo adds its velocity.
#pragma once
#include "engine/step/events.h"

namespace epafi {

struct Servo {
  Vec3 direction = Vec3::UnitZ();  ///< it presses along this, unit
  double force = 0.0;              ///< F [N], > 0
  double mass = 0.0;               ///< m [kg], > 0
  double max_speed = 0.0;          ///< v_max [m/s], > 0
  double proportional = 0.0;       ///< p [m/(N s)]; p > 0 or i > 0: PI controller
  double integral = 0.0;           ///< i [m/(N s^2)]
  bool beside_motion = false;      ///< another event has set the velocity of this step
  /// Without gains: effective mass for alternating motion, which contains the damping F/v_max at the end of a step
  /// [kg]; stable while dt < 2 sqrt(this/K), K the stiffness of the contacts.
  double mass_in_step(double dt) const { return mass + 0.5 * dt * force / max_speed; }
  bool has_gains() const { return proportional > 0.0 || integral > 0.0; }
  double from = 0.0;                                       ///< the wall rests before [s]
  double until = std::numeric_limits<double>::infinity();  ///< and after [s]
};

}  // namespace epafi
