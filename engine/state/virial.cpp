#include "engine/state/virial.h"

namespace epafi {

Virial& Virial::operator+=(const Virial& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    contacts[k] += other.contacts[k];
    spheres[k] += other.spheres[k];
    balls[k] += other.balls[k];
  }
  return *this;
}

Vec3 Virial::value() const {
  Vec3 all;
  for (std::size_t k = 0; k < 3; ++k)
    all[static_cast<int>(k)] = contacts[k].value() + (spheres[k].value() + balls[k].value());
  return all;
}

VirialSums virial_sums(const World& world, const ContactSet& contacts) {
  return order_free_totals<3>(contacts.size(), [&](std::size_t i) { return virial_term(world, contacts, i); });
}

}  // namespace epafi
