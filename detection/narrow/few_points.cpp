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

}  // namespace

bool keep_few(std::span<const SurfacePoint> points, double size, double near, ContactSet& contacts,
              std::vector<std::uint8_t>& gone) {
  static thread_local std::vector<PatchPoint> places;  // keep their sizes
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
    any_gone = any_gone || places.size() > 4;
    Patch kept;
    keep_four(places, points[first].normal, size, kept);
    for (int k = 0; k < kept.count; ++k) {
      const PatchPoint& p = kept.point[static_cast<std::size_t>(k)];
      const std::size_t contact = points[p.feature].contact;
      contacts.gap[contact] = p.gap;
      gone[contact] = 0;
    }
  }
  return any_gone;
}

}  // namespace epafi
