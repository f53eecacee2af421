#include "engine/state/touched_bodies.h"

#include "engine/threads/parallel_order.h"

namespace epafi {

void TouchedBodies::group(const ContactSet& contacts, const World& world) {
  blocks_ = (world.size() + block_size - 1) / block_size;
  const bool held = world.columns().held_force;
  // A mesh with all of its contacts is one entry. Bodies are read last: they may be in another thread's cache.
  const auto counts = [&](const auto& side, std::size_t k) {
    return k == 0 || side[k - 1] != side[k] || held || world.is_movable(side[k]);
  };
  const auto each = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t k = begin; k < end; ++k) {
      const Slot a = contacts.a[k], b = contacts.b[k];
      if (counts(contacts.a, k)) f(a / block_size, Entry(a, false, k));
      if (counts(contacts.b, k)) f(b / block_size, Entry(b, true, k));
    }
  };
  parallel_group(
      contacts.size(), blocks_, begin_, each, [&](std::size_t count) { entries_.resize(count); },
      [&](std::uint32_t place, const Entry& e) { entries_[place] = e; }, 1024);
}

void TouchedBodies::sort(std::size_t b) {
  const std::span<Entry> all = block(b);
  if (!std::ranges::is_sorted(all)) std::ranges::sort(all);
}

}  // namespace epafi
