/// @file aabb.h  Axis-aligned bounding box in world axes.
#pragma once
#include "engine/state/types.h"

namespace epafi {

struct Aabb {
  Vec3 min = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 max = Vec3::Constant(-std::numeric_limits<double>::infinity());

  Aabb fattened(double margin) const { return {min - Vec3::Constant(margin), max + Vec3::Constant(margin)}; }
  bool overlaps(const Aabb& o) const {
    return (min.array() <= o.max.array()).all() && (o.min.array() <= max.array()).all();
  }
  bool contains(const Aabb& o) const {
    return (min.array() <= o.min.array()).all() && (o.max.array() <= max.array()).all();
  }
  void include(const Vec3& p) {
    min = min.cwiseMin(p);
    max = max.cwiseMax(p);
  }
  void include(const Aabb& o) {
    min = min.cwiseMin(o.min);
    max = max.cwiseMax(o.max);
  }
  Vec3 centre() const { return 0.5 * (min + max); }
  Vec3 extent() const { return max - min; }
};

}  // namespace epafi
