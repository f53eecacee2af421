#include "engine/events.h"

#include <algorithm>
#include <numbers>

#include "engine/rotation.h"

namespace epafi {

double DriveBody::active_time(double time) const {
  return std::clamp(time, motion_.from, motion_.until) - motion_.from;
}

Vec3 DriveBody::position_at(double time) const {
  const double t = active_time(time);
  Vec3 x = start_;
  if (motion_.rotation_about) {
    const Vec3& axis = motion_.rotation_axis;
    const Vec3 arm = start_ - *motion_.rotation_about, along = axis * axis.dot(arm), across = arm - along;
    const SinCos turn = sin_cos(motion_.rotation_rate * t);
    x = *motion_.rotation_about + along + turn.cos * across + turn.sin * axis.cross(across);
  }
  const double phase = 2.0 * std::numbers::pi * motion_.oscillation_frequency * t;
  return x + t * motion_.velocity + motion_.oscillation_amplitude * sin_cos(phase).sin * motion_.oscillation_direction;
}

void DriveBody::before_step(World& world, double dt, std::vector<BodyId>&) {
  const Slot s = world.slot_of(body_);
  if (s == no_slot) return;
  world.velocity[s] = (position_at(world.time + dt) - position_at(world.time)) / dt;
  if (!world.rotates()) return;
  const double active = active_time(world.time + dt) - active_time(world.time);
  world.angular_velocity[s] = motion_.rotation_axis * (motion_.rotation_rate * (active / dt));
}

/// It stands still in this step and in the next one.
bool DriveBody::rests_next(const World& world, double dt) const {
  const double now = active_time(world.time), next = world.time + dt;
  return world.slot_of(body_) == no_slot || (active_time(next) == now && active_time(next + dt) == now);
}

void RemoveBodies::before_step(World& world, double dt, std::vector<BodyId>& leaving) {
  // removed in the step that would pass the time, half a step before at most
  if (!is_due(world.time, dt)) return;
  for (BodyId b : bodies_)
    if (world.slot_of(b) != no_slot) leaving.push_back(b);
}

bool RemoveBodies::rests_next(const World& world, double dt) const {
  return !is_due(world.time + dt, dt) ||
         std::ranges::all_of(bodies_, [&](BodyId b) { return world.slot_of(b) == no_slot; });
}

}  // namespace epafi
