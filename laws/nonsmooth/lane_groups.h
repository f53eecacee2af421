/// @file lane_groups.h  The pairs of a colour (coloring.h) in groups of four, for sweeps over four contacts at a time
/// (lane_sweep.h), and which thread has which: the same part of every colour, so that it meets the same bodies.
#pragma once
#include <array>
#include <span>

#include "engine/lanes.h"
#include "engine/large_column.h"
#include "engine/parallel.h"
#include "laws/nonsmooth/coloring.h"

namespace epafi {

/// Up to four pairs without a free body in common. An empty lane has the body `none` twice and no contacts.
struct LaneGroup {
  std::array<Slot, lane_count> a, b;
  std::uint32_t begin, end;                            ///< rows: contacts of all lanes side by side
  std::array<std::uint32_t, lane_count> first, count;  ///< contacts of row `begin`, and how many
};

class LaneGroups {
 public:
  static constexpr std::size_t grain = 16;  ///< some 5 us of a sweep, a fork costs 2 us

  /// Four pairs of as many points, so that few lanes stay empty; one pair in a colour that runs in sequence. none: the
  /// body of empty lanes.
  void form(const Coloring& coloring, Slot none);

  std::size_t size() const { return groups_.size(); }
  const LaneGroup* data() const { return groups_.data(); }
  std::size_t rows() const { return groups_.empty() ? 0 : groups_.back().end; }
  std::size_t colors() const { return begin_.size() - 1; }
  /// Groups of colour c are data()[begin(c)] .. data()[begin(c + 1) - 1].
  std::size_t begin(std::size_t color) const { return begin_[color]; }
  std::size_t size(std::size_t color) const { return begin_[color + 1] - begin_[color]; }
  /// How many groups of a colour a thread takes at once.
  std::size_t piece(std::size_t color) const {
    return has_sequence_ && color + 1 == colors() ? std::max<std::size_t>(1, size(color)) : grain;
  }
  /// f(group) for all, each by the thread that has its rows in the sweeps.
  template <class F>
  void each(const F& f) const;

 private:
  void form_color(const Coloring& coloring, std::size_t color, Slot none);

  UnwrittenColumn<LaneGroup> groups_;
  std::vector<std::size_t> begin_{0};   ///< of each colour in groups_
  std::vector<std::uint32_t> row_end_;  ///< by group
  bool has_sequence_ = false;           ///< the last colour runs in sequence
};

template <class F>
void LaneGroups::each(const F& f) const {
  const bool pays = groups_.size() >= 2 * grain;
  const SharedOut meter(pays);
  const std::size_t threads = pays ? static_cast<std::size_t>(thread_count()) : 1;
  parallel_blocks(threads, 1, [&](std::size_t t, std::size_t, std::size_t) {
    for (std::size_t c = 0; c < colors(); ++c) {
      const std::size_t pieces = (size(c) + piece(c) - 1) / piece(c);
      const auto place = [&](std::size_t run) {
        return begin_[c] + std::min(size(c), pieces * run / threads * piece(c));
      };
      for (std::size_t g = place(t); g < place(t + 1); ++g) f(groups_[g]);
    }
  });
}

}  // namespace epafi
