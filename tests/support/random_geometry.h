/// @file random_geometry.h  Random directions, turns and standard surfaces for tests of detection.
#pragma once
#include <cmath>
#include <numbers>

#include "detection/shapes/triangle_surface.h"
#include "engine/units/random.h"

namespace epafi::testing {

using std::numbers::pi;
inline const Quat upright(1, 0, 0, 0);

/// Uniform on the unit sphere (Marsaglia 1972).
inline Vec3 random_direction(Random& random) {
  for (;;) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1), s = x * x + y * y;
    if (s < 1.0) return {2 * x * std::sqrt(1 - s), 2 * y * std::sqrt(1 - s), 1 - 2 * s};
  }
}
inline Vec3 random_point(Random& random, double low = -1, double high = 1) {
  const double x = random.uniform(low, high), y = random.uniform(low, high), z = random.uniform(low, high);
  return {x, y, z};
}
inline Quat random_turn(Random& random) {
  const Vec3 axis = random_direction(random);  // drawn first: compilers evaluate arguments in orders of their own
  return Quat(Eigen::AngleAxisd(random.uniform(0, pi), axis));
}

/// Box about the origin as 12 triangles.
inline TriangleSurface box_surface(const Vec3& half) {
  TriangleSurface s;
  for (int k = 0; k < 8; ++k)
    s.vertices.push_back({k & 1 ? half.x() : -half.x(), k & 2 ? half.y() : -half.y(), k & 4 ? half.z() : -half.z()});
  s.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return s;
}
/// Prism over a regular polygon of n corners on radius r about the z axis, from -h to h.
inline TriangleSurface prism_surface(std::uint32_t n, double r, double h) {
  TriangleSurface s;
  for (const double z : {-h, h})
    for (std::uint32_t k = 0; k < n; ++k)
      s.vertices.push_back({r * std::cos(2 * pi * k / n), r * std::sin(2 * pi * k / n), z});
  for (std::uint32_t k = 0; k < n; ++k) {
    const std::uint32_t next = (k + 1) % n;
    s.triangles.push_back({k, next, next + n});
    s.triangles.push_back({k, next + n, k + n});
    if (k >= 1 && k + 1 < n) {
      s.triangles.push_back({0, k + 1, k});
      s.triangles.push_back({n, n + k, n + k + 1});
    }
  }
  return s;
}
inline TriangleSurface moved(TriangleSurface s, const Quat& turn, const Vec3& shift) {
  for (Vec3& v : s.vertices) v = turn * v + shift;
  return s;
}

}  // namespace epafi::testing
