#include <cmath>
#include <numbers>

#include "detection/profiles/track.h"
#include "detection/profiles/wheelset.h"
#include "detection/surfaces/tessellate.h"

namespace epafi {
namespace {

/// Adds a grid of points, rows of `columns`, as triangles; the front is on the left of rows that grow.
void add_grid(TriangleSurface& s, const std::vector<Vec3>& points, std::uint32_t columns) {
  const auto first = static_cast<std::uint32_t>(s.vertices.size());
  s.vertices.insert(s.vertices.end(), points.begin(), points.end());
  const auto rows = static_cast<std::uint32_t>(points.size()) / columns;
  for (std::uint32_t r = 0; r + 1 < rows; ++r) {
    for (std::uint32_t c = 0; c + 1 < columns; ++c) {
      const std::uint32_t a = first + r * columns + c, b = a + columns;
      s.triangles.push_back({a, b, b + 1});
      s.triangles.push_back({a, b + 1, a + 1});
    }
  }
}

}  // namespace

TriangleSurface tessellate(const WheelProfile& shape, const Fineness& fineness) {
  const Wheelset& w = *shape.wheelset;
  const double tape = 0.5 * w.geometry.flange_back + w.geometry.tape_circle, bore = 0.08;
  std::vector<Vec3> around;  // y and radius, from the axle over the back of the wheel, the profile and the front to it
  around.emplace_back(0.0, tape + w.wheel.y_min(), bore);
  for (int k = 0; k <= 24; ++k) {
    const double y = w.wheel.y_min() + (w.wheel.y_max() - w.wheel.y_min()) * k / 24.0;
    around.emplace_back(0.0, tape + y, w.geometry.radius + w.wheel.at(y).z);
  }
  around.emplace_back(0.0, tape + w.wheel.y_max(), bore);
  TriangleSurface s;
  const auto columns = static_cast<std::uint32_t>(around.size());
  for (const double side : {1.0, -1.0}) {
    std::vector<Vec3> points;
    for (std::uint32_t k = 0; k <= 4 * fineness.segments; ++k) {
      const double angle = side * 2.0 * std::numbers::pi * k / (4.0 * fineness.segments);
      for (const Vec3& p : around) points.emplace_back(p.z() * std::sin(angle), side * p.y(), p.z() * std::cos(angle));
    }
    add_grid(s, points, columns);
  }
  std::vector<Vec3> axle;
  for (std::uint32_t k = 0; k <= fineness.segments; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / fineness.segments;
    for (const double y : {-tape - 0.25, tape + 0.25})
      axle.emplace_back(bore * std::sin(angle), y, bore * std::cos(angle));
  }
  add_grid(s, axle, 2);
  return s;
}

TriangleSurface tessellate(const RailProfile& shape, const Fineness&) {
  const Track& t = *shape.track;
  TriangleSurface s;
  const double step = t.curve.radius == 0.0 ? shape.drawn_length : 1.0;
  const auto frames = static_cast<int>((shape.drawn_length + 1e-9) / step) + 1;
  const WheelRailPair pair(Profile({{-0.1, 0.0, 0.1}, {0.0, 0.0, 0.0}}), t.rail, t.geometry, true);
  for (const double side : {1.0, -1.0}) {
    std::vector<Vec3> points;
    for (int m = 0; m < frames; ++m) {
      const Pose frame = t.frame(m * step);
      for (int k = 0; k <= 24; ++k) {
        const double y = t.rail.y_min() + (t.rail.y_max() - t.rail.y_min()) * k / 24.0;
        points.push_back(frame.to_world(Vec3(0.0, side * (pair.rail_axis() - y), t.rail.at(y).z)));
      }
    }
    add_grid(s, points, 25);
  }
  return s;
}

}  // namespace epafi
