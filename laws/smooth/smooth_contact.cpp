#include "laws/smooth/smooth_contact.h"

#include "engine/state/virial.h"

namespace epafi {

void VelocityChange::of(const World& world, Slot body, double time) {
  linear[body] = time * world.acceleration(body);
  if (!world.rotates()) return;
  angular[body] =
      world.is_movable(body) ? Vec3(time * world.apply_inverse_inertia(body, world.torque[body])) : Vec3(0, 0, 0);
}

void VelocityChange::predict(const World& world, double time) {
  if (!(time > 0.0)) return;
  resize(world);
  parallel_for(world.size(), [&](std::size_t s) { of(world, static_cast<Slot>(s), time); });
}

void VelocityChange::predict(const World& world, const ContactSet& contacts, TouchedBodies& touched, double time) {
  if (time > 0.0) resize(world);
  touched.build(contacts, world, [&](Slot s) {
    if (time > 0.0) of(world, s, time);
  });
}

Vec3 contact_virial(const World& world, const ContactSet& contacts) {
  const auto sums = order_free_sums<3>(contacts.size(), [&](std::size_t i) { return virial_term(world, contacts, i); });
  return {sums[0].sum, sums[1].sum, sums[2].sum};
}

}  // namespace epafi
