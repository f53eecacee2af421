#include "viz_export/contact_list.h"

#include "engine/parallel_order.h"

namespace epafi {

ContactList::ContactList(const World& world, const ContactSet& contacts) : world_(&world), contacts_(&contacts) {
  if (contacts.force.size() != contacts.size()) return;
  parallel_select(
      contacts.size(),
      [&](std::size_t i) { return contacts.gap[i] < 0.0 || contacts.force[i].squaredNorm() != 0.0; },
      [](std::size_t i) { return static_cast<std::uint32_t>(i); }, acting_);
}

Vec3 ContactList::from(std::size_t k) const {
  const std::size_t i = acting_[k];
  const Slot a = contacts_->a[i];
  return world_->is_movable(a) ? world_->position[a] : contacts_->point(i, *world_);
}

Vec3 ContactList::to(std::size_t k) const {
  const std::size_t i = acting_[k];
  const Slot a = contacts_->a[i], b = contacts_->b[i];
  if (!world_->is_movable(b)) return contacts_->point(i, *world_);
  return world_->position[a] + world_->branch(a, b, contacts_->feature[i]);
}

}  // namespace epafi
