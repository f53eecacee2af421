// Convex regions of surfaces as files have them: far from the origin, rounded, cut at corners that lie on sides.
#include "detection/narrow/mesh/mesh_region.h"

#include <algorithm>

#include "detection/shapes/box.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using namespace epafi::testing;

namespace {

/// A floor of n by n cells 1 m wide, turned, about 100 m away; some triangles are halved, and corners are rounded.
TriangleSurface rounded_floor(Random& random, std::size_t n, double precision) {
  const Pose frame{100.0 * random_direction(random), random_turn(random)};
  std::vector<double> x = {-0.5, 0.5}, y = x;
  for (auto* line : {&x, &y}) {
    while (line->size() <= n) line->push_back(random.uniform(-0.5, 0.5));
    std::ranges::sort(*line);
  }
  TriangleSurface out;
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto k = static_cast<std::uint32_t>(out.vertices.size());
    for (const Vec3& v : {a, b, c}) {
      const Vec3 at = frame.to_world(v) / precision;
      out.vertices.push_back(precision * at.unaryExpr([](double u) { return std::round(u); }));
    }
    out.triangles.push_back({k, k + 1, k + 2});
  };
  const auto split = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 middle = a + random.uniform(0.1, 0.9) * (b - a);
    if (random.uniform() < 0.7) return add(a, b, c);
    add(a, middle, c);
    add(middle, b, c);
  };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      const Vec3 a(x[i], y[j], 0), b(x[i + 1], y[j], 0), c(x[i + 1], y[j + 1], 0), d(x[i], y[j + 1], 0);
      split(a, b, c);
      split(a, c, d);
    }
  return out;
}

}  // namespace

TEST_CASE("a convex region holds the triangle that it was gathered around", "[detection][mesh][mesh-region]") {
  Random random(644, 2);
  std::size_t notched = 0;
  for (int draw = 0; draw < 8; ++draw) {
    const double precision = std::pow(10.0, random.uniform(-7, -4));
    const TriangleMesh mesh =
        TriangleMesh::from_surface(rounded_floor(random, 4 + random.bits() % 4, precision), 0.5 * precision);
    std::vector<std::uint32_t> all(mesh.triangles.size());
    for (std::uint32_t t = 0; t < all.size(); ++t) all[t] = t;
    const Box box(Vec3(0.05, 0.04, 0.03));
    const ConvexRef core = ConvexRef::to(box);
    MeshRegion region;
    for (const std::uint32_t t : all) {
      notched += mesh.around[t].notches != 0;
      const Pose pose{mesh.corners(t)[0] + 0.02 * mesh.normals[t], random_turn(random)};
      const PlacedCore body{core, 0.0, pose, pose.orientation.toRotationMatrix(), 0.0, 1e-6 * core.radius, &mesh};
      gather_region(body, all, t, random.bits() % 2 == 0, region);
      INFO("draw " << draw << ", triangle " << t << " of " << all.size());
      CHECK(std::ranges::binary_search(region.triangles, t));
      CHECK(region.planes.size() > 0);
    }
  }
  CHECK(notched > 10);
}
