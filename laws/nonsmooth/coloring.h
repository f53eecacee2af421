/// @file coloring.h  Groups of contacts between the same two bodies, coloured so that no free body occurs twice in a
/// colour. Greedy in the order of a hash of the pair's ids (Jones and Plassmann 1993): the colours are a function of
/// the pairs alone, not of the slots, so coloured Gauss-Seidel gives the same bits for every thread count and order of
/// the bodies. A pair depends only on the colours of earlier pairs at its bodies. In a random order the longest chain
/// of dependences, `rounds`, is short (24 for 24 000 pairs; 376 in canonical order), so pairs could be coloured in
/// parallel. Bodies that cannot move do not conflict. Limit: 63 colours; further groups (of a body with more
/// neighbours) form a last colour that runs in sequence.
#pragma once
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "engine/state/large_column.h"
#include "engine/state/types.h"

namespace epafi {

/// Contacts first .. first + count - 1 of the problem, all between a and b.
struct ContactGroup {
  Slot a, b;
  std::uint32_t first, count;
};

class Coloring {
 public:
  static constexpr std::size_t max_colors = 63;

  /// Colours the contacts i between bodies a[i] and b[i]; keeps what it has while the pairs of bodies are the same.
  /// Bodies, by slot: inverse_mass is 0 where one cannot move; id decides on the order, without any the slots do.
  struct Bodies {
    std::span<const double> inverse_mass;
    std::span<const BodyId> id{};
  };
  void update(std::span<const Slot> a, std::span<const Slot> b, const Bodies& bodies);
  /// Groups that have their colours, colour by colour: colour c has those from begin[c] on, none of them in sequence.
  void take(std::span<const ContactGroup> groups, std::vector<std::size_t> begin) {
    groups_.assign(groups.begin(), groups.end());
    begin_ = std::move(begin);
    has_overflow_ = false;
  }

  /// All groups, colour by colour.
  std::span<const ContactGroup> groups() const { return groups_; }
  /// Groups of colour c are groups()[begin(c)] .. groups()[begin(c + 1) - 1].
  std::size_t colors() const { return begin_.size() - 1; }
  std::size_t begin(std::size_t color) const { return begin_[color]; }
  /// Length of the longest chain of dependences between pairs.
  std::size_t rounds() const { return rounds_; }
  /// The groups of this colour may share bodies: run them in sequence.
  bool in_sequence(std::size_t color) const { return has_overflow_ && color + 1 == colors(); }

 private:
  /// Colours used so far at a body.
  struct AtBody {
    std::uint64_t used;  ///< colours, one bit each
    std::uint32_t rounds;
  };
  struct Hashed {
    std::uint64_t hash;
    Slot a, b;
    std::uint32_t group;
  };
  void find_groups(std::span<const Slot> a, std::span<const Slot> b);
  bool find_bodies(const Bodies& bodies);
  void sort_by_hash();
  void paint();
  std::size_t color_of(const Hashed& pair);

  UnwrittenStream<ContactGroup> canonical_, found_, groups_;
  std::vector<std::uint8_t> color_;
  std::vector<AtBody> at_;
  UnwrittenStream<Hashed> hashed_;    ///< all groups, by hash
  std::vector<std::uint32_t> place_;  ///< the same while hashed_ is written
  std::vector<std::size_t> begin_{0};
  std::vector<std::uint32_t> order_;  ///< the same while groups_ is written
  std::vector<char> free_, free_found_;
  std::vector<BodyId> id_, id_found_;  ///< by slot
  std::size_t rounds_ = 0;
  bool has_overflow_ = false;
};

}  // namespace epafi
