#include "engine/incidence.h"

#include "engine/parallel.h"

namespace epafi {

void Incidence::build(const ContactSet& contacts, std::size_t bodies) {
  begin_a_.assign(bodies + 1, 0), begin_b_.assign(bodies + 1, 0);
  for (std::size_t k = 0; k < contacts.size(); ++k) ++begin_a_[contacts.a[k] + 1], ++begin_b_[contacts.b[k] + 1];
  for (std::size_t s = 0; s < bodies; ++s) begin_a_[s + 1] += begin_a_[s], begin_b_[s + 1] += begin_b_[s];
  list_b_.resize(contacts.size());
  for (std::uint32_t k = 0; k < contacts.size(); ++k) list_b_[begin_b_[contacts.b[k]]++] = k;
  for (std::size_t s = bodies; s > 0; --s) begin_b_[s] = begin_b_[s - 1];  // the fill moved every start to its end
  begin_b_[0] = 0;
}

namespace {

void gather(const ContactSet& contacts, const Incidence& incidence, Slot s, World& world) {
  const bool rotates = world.rotates();
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  if (world.is_movable(s) || world.columns().held_force) {
    incidence.for_each(s, [&](std::uint32_t k, double sign) {
      force += sign * contacts.force[k];
      if (!rotates) return;
      const Vec3 arm = sign > 0 ? contacts.arm[k] : contacts.arm_b(k, world);
      torque += sign * arm.cross(contacts.force[k]);
      if (contacts.with_moment) torque += sign * contacts.moment[k];
    });
  }
  world.force[s] = force;
  if (rotates) world.torque[s] = torque;
}

}  // namespace

void gather_forces(const ContactSet& contacts, const Incidence& incidence, World& world) {
  parallel_for(world.size(), [&](std::size_t s) { gather(contacts, incidence, static_cast<Slot>(s), world); });
}

void gather_forces(const ContactSet& contacts, const Incidence& incidence, std::span<const Slot> bodies, World& world) {
  parallel_for(bodies.size(), [&](std::size_t i) { gather(contacts, incidence, bodies[i], world); });
}

void bodies_of(const ContactSet& contacts, const Incidence& incidence, std::vector<Slot>& bodies) {
  bodies.clear();
  for (std::uint32_t k = 0; k < contacts.size(); ++k) {
    if (incidence.is_first(contacts.a[k], k)) bodies.push_back(contacts.a[k]);
    if (incidence.is_first_as_b(contacts.b[k], k)) bodies.push_back(contacts.b[k]);
  }
}

}  // namespace epafi
