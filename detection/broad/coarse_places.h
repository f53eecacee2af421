/// @file coarse_places.h  Where many bodies were, for asking how far they have come since: 12 bytes each where
/// positions take 24 and balls 32. Floats from the first body of each 64, which are neighbours where slots follow a
/// Morton curve.
#pragma once
#include <algorithm>
#include <cstddef>
#include <vector>

#include "engine/state/large_column.h"
#include "engine/state/types.h"
#include "engine/threads/parallel.h"
#include "engine/units/registry.h"

namespace epafi {

class CoarsePlaces {
 public:
  bool empty() const { return offsets_.empty(); }
  /// position(s) [m] of slots 0 to count.
  template <class Position>
  void take(std::size_t count, const Position& position) {
    offsets_.resize(count);
    groups_.resize((count + group_size - 1) / group_size);
    parallel_blocks(count, group_size, [&](std::size_t begin, std::size_t end, std::size_t g) {
      const Vec3 first = position(begin), origin = first.allFinite() ? first : Vec3(Vec3::Zero());
      double most = 0.0;
      for (std::size_t s = begin; s < end; ++s) {
        const Vec3 offset = position(s) - origin;
        most = std::max(most, offset.cwiseAbs().maxCoeff());
        const Eigen::Vector3f rounded = offset.cwiseMin(most_offset).cwiseMax(-most_offset).cast<float>();
        offsets_[s] = {rounded.x(), rounded.y(), rounded.z()};
      }
      groups_[g] = {origin, most < most_offset ? rounding * most : infinity};
    });
  }
  /// Of body s to x, or little more: by 2e-7 of the extent of its group; infinite where floats end [m].
  double displacement(std::size_t s, const Vec3& x) const {
    const Group& g = groups_[s / group_size];
    const Offset& o = offsets_[s];
    return (x - g.origin - Vec3(o.x, o.y, o.z)).norm() + g.doubt;
  }

 private:
  static constexpr std::size_t group_size = 64;
  static constexpr double rounding = 0x1p-23;  ///< a float is off by 2^-24 of itself along each of three axes
  static constexpr double most_offset = 1e30;  ///< beyond it floats end
  struct Group {
    Vec3 origin;
    double doubt;  ///< [m]
  };
  struct Offset {
    float x, y, z;  ///< [m]
  };
  std::vector<Group> groups_;
  UnwrittenColumn<Offset> offsets_;
};

}  // namespace epafi
