/// @file coloring.h  Groups of contacts between the same two bodies, coloured so that no free body occurs twice in a
/// colour. Greedy in canonical order (Welsh and Powell 1967 without the sort): the colours are a function of the
/// contact list alone, so coloured Gauss-Seidel gives the same bits for every thread count. Bodies that cannot move do
/// not conflict. Limit: 63 colours; a group that finds none (a body with more neighbours) goes to a last colour that
/// runs in sequence.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "engine/large_column.h"
#include "engine/types.h"

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
  /// inverse_mass: by body, 0 where it cannot move.
  void update(std::span<const Slot> a, std::span<const Slot> b, std::span<const double> inverse_mass);

  /// All groups, colour by colour.
  std::span<const ContactGroup> groups() const { return groups_; }
  /// Groups of colour c are groups()[begin(c)] .. groups()[begin(c + 1) - 1].
  std::size_t colors() const { return begin_.size() - 1; }
  std::size_t begin(std::size_t color) const { return begin_[color]; }
  /// The groups of this colour may share bodies: run them in sequence.
  bool in_sequence(std::size_t color) const { return has_overflow_ && color + 1 == colors(); }

 private:
  void paint();

  UnwrittenStream<ContactGroup> canonical_, found_, groups_;
  std::vector<std::uint8_t> color_;
  std::vector<std::uint64_t> used_;  ///< colours at each body, one bit each
  std::vector<std::size_t> begin_{0};
  std::vector<std::uint32_t> order_;  ///< the same while groups_ is written
  std::vector<char> free_, free_found_;
  bool has_overflow_ = false;
};

}  // namespace epafi
