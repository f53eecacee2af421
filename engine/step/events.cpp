#include "engine/step/events.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/state/rotation.h"

namespace epafi {

namespace {

double active_time(const Motion& motion, double time) {
  return std::clamp(time, motion.from, motion.until) - motion.from;
}

/// Position under this motion of a point that is at x at its start.
Vec3 moved_point(const Motion& motion, const Vec3& start, double time) {
  const double t = active_time(motion, time);
  Vec3 x = start;
  if (motion.rotation_about) {
    const Vec3& axis = motion.rotation_axis;
    const Vec3 arm = start - *motion.rotation_about, along = axis * axis.dot(arm), across = arm - along;
    const SinCos turn = sin_cos(motion.rotation_rate * t);
    x = *motion.rotation_about + along + turn.cos * across + turn.sin * axis.cross(across);
  }
  const double phase = 2.0 * std::numbers::pi * motion.oscillation_frequency * t;
  x = x + t * motion.velocity + motion.oscillation_amplitude * sin_cos(phase).sin * motion.oscillation_direction;
  return motion.table ? Vec3(x + motion.table->displacement(t)) : x;
}

/// True if it moves nothing in this interval.
bool is_still(const Motion& motion, double now, double then) {
  const double first = active_time(motion, now), last = active_time(motion, then);
  if (first == last) return true;
  const bool only_table = motion.velocity.isZero(0.0) && motion.rotation_rate == 0.0 &&
                          (motion.oscillation_amplitude == 0.0 || motion.oscillation_frequency == 0.0);
  return only_table && motion.table && (last <= motion.table->begin() || first >= motion.table->end());
}

/// Angle of atan(x) for small x by its series; std::atan beyond, where no step of a stable simulation turns.
double angle_of_tangent(double x) {
  if (x > 0.05) return std::atan(x);
  const double square = x * x;
  return x * (1.0 - square * (1.0 / 3 - square * (1.0 / 5 - square * (1.0 / 7 - square * (1.0 / 9)))));
}

}  // namespace

Vec3 DriveBody::position_at(double time) const {
  Vec3 x = start_;
  for (const Motion& motion : motions_) x = moved_point(motion, x, time);
  return x;
}

/// From its orientation before all motions.
Quat DriveBody::turn_at(double time) const {
  Quat all(1, 0, 0, 0);
  for (const Motion& motion : motions_)
    if (motion.rotation_rate != 0.0)
      all = turned_far(all, motion.rotation_axis * (motion.rotation_rate * active_time(motion, time)));
  return all;
}

/// The constant angular velocity that leads from one orientation to the next [rad/s].
Vec3 DriveBody::spin(double time, double dt) const {
  const auto turns = std::ranges::count_if(motions_, [](const Motion& m) { return m.rotation_rate != 0.0; });
  if (turns <= 1) {
    const auto found = std::ranges::find_if(motions_, [](const Motion& m) { return m.rotation_rate != 0.0; });
    const Motion& one = found == motions_.end() ? motions_.front() : *found;
    const double active = active_time(one, time + dt) - active_time(one, time);
    return one.rotation_axis * (one.rotation_rate * (active / dt));
  }
  Quat step = turn_at(time + dt) * turn_at(time).conjugate();
  if (step.w() < 0.0) step.coeffs() *= -1.0;
  const double sine = step.vec().norm();
  if (sine == 0.0) return Vec3::Zero();
  return step.vec() * (2.0 * angle_of_tangent(sine / step.w()) / (sine * dt));
}

bool DriveBody::follows_table() const {
  return std::ranges::any_of(motions_, [](const Motion& m) { return m.table != nullptr; });
}

void DriveBody::before_step(World& world, double dt, std::vector<BodyId>&) {
  const Slot s = world.slot_of(body_);
  if (s == no_slot) return;
  const double time = world.clock + elapsed_;
  // a table is followed from the body's present position, so that rounding does not accumulate over millions of steps;
  // not along a periodic axis, where bodies are wrapped
  Vec3 from = position_at(time);
  for (int k = 0; k < 3 && alone_ && follows_table(); ++k)
    if (!world.cell || !world.cell->repeats[static_cast<std::size_t>(k)]) from[k] = world.position[s][k];
  world.velocity[s] = (position_at(time + dt) - from) / dt;
  if (world.rotates()) world.angular_velocity[s] = spin(time, dt);
}

/// True if it is at rest in this step and in the next one.
bool DriveBody::rests_next(const World& world, double dt) const {
  if (world.slot_of(body_) == no_slot) return true;
  const double now = world.clock + elapsed_;
  return std::ranges::all_of(motions_, [&](const Motion& m) { return is_still(m, now, now + 2.0 * dt); });
}

void DriveBody::visit(StateVisitor& visitor) {
  const std::string name = "drive/" + std::to_string(static_cast<std::uint32_t>(body_)) + "/start";
  if (visitor.has(name)) visitor.value(name, start_);
}

void RemoveBodies::before_step(World& world, double dt, std::vector<BodyId>& leaving) {
  // removed in the step that would pass the time, half a step before at most
  if (!is_due(world.clock + elapsed_, dt)) return;
  for (BodyId b : bodies_)
    if (world.slot_of(b) != no_slot) leaving.push_back(b);
}

bool RemoveBodies::rests_next(const World& world, double dt) const {
  return !is_due(world.clock + elapsed_ + dt, dt) ||
         std::ranges::all_of(bodies_, [&](BodyId b) { return world.slot_of(b) == no_slot; });
}

}  // namespace epafi
