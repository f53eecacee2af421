// Two convex surfaces in one file: they cross where the bodies overlap, each with a corner outside the other, as GJK
// and the planes of their faces say.
#include "detection/shapes/surface_crossing.h"

#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/gjk/gjk.h"
#include "detection/narrow/mesh/point_triangle.h"
#include "tests/support/catch.h"
#include "tests/support/pair_errors.h"

using namespace epafi;
using namespace epafi::testing;

namespace {

void add_surface(TriangleSurface& s, const ConvexHull& h, const Pose& pose) {
  const auto base = static_cast<std::uint32_t>(s.vertices.size());
  for (const Vec3& v : h.vertices) s.vertices.push_back(pose.to_world(v));
  for (std::size_t f = 0; f + 1 < h.face_begin.size(); ++f)
    for (std::uint32_t k = h.face_begin[f] + 1; k + 1 < h.face_begin[f + 1]; ++k)
      s.triangles.push_back(
          {base + h.face_vertices[h.face_begin[f]], base + h.face_vertices[k], base + h.face_vertices[k + 1]});
}

/// How far the corner of `a` that is farthest out is above the planes of `b` [m].
double sticks_out(const ConvexHull& a, const Pose& pa, const ConvexHull& b, const Pose& pb) {
  double farthest = -infinity;
  for (const Vec3& v : a.vertices) {
    const Vec3 x = pb.to_local(pa.to_world(v));
    double above = -infinity;
    for (std::size_t f = 0; f < b.face_normals.size(); ++f)
      above = std::max(above, b.face_normals[f].dot(x) - b.face_offsets[f]);
    farthest = std::max(farthest, above);
  }
  return farthest;
}

/// Triangles within `near` of x.
std::size_t triangles_at(const TriangleSurface& s, const Vec3& x, double near) {
  std::size_t count = 0;
  for (const Triangle& t : s.triangles)
    count += nearest_on_triangle(x, {s.vertices[t[0]], s.vertices[t[1]], s.vertices[t[2]]}).distance <= near;
  return count;
}

}  // namespace

TEST_CASE("surfaces of two convex bodies cross where the bodies overlap, and at no other place",
          "[detection][surface-crossing]") {
  Random random(611, 0);
  int crossed = 0, apart = 0, inside = 0;
  for (int k = 0; k < 600; ++k) {
    const double scale = std::pow(10.0, random.uniform(-6, 3));
    const double share = k % 3 == 0 ? 0.2 : 1.0;  // small ones may lie inside
    const ConvexHull a = support::random_hull(random, 6 + random.bits() % 20);
    const ConvexHull b = support::random_hull(random, 6 + random.bits() % 20, Vec3::Constant(share));
    const Pose pa{Vec3::Zero(), random_turn(random)};
    const Pose pb{random.uniform(0.0, 1.6) * a.radius * random_direction(random), random_turn(random)};
    TriangleSurface s;
    add_surface(s, a, pa);
    add_surface(s, b, pb);
    for (Vec3& v : s.vertices) v *= scale;
    const MinkowskiDifference difference(ConvexRef::to(a), ConvexRef::to(b), pa, pb);
    const GjkResult g = gjk(difference);
    const bool overlap = g.status == GjkResult::Status::overlapping;
    const double depth = overlap ? epa(difference).upper : -g.lower;
    const double out = std::min(sticks_out(a, pa, b, pb), sticks_out(b, pb, a, pa));
    if (std::abs(depth) < 1e-3 || std::abs(out) < 1e-3) continue;  // they touch
    const SurfaceCrossings found = find_crossings(s, 1e-6 * scale);
    if (depth < 0.0 || out < 0.0) {
      (depth < 0.0 ? apart : inside) += 1;
      CHECK(found.triangles == 0);
      continue;
    }
    ++crossed;
    CHECK(found.triangles > 0);
    CHECK(triangles_at(s, found.first, 1e-12 * scale) >= 2);
  }
  CHECK(crossed > 200);
  CHECK(apart > 50);
  CHECK(inside > 20);
}

TEST_CASE("surfaces that share corners, sides or faces touch and do not cross", "[detection][surface-crossing]") {
  Random random(612, 0);
  for (int k = 0; k < 200; ++k) {
    const Vec3 half(random.uniform(0.1, 1), random.uniform(0.1, 1), random.uniform(0.1, 1));
    TriangleSurface s = box_surface(half), other = box_surface(half);
    // beside it: by a face, a side or a corner, the face shifted along itself
    const int sides = 1 + k % 3;
    Vec3 step(0, 0, 0);
    for (int axis = 0; axis < sides; ++axis) step[axis] = 2 * half[axis];
    if (sides == 1 && k % 2 == 0) step.y() = random.uniform(-1, 1) * half.y();
    const auto base = static_cast<std::uint32_t>(s.vertices.size());
    for (const Vec3& v : other.vertices) s.vertices.push_back(v + step);
    for (const Triangle& t : other.triangles) s.triangles.push_back({base + t[0], base + t[1], base + t[2]});
    s = moved(s, random_turn(random), 10.0 * random_point(random));
    CHECK(find_crossings(s, 1e-6 * half.norm()).triangles == 0);
  }
}
