/// @file servo.h  A wall that presses with a given force: it moves along one line as a damped body of its own mass.
/// m dv/dt = F - F_contact - F v/v_max, F_contact what the others push back with: at rest it carries exactly F, without
/// contact it closes in at v_max with the time constant m v_max/F. Smooth contact only: forces are those of the step.
#pragma once
#include "engine/events.h"

namespace epafi {

struct Servo {
  Vec3 direction = Vec3::UnitZ();  ///< it presses along this, unit
  double force = 0.0;              ///< F [N], > 0
  double mass = 0.0;               ///< m [kg], > 0; stable while dt < 2 sqrt(m/K), K the stiffness it presses on
  double max_speed = 0.0;          ///< v_max [m/s], > 0
  double from = 0.0;               ///< it rests before [s]
  double until = std::numeric_limits<double>::infinity();  ///< and after [s]
};

class ServoWall final : public Event {
 public:
  ServoWall(BodyId body, const Servo& servo) : body_(body), servo_(servo) {}
  void before_step(World& world, double dt, std::vector<BodyId>& leaving) override;

 private:
  BodyId body_;
  Servo servo_;
};

}  // namespace epafi
