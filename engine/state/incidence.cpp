#include "engine/state/incidence.h"

#include "engine/state/held_loads.h"
#include "engine/threads/parallel_order.h"

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

/// Vectors whose sum does not depend on their order.
class OrderFreeVectors {
 public:
  void clear() {
    for (std::vector<double>& terms : terms_) terms.clear();
  }
  void add(const Vec3& x) {
    for (std::size_t k = 0; k < 3; ++k) terms_[k].push_back(x[static_cast<int>(k)]);
  }
  Vec3 sum() const { return {sum_of(terms_[0]), sum_of(terms_[1]), sum_of(terms_[2])}; }

 private:
  static double sum_of(const std::vector<double>& terms) {
    OrderFreeSum total;
    total.add(terms);
    return value_of(total, terms.size(), [&](std::size_t i) { return terms[i]; });
  }
  std::array<std::vector<double>, 3> terms_;
};

/// A wall may touch bodies of all processes, and the sum moves a servo wall.
template <class Each>
void gather_held(const ContactSet& contacts, Slot s, World& world, const Each& each) {
  thread_local OrderFreeVectors forces, torques;
  forces.clear();
  torques.clear();
  each([&](std::uint32_t k, double sign) {
    forces.add(sign * contacts.force[k]);
    if (world.rotates()) torques.add(contact_torque(contacts, k, sign, world));
  });
  world.force[s] = forces.sum();
  if (world.rotates()) world.torque[s] = torques.sum();
}

/// each(f): f(contact, sign) for every contact of body s.
template <class Each>
void gather(const ContactSet& contacts, Slot s, World& world, const Each& each) {
  if (!world.is_movable(s) && world.columns().held_force) return gather_held(contacts, s, world, each);
  const bool rotates = world.rotates();
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
  if (world.is_movable(s)) {
    each([&](std::uint32_t k, double sign) {
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
  parallel_for(world.size(), [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    gather(contacts, s, world, [&](const auto& f) { incidence.for_each(s, f); });
  });
}

void gather_forces(const ContactSet& contacts, const TouchedBodies& bodies, World& world,
                   std::vector<std::uint8_t>& written) {
  bodies.each([&](Slot s, std::span<const TouchedBodies::Entry> entries) {
    gather(contacts, s, world, [&](const auto& f) {
      for (const TouchedBodies::Entry& e : entries) f(e.contact(), e.sign());
    });
    written[s] = 1;
  });
}

}  // namespace epafi
