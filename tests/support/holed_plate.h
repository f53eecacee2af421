/// @file holed_plate.h  Plates with a hole of several sides: rims that end at corners where the solid goes on.
#pragma once
#include <array>
#include <utility>
#include <vector>

#include "detection/shapes/convex_hull.h"
#include "detection/shapes/hull_from_points.h"
#include "tests/support/stepped_rocks.h"

namespace epafi::support {

struct HoledPlate {
  TriangleSurface surface;
  std::vector<std::pair<ConvexHull, Vec3>> parts;  ///< one beyond each side of the hole, with its centre
  std::vector<Vec3> corners;                       ///< of the hole, above and below
};

/// A convex plate about the origin, `half` wide and thick, its hole of as many sides as itself.
inline HoledPlate random_holed_plate(Random& random, const Vec3& half) {
  const std::size_t n = 3 + random.bits() % 4;
  const double turn = random.uniform(0, 2 * testing::pi), width = random.uniform(0.2, 0.6);
  std::vector<Vec3> outer, inner;
  for (std::size_t k = 0; k < n; ++k) {
    const double angle =
        turn + 2 * testing::pi * (static_cast<double>(k) + random.uniform(-0.15, 0.15)) / static_cast<double>(n);
    outer.push_back(Vec3(std::cos(angle), std::sin(angle), 0).cwiseProduct(half));
    inner.push_back(width * random.uniform(0.9, 1.1) * outer.back());
  }
  const Vec3 up(0, 0, half.z());
  HoledPlate plate;
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 &a = outer[k], &b = outer[(k + 1) % n], &c = inner[k], &d = inner[(k + 1) % n];
    add_square({c + up, a + up, b + up, d + up}, random, plate.surface);
    add_square({c - up, d - up, b - up, a - up}, random, plate.surface);
    add_square({a - up, b - up, b + up, a + up}, random, plate.surface);
    add_square({d - up, c - up, c + up, d + up}, random, plate.surface);
    plate.corners.insert(plate.corners.end(), {c + up, c - up});
    const Vec3 out = (d - c).cross(Vec3::UnitZ());
    std::vector<Vec3> points;
    Vec3 centre = Vec3::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3 &p = outer[i], &q = outer[(i + 1) % n];
      const double from = out.dot(p - c), to = out.dot(q - c);
      if (from >= 0.0) points.push_back(p);
      if (from * to < 0.0) points.push_back(p + from / (from - to) * (q - p));
    }
    for (const Vec3& p : points) centre += p / static_cast<double>(points.size());
    std::vector<Vec3> all;
    for (const Vec3& p : points) all.insert(all.end(), {p - centre + up, p - centre - up});
    const HullSurface hull = hull_from_points(all, {}, 1e-15);
    plate.parts.emplace_back(ConvexHull::from_faces(hull.vertices, hull.faces).hull, centre);
  }
  return plate;
}

}  // namespace epafi::support
