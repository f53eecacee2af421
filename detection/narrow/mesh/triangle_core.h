/// @file triangle_core.h  One triangle as a convex core for GJK, relative to its centroid.
#pragma once
#include <algorithm>
#include <array>

#include "engine/state/types.h"

namespace epafi {

struct TriangleCore {
  Vec3 centre;
  std::array<Vec3, 3> corner;
  double radius = 0.0;

  explicit TriangleCore(const std::array<Vec3, 3>& corners) : centre((corners[0] + corners[1] + corners[2]) / 3.0) {
    for (std::size_t k = 0; k < 3; ++k) {
      corner[k] = corners[k] - centre;
      radius = std::max(radius, corner[k].norm());
    }
  }
  double bounding_radius() const { return radius; }
  double rounding() const { return 0.0; }
  Vec3 support(const Vec3& d) const {
    const double a = d.dot(corner[0]), b = d.dot(corner[1]), c = d.dot(corner[2]);
    return a >= b ? (a >= c ? corner[0] : corner[2]) : (b >= c ? corner[1] : corner[2]);
  }
};

}  // namespace epafi
