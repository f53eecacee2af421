#include "laws/smooth/smooth_contact.h"

namespace epafi {

void VelocityChange::predict(const World& world, const ContactSet& contacts, double time) {
  linear.resize(world.size());
  if (world.rotates()) angular.resize(world.size());
  const auto predict_one = [&](Slot s) {
    linear[s] = time * world.acceleration(s);
    if (!world.rotates()) return;
    angular[s] = world.is_movable(s) ? Vec3(time * world.apply_inverse_inertia(s, world.torque[s])) : Vec3(0, 0, 0);
  };
  if (4 * contacts.size() >= world.size())
    return parallel_for(world.size(), [&](std::size_t s) { predict_one(static_cast<Slot>(s)); });
  for (std::size_t k = 0; k < contacts.size(); ++k) {  // few contacts, of which a fixed body has most
    if (k == 0 || contacts.a[k] != contacts.a[k - 1]) predict_one(contacts.a[k]);
    if (k == 0 || contacts.b[k] != contacts.b[k - 1]) predict_one(contacts.b[k]);
  }
}

}  // namespace epafi
