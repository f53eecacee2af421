/// @file touched_bodies.h  The bodies that have contacts, each with its contacts; for scenes in which few bodies do.
/// Blocks of slots go to the same threads as in all other loops over such blocks, so the data of a body stay in the
/// cache of one processor.
#pragma once
#include <algorithm>
#include <span>
#include <vector>

#include "engine/state/contacts.h"
#include "engine/state/world.h"
#include "engine/threads/parallel.h"

namespace epafi {

class TouchedBodies {
 public:
  static constexpr std::size_t block_size = 1024;

  /// A contact of a body; sorted by body, those with it as A before those as B, then in canonical order.
  class Entry {
   public:
    Entry() = default;
    Entry(Slot body, bool as_b, std::size_t contact)
        : key_(std::uint64_t{body} << 32 | std::uint64_t{as_b} << 31 | contact) {}
    Slot body() const { return static_cast<Slot>(key_ >> 32); }
    double sign() const { return (key_ >> 31 & 1) == 0 ? 1.0 : -1.0; }  ///< of the contact's force on the body
    std::uint32_t contact() const { return static_cast<std::uint32_t>(key_ & 0x7fffffff); }
    auto operator<=>(const Entry&) const = default;

   private:
    std::uint64_t key_;
  };

  /// f(body) for each, on all threads. Contacts of bodies that need no force (fixed, not measured) may be missing.
  template <class F>
  void build(const ContactSet& contacts, const World& world, const F& f) {
    group(contacts, world);
    parallel_blocks(blocks(), 1, [&](std::size_t b, std::size_t, std::size_t) {
      sort(b);
      each_of(b, [&](Slot s, std::span<const Entry>) { f(s); });
    });
  }
  /// f(body, its contacts) for each by all threads.
  template <class F>
  void each(const F& f) const {
    parallel_blocks(blocks(), 1, [&](std::size_t b, std::size_t, std::size_t) { each_of(b, f); });
  }

 private:
  std::size_t blocks() const { return blocks_; }
  std::span<Entry> block(std::size_t b) { return std::span(entries_).subspan(begin_[b], begin_[b + 1] - begin_[b]); }
  void group(const ContactSet& contacts, const World& world);
  void sort(std::size_t b);
  template <class F>
  void each_of(std::size_t b, const F& f) const {
    const Entry *first = entries_.data() + begin_[b], *const end = entries_.data() + begin_[b + 1];
    while (first != end) {
      const Slot body = first->body();
      const Entry* const last = std::find_if(first, end, [body](const Entry& e) { return e.body() != body; });
      f(body, std::span(first, last));
      first = last;
    }
  }

  std::size_t blocks_ = 0;
  std::vector<std::uint32_t> begin_;  ///< of each block
  std::vector<Entry> entries_;
};

}  // namespace epafi
