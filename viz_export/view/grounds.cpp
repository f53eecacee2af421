#include "viz_export/view/grounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace epafi {
namespace {

double top_of(const BodyRecord& wall, const Vec3& up) {
  if (wall.surface == nullptr) return up.dot(wall.pose.position) + wall.radius;
  double top = -std::numeric_limits<double>::infinity();
  for (const Vec3& p : wall.surface->points) top = std::max(top, up.dot(wall.pose.to_world(p)));
  return top;
}

/// Lowest centre of free bodies along `up`, without strays; infinite where there are none.
double lowest_centre(const ViewFrame& frame, const Vec3& up) {
  constexpr std::size_t few = 50;
  constexpr double strays = 0.02;
  std::vector<double> heights;
  for (const BodyRecord& b : frame.bodies) {
    const double height = up.dot(b.pose.position);
    if (!b.is_wall() && std::isfinite(height)) heights.push_back(height);
  }
  if (heights.empty()) return std::numeric_limits<double>::infinity();
  const double share = heights.size() > few ? strays : 0.0;
  const auto lowest = heights.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(heights.size()));
  std::nth_element(heights.begin(), lowest, heights.end());
  return *lowest;
}

}  // namespace

void Grounds::add(const ViewFrame& frame) {
  const double lowest = lowest_centre(frame, up_);
  if (std::isinf(lowest)) return;
  for (const BodyRecord& b : frame.bodies) {
    if (!b.is_wall()) continue;
    const double top = top_of(b, up_);
    Wall& wall = walls_.try_emplace(b.id, Wall{top, true}).first->second;
    wall.top = std::max(wall.top, top);
    wall.is_below = wall.is_below && top <= lowest;
  }
}

std::vector<std::uint32_t> Grounds::ids() const {
  std::vector<std::uint32_t> out;
  for (const auto& [id, wall] : walls_)
    if (wall.is_below) out.push_back(id);
  return out;
}

double Grounds::top() const {
  double out = -std::numeric_limits<double>::infinity();
  for (const auto& [id, wall] : walls_)
    if (wall.is_below) out = std::max(out, wall.top);
  return out;
}

}  // namespace epafi
