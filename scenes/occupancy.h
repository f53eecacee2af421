/// @file occupancy.h  Bounding balls of placed bodies, to find free positions for others. One grid per factor of two in
/// size; in a periodic cell every ball stands with those of its images that reach into it.
#pragma once
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "engine/state/periodic_cell.h"

namespace epafi {

class Occupancy {
 public:
  explicit Occupancy(std::optional<PeriodicCell> cell = {}) : cell_(std::move(cell)) {}
  /// True if no ball, nor an image of one, overlaps the ball at x [m].
  bool is_free(const Vec3& x, double radius) const;
  void add(const Vec3& x, double radius);
  bool empty() const { return levels_.empty(); }

 private:
  using Ball = std::pair<Vec3, double>;
  struct Level {
    double cell = 0.0;  ///< edge: the largest diameter of the level [m]
    std::vector<Ball> all;
    std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> in;  ///< by cell: places in `all`
  };
  void put(const Vec3& x, double radius);
  static bool is_free_of(const Level& level, const Vec3& x, double radius);

  std::optional<PeriodicCell> cell_;
  std::map<int, Level> levels_;  ///< by the exponent of the radius
};

}  // namespace epafi
