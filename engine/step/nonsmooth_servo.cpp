#include "engine/step/nonsmooth_servo.h"

#include <algorithm>
#include <string>

namespace epafi {

void NonsmoothServo::begin(double dt) {
  if (servo.has_gains()) {  // v = p (F + J/dt) + i (missed + dt F + J)
    mobility = servo.proportional / dt + servo.integral;
    free_speed = dt * servo.force * mobility + servo.integral * missed;
    // no faster than v_max, if contacts hold it as they did
    free_speed = std::min(free_speed, servo.max_speed - mobility * impulse);
  } else {  // m (v - v_k) = dt F + J - dt F v/v_max
    const double inertia = servo.mass + dt * servo.force / servo.max_speed;
    mobility = 1.0 / inertia;
    free_speed = (servo.mass * speed + dt * servo.force) / inertia;
  }
}

void NonsmoothServo::end(double solved_speed, double dt) {
  const double nearly = (1.0 - 1e-9) * servo.max_speed;  // rounding of the contact problem
  impulse = std::min(0.0, (solved_speed - free_speed) / mobility);
  speed = std::min(solved_speed, servo.max_speed);
  if (servo.has_gains() && solved_speed < nearly) missed += dt * servo.force + impulse;
}

void NonsmoothServoEvent::before_step(World& world, double dt, std::vector<BodyId>&) {
  NonsmoothServo& wall = *wall_;
  const Slot s = world.slot_of(wall.body);
  if (s == no_slot) return;
  const Vec3 motion = wall.servo.beside_motion ? world.velocity[s] : Vec3(Vec3::Zero());
  const double time = world.clock + elapsed_;
  if (time >= wall.servo.from && time < wall.servo.until)
    wall.begin(dt);
  else
    wall = NonsmoothServo{wall.body, Servo(wall.servo)};
  world.velocity[s] = motion + wall.speed * wall.servo.direction;
}

void NonsmoothServoEvent::visit(StateVisitor& visitor) {
  const std::string name = "servo/" + std::to_string(static_cast<std::uint32_t>(wall_->body));
  if (!visitor.has(name + "/speed")) return;
  visitor.value(name + "/speed", wall_->speed);
  visitor.value(name + "/missed", wall_->missed);
  if (visitor.has(name + "/impulse")) visitor.value(name + "/impulse", wall_->impulse);
}

}  // namespace epafi
