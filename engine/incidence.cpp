#include "engine/incidence.h"

#include "engine/parallel_order.h"

namespace epafi {

void Incidence::build(const ContactSet& contacts, std::size_t bodies) {
  const std::size_t n = contacts.size();
  begin_a_.resize(bodies + 1);
  parallel_for(n + 1, [&](std::size_t k) {  // begins the ranges of all bodies behind the A of the one before
    const std::size_t first = k > 0 ? std::size_t{contacts.a[k - 1]} + 1 : 0, last = k < n ? contacts.a[k] : bodies;
    for (std::size_t s = first; s <= last; ++s) begin_a_[s] = static_cast<std::uint32_t>(k);
  });
  const auto each = [&](std::size_t first, std::size_t last, const auto& f) {
    for (std::size_t k = first; k < last; ++k) f(contacts.b[k], static_cast<std::uint32_t>(k));
  };
  parallel_group(
      n, bodies, begin_b_, each, [&](std::size_t count) { list_b_.resize(count); },
      [&](std::uint32_t place, std::uint32_t k) { list_b_[place] = k; });
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
  const auto side = [&](std::size_t i) { return i % 2 == 0 ? contacts.a[i / 2] : contacts.b[i / 2]; };
  const auto is_first = [&](std::size_t i) {
    const auto k = static_cast<std::uint32_t>(i / 2);
    return i % 2 == 0 ? incidence.is_first(side(i), k) : incidence.is_first_as_b(side(i), k);
  };
  parallel_select(2 * contacts.size(), is_first, side, bodies);
}

}  // namespace epafi
