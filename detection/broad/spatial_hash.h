/// @file spatial_hash.h  Bodies sorted into uniform cells, one grid per size class (Ericson 2005, ch. 7; Mirtich 1996
/// for levels). Each class spans a factor of two in size. A body searches its own class and the larger ones, so a dust
/// grain beside a boulder costs a few look-ups. The cell table is an array, no hash map: where the bodies are too
/// sparse for a dense array, the grid is folded (cell index modulo a power of two) and the aliases fall to the test.
/// Balls are tested as floats, and in full where the rounding of these leaves doubt: the list is that of the full test.
/// Fails (slow, still right) where most bodies overlap each other.
#pragma once
#include <algorithm>
#include <array>

#include "detection/broad/broad_phase.h"

namespace epafi {

class SpatialHash final : public ListBroadPhase {
 public:
  using ListBroadPhase::ListBroadPhase;
  const char* name() const override { return "spatial-hash"; }

 private:
  /// One axis of one grid.
  struct Axis {
    double origin = 0.0, inverse_cell = 1.0, last = 0.0;  ///< last: largest cell index before folding
    std::int64_t mask = 0;                                ///< cells after folding, minus 1
    // not negative after the clamp, so truncation is floor; NaN never comes here
    std::int64_t cell(double x) const {
      return static_cast<std::int64_t>(std::clamp((x - origin) * inverse_cell, 0.0, last));
    }
    /// In cells; beyond 1e30 no two bodies are near.
    float place(double x) const { return static_cast<float>(std::clamp((x - origin) * inverse_cell, -1e30, 1e30)); }
  };
  /// One size class.
  struct Level {
    std::array<Axis, 3> axis;
    double half = 0.0;                   ///< largest half size in the class, with room for rounding [m]
    float doubt = 0.0f;                  ///< by how much distances of floats may be off, in cells
    std::uint32_t first = 0, count = 0;  ///< its bodies in the sorted columns
    std::size_t table = 0;               ///< its first entry in start_
  };
  static constexpr std::size_t most_levels = 20;

  std::array<Level, most_levels> level_{};
  std::size_t levels_ = 0, cells_ = 0;      ///< cells of all levels
  UnwrittenColumn<std::uint8_t> level_of_;  ///< by position in bodies.ordinary
  UnwrittenColumn<std::uint32_t> cell_of_;
  std::vector<std::uint32_t> start_;  ///< [table + cell]: first body of the cell in the sorted columns
  /// Fat balls [cells of their level], sorted by level and cell, as is slot_: all x, then all y, z, r. In one column,
  /// which fills large pages where those of 400 000 bodies alone do not.
  UnwrittenColumn<float> sorted_;
  std::size_t stride_ = 0;  ///< from x to y
  UnwrittenColumn<Slot> slot_;
  std::vector<std::vector<Slot>> found_;  ///< candidates, one column per block
  struct Block;

  void collect(const FatBodies& bodies, PairCollector& collector) override;
  void set_levels(const FatBodies& bodies);
  void set_grid(Level& level, const Vec3& low, const Vec3& high);
  void sort_bodies(const FatBodies& bodies);
  /// Appends the bodies of the level whose fat balls meet this one behind found[count], of those from `first` on in the
  /// sorted columns. Returns the new count: `found` only grows.
  template <int n>
  std::size_t search(const Level& level, const Ball& ball, double half, std::uint32_t first, const FatBodies& bodies,
                     std::vector<Slot>& found, std::size_t count) const;
  /// Level of a row of the sorted columns.
  std::size_t level_at(std::size_t place) const {
    std::size_t l = 0;
    while (l + 1 < levels_ && place >= level_[l + 1].first) ++l;
    return l;
  }
};

}  // namespace epafi
