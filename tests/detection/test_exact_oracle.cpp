// Whether two polyhedra meet, decided by CGAL's exact predicates: the sign of our distance agrees down to rounding.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Intersections_3/Triangle_3_Triangle_3.h>

#include <cmath>

#include "detection/narrow/polyhedra/polyhedra.h"
#include "tests/support/catch.h"
#include "tests/support/polyhedra.h"

using namespace epafi;

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

/// To a multiple of 2^-bits: sums of corners (20 bits) and offsets (50 bits) below 4 are then exact in doubles.
Vec3 on_grid(const Vec3& v, int bits) {
  const auto round = [&](double x) { return std::ldexp(std::nearbyint(std::ldexp(x, bits)), -bits); };
  return {round(v.x()), round(v.y()), round(v.z())};
}

ConvexHull body_on_grid(Random& random, int kind) {
  if (kind == 0) return Box(on_grid({random.uniform(0.2, 0.6), random.uniform(0.2, 0.6), 0.3}, 20)).hull;
  for (;;) {
    std::vector<Vec3> points;
    for (int k = 0; k < 4 + 6 * kind; ++k) points.push_back(on_grid(0.7 * testing::random_direction(random), 20));
    const HullSurface surface = hull_from_points(points);
    auto built = ConvexHull::from_faces(surface.vertices, surface.faces);
    if (built.problem.empty()) return built.hull;
  }
}

std::vector<Kernel::Triangle_3> triangles_of(const ConvexHull& hull, const Vec3& offset) {
  const auto corner = [&](std::uint32_t k) {
    const Vec3 x = hull.vertices[hull.face_vertices[k]] + offset;
    return Kernel::Point_3(x.x(), x.y(), x.z());
  };
  std::vector<Kernel::Triangle_3> out;
  for (std::size_t f = 0; f + 1 < hull.face_begin.size(); ++f)
    for (std::uint32_t k = hull.face_begin[f] + 1; k + 1 < hull.face_begin[f + 1]; ++k)
      out.emplace_back(corner(hull.face_begin[f]), corner(k), corner(k + 1));
  return out;
}

/// Of convex bodies neither of which contains the other.
bool surfaces_meet(const ConvexHull& a, const ConvexHull& b, const Vec3& offset) {
  const auto of_a = triangles_of(a, Vec3::Zero()), of_b = triangles_of(b, offset);
  for (const auto& s : of_a)
    for (const auto& t : of_b)
      if (CGAL::do_intersect(s, t)) return true;
  return false;
}

}  // namespace

TEST_CASE("exact predicates agree whether polyhedra meet, from a tenth of the size down to rounding", "[detection]") {
  Random random(87, 0);
  int apart = 0, meeting = 0, finest = 0;
  for (int k = 0; k < 480; ++k) {
    const ConvexHull a = body_on_grid(random, k % 3), b = body_on_grid(random, (k / 3) % 3);
    const double wanted = (k % 2 ? 1.0 : -1.0) * std::pow(10.0, -1 - k % 15);
    Vec3 offset = on_grid(2.5 * testing::random_direction(random), 50);
    for (int step = 0; step < 4; ++step) {  // along the normal, which changes on the way
      const auto d = polyhedron_distance(PolyhedronPair(a.view(), b.view(), {}, {offset, Quat(1, 0, 0, 0)}));
      offset = on_grid(offset + (wanted - d.axis.gap) * d.axis.normal, 50);
    }
    const auto d = polyhedron_distance(PolyhedronPair(a.view(), b.view(), {}, {offset, Quat(1, 0, 0, 0)}));
    if (std::abs(d.axis.gap) < 2e-15) continue;  // the sign is that of rounding
    INFO("gap " << d.axis.gap << " of pair " << k);
    CHECK(surfaces_meet(a, b, offset) == (d.axis.gap < 0.0));
    (d.axis.gap < 0.0 ? meeting : apart) += 1;
    finest += std::abs(d.axis.gap) < 1e-12;
  }
  CHECK(apart > 180);
  CHECK(meeting > 180);
  CHECK(finest > 60);
}
