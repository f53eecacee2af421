#include "laws/smooth/smooth_contact.h"

namespace epafi {

void VelocityChange::predict(const World& world, double time) {
  linear.resize(world.size());
  if (world.rotates()) angular.resize(world.size());
  parallel_for(world.size(), [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    linear[s] = time * world.acceleration(s);
    if (!world.rotates()) return;
    angular[s] = world.is_movable(s) ? Vec3(time * world.apply_inverse_inertia(s, world.torque[s])) : Vec3(0, 0, 0);
  });
}

void SpringMemory::advance(const ContactSet& contacts, std::size_t springs_per_contact) {
  per_contact_ = springs_per_contact;
  keys_.match(contacts, previous_);
  old_.swap(now_);
  now_.resize(contacts.size() * per_contact_);
}

double SpringMemory::energy() const {
  double sum = 0.0;
  for (const Spring& s : now_) sum += s.energy();
  return sum;
}

void SpringMemory::reorder(const Reordering& change) {
  const auto order = keys_.reorder(change);
  std::vector<Spring> sorted;
  sorted.reserve(order.size() * per_contact_);
  for (std::uint32_t k : order)
    for (std::size_t j = 0; j < per_contact_; ++j) sorted.push_back(now_[k * per_contact_ + j]);
  now_.swap(sorted);
}

void SpringMemory::visit(StateVisitor& visitor) {
  keys_.visit(visitor, "smooth/contact");
  visitor.column("smooth/spring", now_);
}

}  // namespace epafi
