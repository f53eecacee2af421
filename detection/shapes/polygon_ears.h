/// @file polygon_ears.h  Cuts the polygon of a face into triangles: fans where it is convex, else ears (Meisters 1975),
/// so that no triangle lies outside an inner corner.
#pragma once
#include <span>

#include "detection/shapes/triangle_surface.h"

namespace epafi {

namespace polygon_detail {

/// Twice the vector area (Newell).
inline Vec3 area_vector(const std::vector<Vec3>& points, std::span<const std::uint32_t> loop) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 2; k < loop.size(); ++k)
    sum += (points[loop[k - 1]] - points[loop[0]]).cross(points[loop[k]] - points[loop[0]]);
  return sum;
}

/// Corner k of the loop turns to the left and no other corner lies in its triangle.
inline bool is_ear(const std::vector<Vec3>& points, std::span<const std::uint32_t> loop, std::size_t k,
                   const Vec3& up) {
  const std::size_t n = loop.size();
  const std::array<std::uint32_t, 3> t{loop[(k + n - 1) % n], loop[k], loop[(k + 1) % n]};
  const auto twice = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return up.dot((points[b] - points[a]).cross(points[c] - points[a]));
  };
  const double area = twice(t[0], t[1], t[2]);
  const double before = (points[t[1]] - points[t[0]]).norm(), after = (points[t[2]] - points[t[1]]).norm();
  const double rounding = 1e-12 * up.norm() * before * after;
  if (!(area > rounding)) return false;
  for (const std::uint32_t v : loop) {
    const Vec3& x = points[v];
    if (x == points[t[0]] || x == points[t[1]] || x == points[t[2]]) continue;
    if (twice(t[0], t[1], v) >= -rounding && twice(t[1], t[2], v) >= -rounding && twice(t[2], t[0], v) >= -rounding)
      return false;
  }
  return true;
}

}  // namespace polygon_detail

/// Appends the triangles of a polygon. Where it crosses itself: what ears are found, and a fan of the rest.
inline void append_polygon(const std::vector<Vec3>& points, std::vector<std::uint32_t> loop,
                           std::vector<Triangle>& triangles) {
  using namespace polygon_detail;
  constexpr std::size_t largest = 20000;  // corners: beyond, ears would take minutes
  const auto fan = [&] {
    for (std::size_t k = 2; k < loop.size(); ++k) triangles.push_back({loop[0], loop[k - 1], loop[k]});
  };
  if (loop.size() == 3 || loop.size() > largest) return fan();
  const Vec3 up = area_vector(points, loop);
  bool is_convex = true;
  for (std::size_t k = 0, n = loop.size(); k < n && is_convex; ++k) {
    const Vec3 &a = points[loop[k]], &b = points[loop[(k + 1) % n]], &c = points[loop[(k + 2) % n]];
    is_convex = up.dot((b - a).cross(c - b)) > 0.0;
  }
  if (is_convex) return fan();
  while (loop.size() > 3) {
    std::size_t ear = 0;
    while (ear < loop.size() && !is_ear(points, loop, ear, up)) ++ear;
    if (ear == loop.size()) break;
    const std::size_t n = loop.size();
    triangles.push_back({loop[(ear + n - 1) % n], loop[ear], loop[(ear + 1) % n]});
    loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  fan();
}

}  // namespace epafi
