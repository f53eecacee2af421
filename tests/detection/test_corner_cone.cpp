// The cone at a vertex, split among its faces: the parts are those that cutting by every bisector gives.
#include "detection/narrow/polyhedra/corner_cone.h"

#include <numbers>

#include "detection/narrow/polyhedra/clipped_solid.h"
#include "tests/support/catch.h"
#include "tests/support/polyhedra.h"

using namespace epafi;

namespace {

ConvexHull hull_of(const std::vector<Vec3>& points) {
  const HullSurface surface = hull_from_points(points);
  return ConvexHull::from_faces(surface.vertices, surface.faces).hull;
}

/// Volume of each part below the plane up.x = height, from the vertex; faces in the cone's order.
std::vector<double> part_volumes(const CornerCone& cone, const Vec3& up, double height) {
  std::vector<double> out(cone.faces().size(), 0.0);
  const auto at = [&](std::size_t k) -> Vec3 { return height / up.dot(cone.rays()[k].along) * cone.rays()[k].along; };
  for (const auto& t : cone.tetrahedra())
    out[t.part] += std::abs(at(t.ray[0]).dot(at(t.ray[1]).cross(at(t.ray[2])))) / 6.0;
  return out;
}

/// A plane that cuts off the vertex and no other: its normal, and its height above the vertex.
std::pair<Vec3, double> cutting_plane(const ConvexHull& hull, std::uint32_t vertex) {
  Vec3 up = Vec3::Zero();
  for (std::uint32_t k = hull.fan_begin[vertex]; k < hull.fan_begin[vertex + 1]; ++k)
    up -= hull.face_normals[hull.fans[k]];
  up.normalize();
  double next = infinity;
  for (std::uint32_t v = 0; v < hull.vertices.size(); ++v)
    if (v != vertex) next = std::min(next, up.dot(hull.vertices[v] - hull.vertices[vertex]));
  return {up, 0.9 * next};
}

}  // namespace

TEST_CASE("a cube's corner is three equal parts that meet along the diagonal", "[detection][volume]") {
  const Box cube(Vec3(1, 1, 1));
  for (std::uint32_t v = 0; v < 8; ++v) {
    CornerCone cone;
    REQUIRE(cone.assign(cube.hull.view(), v));
    REQUIRE(cone.rays().size() == 4);
    const Vec3 inward = -cube.hull.vertices[v].normalized();
    const CornerCone::Ray& inner = cone.rays()[3];
    CHECK((inner.along.normalized() - inward).norm() < 1e-15);
    CHECK(inner.depth / inner.along.norm() == Approx(std::sqrt(1.0 / 3.0)).epsilon(1e-15));
    // the tetrahedron of height 1 along the diagonal has legs sqrt(3), volume sqrt(27)/6
    for (const double volume : part_volumes(cone, inward, 1.0))
      CHECK(volume == Approx(std::sqrt(27.0) / 18.0).epsilon(1e-14));
  }
}

TEST_CASE("four faces that are as near along one ray share it", "[detection][volume]") {
  const std::vector<Vec3> points{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const ConvexHull octahedron = hull_of(points);
  for (std::uint32_t v = 0; v < 6; ++v) {
    CornerCone cone;
    REQUIRE(cone.assign(octahedron.view(), v));
    REQUIRE(cone.faces().size() == 4);
    // half of the pyramid of height 1/2: base 1/2, volume 1/12, a quarter of it each
    for (const double volume : part_volumes(cone, -octahedron.vertices[v], 0.5))
      CHECK(volume == Approx(1.0 / 48.0).epsilon(1e-14));
  }
}

TEST_CASE("parts of corners are what cutting by the planes between them leaves", "[detection][volume]") {
  Random random(5, 0);
  std::size_t most = 0;
  for (int k = 0; k < 40; ++k) {
    const ConvexHull hull = support::random_hull(random, 8 + static_cast<std::size_t>(k) % 16, {1, 0.8, 0.6});
    for (std::uint32_t v = 0; v < hull.vertices.size(); ++v) {
      const auto [up, height] = cutting_plane(hull, v);
      if (!(height > 1e-3)) continue;  // too blunt or too near another vertex
      CornerCone cone;
      REQUIRE(cone.assign(hull.view(), v));
      most = std::max(most, cone.faces().size());
      const std::vector<double> volumes = part_volumes(cone, up, height);
      for (std::size_t i = 0; i < volumes.size(); ++i) {
        ClippedSolid solid;
        solid.assign(hull.view(), Mat3::Identity(), Vec3::Zero());
        bool left = solid.clip({up, up.dot(hull.vertices[v]) + height});
        for (const std::uint32_t other : cone.faces()) {
          const std::uint32_t own = cone.faces()[i];
          if (other == own || !left) continue;
          left = solid.clip(
              {hull.face_normals[other] - hull.face_normals[own], hull.face_offsets[other] - hull.face_offsets[own]});
        }
        CHECK(volumes[i] == Approx(left ? solid.volume().volume : 0.0).epsilon(1e-9).margin(1e-15));
      }
    }
  }
  CHECK(most >= 7);
}

TEST_CASE("a vertex of more faces than a cone holds is refused", "[detection][volume]") {
  std::vector<Vec3> points{{0, 0, 1}, {0, 0, -1}};
  for (int k = 0; k < 13; ++k) {
    const double angle = 2.0 * k * std::numbers::pi / 13.0;
    points.push_back(Vec3(std::cos(angle), std::sin(angle), 0));
  }
  const ConvexHull hull = hull_of(points);
  std::size_t refused = 0;
  CornerCone cone;
  for (std::uint32_t v = 0; v < hull.vertices.size(); ++v) refused += !cone.assign(hull.view(), v);
  CHECK(refused == 2);
}
