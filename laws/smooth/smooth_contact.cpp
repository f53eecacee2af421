#include "laws/smooth/smooth_contact.h"

namespace epafi {

void VelocityChange::predict(const World& world, const std::vector<Slot>* some, double time) {
  linear.resize(world.size());
  if (world.rotates()) angular.resize(world.size());
  parallel_for(some ? some->size() : world.size(), [&](std::size_t i) {
    const Slot s = some ? (*some)[i] : static_cast<Slot>(i);
    linear[s] = time * world.acceleration(s);
    if (!world.rotates()) return;
    angular[s] = world.is_movable(s) ? Vec3(time * world.apply_inverse_inertia(s, world.torque[s])) : Vec3(0, 0, 0);
  });
}

}  // namespace epafi
