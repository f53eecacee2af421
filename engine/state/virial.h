/// @file virial.h  The virial of a periodic cell, of contacts that a process counts: sums of parts that several
/// processes add up to the bits of one. A cell that keeps a pressure follows it.
#pragma once
#include <array>

#include "engine/state/contacts.h"
#include "engine/threads/order_free_sum.h"

namespace epafi {

/// Force on A times branch from A to B, by axis [N m].
using VirialSums = std::array<OrderFreeSum, 3>;

/// Parts of the virial, each summed and rounded separately.
struct Virial {
  VirialSums contacts;        ///< in the set
  VirialSums spheres, balls;  ///< of contacts that the contact model finds itself: by places, and by balls of bodies

  Virial& operator+=(const Virial& other);
  Vec3 value() const;
};

/// Virial of contact i; 0 where another process counts it.
inline std::array<double, 3> virial_term(const World& world, const ContactSet& contacts, std::size_t i) {
  if (!world.counts(contacts.a[i], contacts.b[i])) return {};
  const Vec3 branch = world.branch(contacts.a[i], contacts.b[i], contacts.feature[i]);
  const Vec3 term = contacts.force[i].cwiseProduct(branch);
  return {term.x(), term.y(), term.z()};
}
/// Virial of the contacts of a set that this process counts.
VirialSums virial_sums(const World& world, const ContactSet& contacts);

}  // namespace epafi
