// The hull of points on a grid of whole numbers, where doubles decide exactly: closed, convex, of extreme points alone.
#include "detection/shapes/exact_hull.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using namespace epafi::testing;

namespace {

using HullTriangle = std::array<std::uint32_t, 3>;

/// Whole numbers below 2^15: products of three differences stay below 2^53.
double volume_of(const std::vector<Vec3>& p, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  return (p[b] - p[a]).cross(p[c] - p[a]).dot(p[d] - p[a]);
}

/// Kinds: a coarse grid (many points in line, in plane, doubled), a face of a cube, near a sphere, near a disk.
std::vector<Vec3> whole_points(Random& random, int kind, int count) {
  std::vector<Vec3> out;
  const auto whole = [&](double range) { return std::floor(random.uniform(-range, range + 1)); };
  for (int k = 0; k < count; ++k) {
    if (kind == 0) out.push_back({whole(3), whole(3), whole(3)});
    if (kind == 1) out.push_back({k % 2 == 0 ? 8.0 : whole(8), whole(8), k % 3 == 0 ? -8.0 : whole(8)});
    if (kind == 2) out.push_back((10000.0 * random_direction(random)).array().round());
    if (kind == 3) out.push_back((Vec3(10000, 10000, 3).cwiseProduct(random_direction(random))).array().round());
  }
  return out;
}

/// Of the first four points that span a volume; all 0 where none do.
std::array<std::uint32_t, 4> some_simplex(const std::vector<Vec3>& p) {
  const auto n = static_cast<std::uint32_t>(p.size());
  for (std::uint32_t b = 1; b < n; ++b)
    for (std::uint32_t c = b + 1; c < n && p[b] != p[0]; ++c) {
      if ((p[b] - p[0]).cross(p[c] - p[0]).isZero(0.0)) continue;
      for (std::uint32_t d = 1; d < n; ++d)
        if (volume_of(p, 0, b, c, d) != 0.0) return {0, b, c, d};
    }
  return {};
}

void check_closed(const std::vector<HullTriangle>& hull) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> uses;
  std::set<std::uint32_t> corners;
  for (const HullTriangle& t : hull)
    for (std::size_t k = 0; k < 3; ++k) {
      ++uses[{t[k], t[(k + 1) % 3]}];
      corners.insert(t[k]);
    }
  for (const auto& [edge, count] : uses) {
    CHECK(count == 1);
    CHECK(uses.count({edge.second, edge.first}) == 1);
  }
  CHECK(corners.size() - uses.size() / 2 + hull.size() == 2);  // Euler
}

/// Every point is below every triangle, and three planes at least meet in each corner.
void check_convex(const std::vector<Vec3>& p, const std::vector<HullTriangle>& hull) {
  std::map<std::uint32_t, std::vector<HullTriangle>> planes_at;
  for (const HullTriangle& t : hull) {
    CHECK(t[0] < std::min(t[1], t[2]));
    CHECK_FALSE((p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]).isZero(0.0));
    int above = 0;
    for (std::uint32_t d = 0; d < p.size(); ++d) above += volume_of(p, t[0], t[1], t[2], d) > 0.0;
    CHECK(above == 0);
    for (const std::uint32_t v : t) {
      const auto same = [&](const HullTriangle& other) {
        return std::all_of(other.begin(), other.end(),
                           [&](std::uint32_t d) { return volume_of(p, t[0], t[1], t[2], d) == 0.0; });
      };
      auto& planes = planes_at[v];
      if (std::none_of(planes.begin(), planes.end(), same)) planes.push_back(t);
    }
  }
  for (const auto& [v, planes] : planes_at) CHECK(planes.size() >= 3);
}

}  // namespace

TEST_CASE("a hull by exact predicates is closed, convex and of extreme points alone", "[detection][hull]") {
  Random random(68, 12);
  int hulls = 0;
  for (int draw = 0; draw < 400; ++draw) {
    const auto points = whole_points(random, draw % 4, 4 + static_cast<int>(random.uniform() * 60));
    const auto simplex = some_simplex(points);
    if (simplex[3] == 0) continue;
    const auto hull = exact_hull(points, simplex);
    check_closed(hull);
    check_convex(points, hull);
    ++hulls;
  }
  CHECK(hulls > 380);
}

TEST_CASE("a cube of 1331 grid points has 8 corners and 12 triangles", "[detection][hull]") {
  std::vector<Vec3> points;
  for (int k = 0; k < 1331; ++k) points.push_back({k % 11 - 5.0, k / 11 % 11 - 5.0, k / 121 - 5.0});
  const auto hull = exact_hull(points, {0, 10, 120, 1330});
  CHECK(hull.size() == 12);
  check_closed(hull);
  check_convex(points, hull);
}
