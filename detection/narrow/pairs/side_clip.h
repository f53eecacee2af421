/// @file side_clip.h  A flat side of a smooth body cut to the prism over a polygon (Sutherland and Hodgman 1974).
#pragma once
#include <algorithm>
#include <vector>

#include "engine/state/types.h"

namespace epafi {

/// Relative to the size: corners closer to an edge than this are on it (as in the manifold).
inline constexpr double side_snap = 1e-6;

/// A point of the side and its name: a corner, or an edge of the side cut by an edge of the polygon.
struct SidePoint {
  Vec3 x;
  std::uint32_t corner, cut;  ///< cut: 1 + edge of the polygon; 0: the corner itself
};

/// Cuts the side (2 corners: a segment, else a polygon) to the prism over `count` corners, counter-clockwise about
/// `normal`. Points outside by less than the tolerance [m] stay.
template <class Corner>
void clip_side(const Corner& corner, std::uint32_t count, const Vec3& normal, double tolerance,
               std::vector<SidePoint>& side) {
  static thread_local std::vector<SidePoint> next;  // keeps its size
  const bool segment = side.size() == 2;
  for (std::uint32_t k = 0; k < count && !side.empty(); ++k) {
    const Vec3& from = corner(k);
    const Vec3 inward = normal.cross(corner((k + 1) % count) - from).normalized();
    next.clear();
    for (std::size_t i = 0; i < side.size(); ++i) {
      const SidePoint &a = side[i], &b = side[(i + 1) % side.size()];
      const double da = inward.dot(a.x - from), db = inward.dot(b.x - from);
      if (da >= -tolerance) next.push_back(a);
      if (segment && i == 1) break;  // a segment has no way back
      if ((da >= -tolerance) != (db >= -tolerance))
        next.push_back({a.x + std::clamp(da / (da - db), 0.0, 1.0) * (b.x - a.x), a.corner, 1 + k});
    }
    side.swap(next);
  }
}

}  // namespace epafi
