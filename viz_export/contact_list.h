/// @file contact_list.h  Contacts as frames show them: those that touch or carry force, in canonical order.
#pragma once
#include <algorithm>
#include <cstdint>

#include "engine/contacts.h"

namespace epafi {

/// Each value is fetched when it is asked for: written out they took 104 bytes a contact, and half the time of a frame.
class ContactList {
 public:
  ContactList() = default;
  /// None where nobody has evaluated forces yet.
  ContactList(const World& world, const ContactSet& contacts);
  std::size_t size() const { return acting_.size(); }

  std::uint32_t id_a(std::size_t k) const { return static_cast<std::uint32_t>(world_->id[contacts_->a[acting_[k]]]); }
  std::uint32_t id_b(std::size_t k) const { return static_cast<std::uint32_t>(world_->id[contacts_->b[acting_[k]]]); }
  /// Centre of A [m]; the contact point in place of a wall's centre.
  Vec3 from(std::size_t k) const;
  Vec3 to(std::size_t k) const;  ///< the same of B, of the image that is touched
  const Vec3& force(std::size_t k) const { return contacts_->force[acting_[k]]; }  ///< on A [N]
  /// > 0 pushes the bodies apart [N].
  double normal_force(std::size_t k) const { return -force(k).dot(contacts_->normal[acting_[k]]); }
  double overlap(std::size_t k) const { return std::max(0.0, -contacts_->gap[acting_[k]]); }  ///< [m], >= 0

 private:
  const World* world_ = nullptr;
  const ContactSet* contacts_ = nullptr;
  UnwrittenColumn<std::uint32_t> acting_;  ///< places among the contacts
};

}  // namespace epafi
