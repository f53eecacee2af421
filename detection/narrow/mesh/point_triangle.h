/// @file point_triangle.h  The point of a triangle nearest to a point, and where on the triangle it lies
/// (regions after Ericson 2005, section 5.1.5; edges first, so that slivers are safe).
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/state/types.h"

namespace epafi {

/// Part of a triangle: its inside, side k from corner k to corner k + 1, or corner k.
enum class TrianglePart : std::uint32_t { face, side0, side1, side2, corner0, corner1, corner2 };

struct NearestOnTriangle {
  Vec3 point = Vec3::Zero();
  double distance = 0.0;  ///< [m]
  TrianglePart part = TrianglePart::face;
};

/// Parameter in [0, 1] of the point of the segment from a to b that is nearest to p.
inline double nearest_on_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double square = along.squaredNorm();
  return square > 0.0 ? std::clamp((p - a).dot(along) / square, 0.0, 1.0) : 0.0;
}

/// The triangle may have no area. A foot inside by less than `tolerance` [m] beyond a side still counts as inside, so
/// that two coplanar neighbours agree on their plane whichever side of the common edge rounding puts the foot.
inline NearestOnTriangle nearest_on_triangle(const Vec3& p, const std::array<Vec3, 3>& corner, double tolerance = 0.0) {
  const Vec3 area = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  const double twice = area.norm();
  if (twice > 0.0) {
    const Vec3 normal = area / twice;
    bool inside = true;
    for (std::size_t k = 0; k < 3 && inside; ++k) {
      const Vec3 side = corner[(k + 1) % 3] - corner[k];
      inside = normal.cross(side).dot(p - corner[k]) >= -tolerance * side.norm();
    }
    if (inside) {
      const double height = normal.dot(p - corner[0]);
      return {p - height * normal, std::abs(height), TrianglePart::face};
    }
  }
  NearestOnTriangle best;
  best.distance = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const double t = nearest_on_segment(p, corner[k], corner[next]);
    const Vec3 foot = corner[k] + t * (corner[next] - corner[k]);
    const double distance = (p - foot).norm();
    if (distance >= best.distance) continue;
    const std::size_t part = t <= 0.0 ? 4 + k : t >= 1.0 ? 4 + next : 1 + k;
    best = {foot, distance, static_cast<TrianglePart>(part)};
  }
  return best;
}

}  // namespace epafi
