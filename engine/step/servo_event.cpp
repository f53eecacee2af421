#include "engine/step/servo_event.h"

#include <algorithm>
#include <string>
#include <utility>

namespace epafi {

/// push: F - F_contact [N].
double ServoEvent::next_speed(double push, double dt) {
  if (!servo_.has_gains()) {
    const double rate = servo_.force / (servo_.max_speed * servo_.mass);
    return (speed_ + dt * push / servo_.mass) / (1.0 + dt * rate);  // damping implicit
  }
  const double missed = missed_ + dt * push, wanted = servo_.proportional * push + servo_.integral * missed;
  const double speed = std::clamp(wanted, -servo_.max_speed, servo_.max_speed);
  if (speed == wanted) missed_ = missed;
  return speed;
}

void ServoEvent::before_step(World& world, double dt, std::vector<BodyId>&) {
  const Slot s = world.slot_of(body_);
  if (s == no_slot) return;
  const Vec3 motion = servo_.beside_motion ? world.velocity[s] : Vec3(Vec3::Zero());
  const double time = world.clock + elapsed_, pushed_back = world.force[s].dot(servo_.direction);
  const bool presses = time >= servo_.from && time < servo_.until;
  const double before = std::exchange(speed_, presses ? next_speed(servo_.force + pushed_back, dt) : 0.0);
  if (!presses) missed_ = 0.0;
  const double rise = presses && !servo_.has_gains() ? 0.5 * (speed_ - before) : 0.0;  // from the middle to the end
  const double ahead = std::exchange(ahead_, 0.5 * dt * rise);
  ledger_.add_work(pushed_back * (ahead + ahead_));  // the force of the detection acts over half a step on both sides
  world.velocity[s] = motion + (speed_ + rise) * servo_.direction;
  world.position[s] -= dt * rise * servo_.direction;
}

void ServoEvent::visit(StateVisitor& visitor) {
  const std::string name = "servo/" + std::to_string(static_cast<std::uint32_t>(body_));
  if (!visitor.has(name + "/speed")) return;
  visitor.value(name + "/speed", speed_);
  visitor.value(name + "/missed", missed_);
  if (visitor.has(name + "/ahead")) visitor.value(name + "/ahead", ahead_);
}

}  // namespace epafi
