#include "engine/servo.h"

namespace epafi {

void ServoWall::before_step(World& world, double dt, std::vector<BodyId>&) {
  const Slot s = world.slot_of(body_);
  if (s == no_slot) return;
  if (world.time < servo_.from || world.time >= servo_.until) {
    world.velocity[s].setZero();
    return;
  }
  const double push = servo_.force + world.force[s].dot(servo_.direction);
  const double v = world.velocity[s].dot(servo_.direction), rate = servo_.force / (servo_.max_speed * servo_.mass);
  world.velocity[s] = (v + dt * push / servo_.mass) / (1.0 + dt * rate) * servo_.direction;  // damping implicit
}

}  // namespace epafi
