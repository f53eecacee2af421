/// @file lane_groups.h  The pairs of a colour (coloring.h) in groups of four, for sweeps over four contacts at a time
/// (lane_sweep.h). Each thread has the same part of every colour, so that it accesses the same bodies.
#pragma once
#include <array>
#include <functional>
#include <span>

#include "engine/lanes/lanes.h"
#include "engine/state/large_column.h"
#include "engine/threads/parallel.h"
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
  static constexpr std::size_t grain = 16;  ///< 1.5 us of a sweep over stones

  /// Four pairs of as many points, so that few lanes stay empty; one pair in a colour that runs in sequence. none: the
  /// body of empty lanes.
  void form(const Coloring& coloring, Slot none);

  std::size_t size() const { return groups_.size(); }
  const LaneGroup* data() const { return groups_.data(); }
  std::size_t rows() const { return groups_.empty() ? 0 : groups_.back().end; }
  /// Number of stages, which run one after the other: a stage is a colour that threads share, or several small colours
  /// and the sequential one, run by one thread. (8 large spheres among 8000 small ones: 60 of 64 colours have one
  /// group. On two threads the contacts of a step take 0.93 ms with such stages, 2.0 ms without.)
  std::size_t stages() const { return is_shared_.size(); }
  /// Groups of stage s are data()[begin(s)] .. data()[begin(s + 1) - 1].
  std::size_t begin(std::size_t stage) const { return begin_[stage]; }
  std::size_t size(std::size_t stage) const { return begin_[stage + 1] - begin_[stage]; }
  /// Groups of colour c are data()[color_begin(c)] .. data()[color_begin(c + 1) - 1].
  std::size_t color_begin(std::size_t color) const { return color_begin_[color]; }
  /// Number of groups of a stage that a thread takes at once.
  std::size_t piece(std::size_t stage) const { return is_shared_[stage] ? grain : size(stage); }
  /// Groups in stages that threads share.
  std::size_t shared() const { return shared_; }
  /// f(group) for all; `pays`: each by the thread that has its rows in the sweeps.
  void each(bool pays, const std::function<void(const LaneGroup&)>& f) const;

 private:
  void find_stages(const Coloring& coloring);
  void form_color(const Coloring& coloring, std::size_t color, Slot none);

  UnwrittenColumn<LaneGroup> groups_;
  std::vector<std::size_t> color_begin_, begin_;  ///< of each colour, of each stage in groups_
  std::vector<char> is_shared_;                   ///< by stage
  std::size_t shared_ = 0;
  std::vector<std::uint32_t> row_end_;  ///< by group
};

}  // namespace epafi
