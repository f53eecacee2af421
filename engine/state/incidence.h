/// @file incidence.h  The contacts of each body, in canonical order, and sums over them.
/// Sums by body need no atomics: they are the same bits for every thread count (atomics were 2.5-9.7 times slower).
#pragma once
#include <span>
#include <vector>

#include "engine/state/contacts.h"
#include "engine/state/touched_bodies.h"

namespace epafi {

/// Contacts are sorted by A, so those of a body as A are a range; those as B are listed.
class Incidence {
 public:
  void build(const ContactSet& contacts, std::size_t bodies);
  /// f(contact, sign) for every contact of the body: sign +1 where it is A, -1 where it is B; first as A, then as B.
  template <class F>
  void for_each(Slot body, F&& f) const {
    for (std::uint32_t k = begin_a_[body]; k < begin_a_[body + 1]; ++k) f(k, 1.0);
    for (std::uint32_t k = begin_b_[body]; k < begin_b_[body + 1]; ++k) f(list_b_[k], -1.0);
  }
  std::size_t count(Slot body) const {
    return begin_a_[body + 1] - begin_a_[body] + begin_b_[body + 1] - begin_b_[body];
  }

 private:
  std::vector<std::uint32_t> begin_a_, begin_b_, list_b_;
};

/// Sums contact forces (and torques, where the world rotates) into world.force and world.torque.
void gather_forces(const ContactSet& contacts, const Incidence& incidence, World& world);
/// The same for these bodies only; written: by slot, 1 is set for each.
void gather_forces(const ContactSet& contacts, const TouchedBodies& bodies, World& world,
                   std::vector<std::uint8_t>& written);

}  // namespace epafi
