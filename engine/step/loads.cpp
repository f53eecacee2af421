#include "engine/step/loads.h"

#include "engine/threads/parallel.h"

namespace epafi {

namespace {

/// True if this process counts its work: the owner does.
bool is_own(const World& world, Slot s) {
  return world.is_movable(s) && (world.owner.empty() || world.owner[s] == World::here);
}

Vec3 first_moment(const World& world) {
  const auto sum = block_sum<Sum3>(world.size(), [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    if (!is_own(world, s)) return Sum3{};
    const Vec3 m = world.unwrapped(s) / world.inverse_mass[s];
    return Sum3{m.x(), m.y(), m.z()};
  });
  return {sum.a, sum.b, sum.c};
}

}  // namespace

void Loads::set(World& world, double clock) const {
  if (gravity_.loose) {
    world.loose_gravity = gravity_.loose(clock + gravity_.elapsed);
    world.gravity = gravity_.steady + world.loose_gravity;
  }
  for (const BodyLoad& load : bodies_) {
    const Slot s = world.slot_of(load.body);
    if (s == no_slot || !world.is_movable(s) || !load.force) continue;
    world.loose_force[s] = load.force(clock + load.elapsed);
    world.external_force[s] = load.steady + world.loose_force[s];
  }
  turn(world, clock);
}

void Loads::turn(World& world, double clock) const {
  if (!world.columns().external_torque) return;
  for (const BodyLoad& load : bodies_) {
    const Slot s = world.slot_of(load.body);
    if (s != no_slot && world.is_movable(s) && load.torque)
      world.external_torque[s] = load.torque(clock + load.elapsed);
  }
}

/// Half a kick of all torques; its work is exact: J.(w + w')/2.
void Loads::kick(World& world, double dt) {
  for (const BodyLoad& load : bodies_) {
    const Slot s = world.slot_of(load.body);
    if (s == no_slot || !world.is_movable(s) || !load.torque) continue;
    const Vec3 impulse = 0.5 * dt * world.external_torque[s], before = world.angular_velocity[s];
    world.apply_angular_impulse(s, impulse);
    if (is_own(world, s)) kick_work_ += 0.5 * impulse.dot(before + world.angular_velocity[s]);
  }
}

void Loads::before_step(World& world, double dt) {
  kick_work_ = 0.0;
  set(world, world.clock + 0.5 * dt);
  if (kicks_ && world.columns().external_torque) {
    turn(world, world.clock);
    kick(world, dt);
  }
  if (gravity_.loose) moment_ = first_moment(world);
  place_.resize(bodies_.size());
  spin_.resize(bodies_.size());
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Slot s = world.slot_of(bodies_[k].body);
    if (s == no_slot) continue;
    place_[k] = world.unwrapped(s);
    if (world.rotates()) spin_[k] = world.angular_velocity[s];
  }
}

double Loads::after_step(World& world, double dt) {
  double work = 0.0;
  if (gravity_.loose) work += world.loose_gravity.dot(first_moment(world) - moment_);
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Slot s = world.slot_of(bodies_[k].body);
    if (s == no_slot || !is_own(world, s)) continue;
    if (bodies_[k].force) work += world.loose_force[s].dot(world.unwrapped(s) - place_[k]);
    if (bodies_[k].torque && !kicks_)
      work += 0.5 * dt * world.external_torque[s].dot(spin_[k] + world.angular_velocity[s]);
  }
  if (kicks_ && world.columns().external_torque) {
    turn(world, world.clock);
    kick(world, dt);
  }
  return work + kick_work_;
}

}  // namespace epafi
