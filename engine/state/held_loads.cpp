#include "engine/state/held_loads.h"

#include <algorithm>

namespace epafi {

Vec3 contact_torque(const ContactSet& contacts, std::size_t k, double sign, const World& world) {
  const Vec3 arm = sign > 0 ? contacts.arm[k] : contacts.arm_b(k, world);
  const Vec3 torque = sign * arm.cross(contacts.force[k]);
  return contacts.with_moment ? Vec3(torque + sign * contacts.moment[k]) : torque;
}

std::vector<HeldLoad> held_loads(const World& world, const ContactSet& contacts, std::span<const Slot> held,
                                 const std::function<bool(Slot, Slot)>& counts) {
  std::vector<std::array<std::vector<double>, 6>> terms(held.size());
  const auto add = [&](Slot s, std::size_t k, double sign) {
    if (world.is_movable(s)) return;
    const auto at = std::ranges::lower_bound(held, s);
    if (at == held.end() || *at != s) return;
    auto& of = terms[static_cast<std::size_t>(at - held.begin())];
    const Vec3 force = sign * contacts.force[k];
    const Vec3 torque = world.rotates() ? contact_torque(contacts, k, sign, world) : Vec3(Vec3::Zero());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      of[axis].push_back(force[static_cast<int>(axis)]);
      of[3 + axis].push_back(torque[static_cast<int>(axis)]);
    }
  };
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Slot a = contacts.a[k], b = contacts.b[k];
    if ((world.is_movable(a) && world.is_movable(b)) || !counts(a, b)) continue;
    add(a, k, 1.0);
    add(b, k, -1.0);
  }
  std::vector<HeldLoad> out(held.size());
  for (std::size_t h = 0; h < held.size(); ++h)
    for (std::size_t c = 0; c < 6; ++c) out[h].sums[c].add(terms[h][c]);
  return out;
}

}  // namespace epafi
