#include "detection/narrow/few_points.h"

#include <algorithm>

#include "detection/narrow/polyhedra/manifold.h"

namespace epafi {

namespace {

constexpr double apart = 1e-4;  ///< over the size: a point with a larger gap does not touch yet

/// Adds the point, with its number in the list as its name, unless one is there already.
bool add_place(std::vector<PatchPoint>& places, const Vec3& place, double gap, std::size_t number, double near) {
  for (PatchPoint& p : places)
    if ((p.position - place).squaredNorm() <= near * near) {
      p.gap = std::min(p.gap, gap);
      return false;
    }
  places.push_back({place, gap, number});
  return true;
}

/// Puts the corners below the surface into `kept`, if all of them and the deepest point touch.
bool keep_corners_below(std::span<const PatchPoint> places, const Vec3& normal, const OutlineCorners& outline,
                        double near, std::vector<PatchPoint>& kept) {
  kept.clear();
  const auto shallower = [](const PatchPoint& p, const PatchPoint& q) { return p.gap < q.gap; };
  const PatchPoint& deepest = *std::min_element(places.begin(), places.end(), shallower);
  const Vec3 out = outline.side * normal;
  double lowest = infinity;
  for (const Vec3& corner : outline.corners) {
    const Vec3 tip = corner - outline.sweep * out;
    const double gap = out.dot(tip - deepest.position) + 0.5 * deepest.gap;
    if (!(gap < near)) continue;
    const auto is_there = [&](const PatchPoint& p) {
      return (p.position + 0.5 * p.gap * out - tip).squaredNorm() <= 4.0 * near * near;
    };
    const auto found = std::find_if(places.begin(), places.end(), is_there);
    if (found == places.end() && gap < -near) return false;
    if (found == places.end()) continue;
    kept.push_back(*found);
    lowest = std::min(lowest, gap);
  }
  return lowest <= deepest.gap + near;
}

}  // namespace

bool keep_few(std::span<const SurfacePoint> points, std::span<const OutlineCorners> outlines, double size, double near,
              ContactSet& contacts, std::vector<std::uint8_t>& gone) {
  static thread_local std::vector<PatchPoint> places, corners;  // keep their sizes
  static thread_local std::vector<std::uint8_t> seen;
  seen.assign(points.size(), 0);
  bool any_gone = false;
  for (std::size_t first = 0; first < points.size(); ++first) {
    if (seen[first] != 0) continue;
    places.clear();
    for (std::size_t k = first; k < points.size(); ++k) {
      const SurfacePoint& p = points[k];
      if (seen[k] != 0 || !same_direction(p.normal, points[first].normal)) continue;
      if (contacts.gap[p.contact] > apart * size) continue;  // which of these lands first is not known
      seen[k] = gone[p.contact] = 1;
      any_gone = !add_place(places, p.place, contacts.gap[p.contact], k, near) || any_gone;
    }
    if (places.empty()) continue;
    const Vec3& n = points[first].normal;
    const auto rests = [&](const OutlineCorners& o) { return keep_corners_below(places, n, o, near, corners); };
    if (std::ranges::none_of(outlines, rests)) {
      Patch four;
      keep_four(places, n, size, four);
      corners.assign(four.point.begin(), four.point.begin() + four.count);
    }
    any_gone = any_gone || corners.size() < places.size();
    for (const PatchPoint& p : corners) {
      const std::size_t contact = points[p.feature].contact;
      contacts.gap[contact] = p.gap;
      gone[contact] = 0;
    }
  }
  return any_gone;
}

}  // namespace epafi
