#include "engine/step/servo.h"

#include <algorithm>
#include <string>

namespace epafi {

void ServoWall::before_step(World& world, double dt, std::vector<BodyId>&) {
  const Slot s = world.slot_of(body_);
  if (s == no_slot) return;
  const Vec3 motion = servo_.beside_motion ? world.velocity[s] : Vec3(Vec3::Zero());
  const double time = world.clock + elapsed_;
  if (time < servo_.from || time >= servo_.until) {
    speed_ = missed_ = 0.0;
    world.velocity[s] = motion;
    return;
  }
  const double push = servo_.force + world.force[s].dot(servo_.direction);
  if (servo_.has_gains()) {
    const double missed = missed_ + dt * push, wanted = servo_.proportional * push + servo_.integral * missed;
    speed_ = std::clamp(wanted, -servo_.max_speed, servo_.max_speed);
    if (speed_ == wanted) missed_ = missed;
  } else {
    const double rate = servo_.force / (servo_.max_speed * servo_.mass);
    speed_ = (speed_ + dt * push / servo_.mass) / (1.0 + dt * rate);  // damping implicit
  }
  world.velocity[s] = servo_.beside_motion ? Vec3(motion + speed_ * servo_.direction) : Vec3(speed_ * servo_.direction);
}

void ServoWall::visit(StateVisitor& visitor) {
  const std::string name = "servo/" + std::to_string(static_cast<std::uint32_t>(body_));
  if (!visitor.has(name + "/speed")) return;
  visitor.value(name + "/speed", speed_);
  visitor.value(name + "/missed", missed_);
}

}  // namespace epafi
