// A surface as people have it: corners that differ by the file's rounding, triangles given twice or turned over,
// corners in the middle of a side, slivers. What is joined must be the surface that was meant.
#include "detection/shapes/surface_join.h"

#include "detection/mass_properties.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using namespace epafi::testing;

namespace {

/// A plane floor of 2 m in n by n cells, turned, moved by `away` [m] and rounded to single precision.
TriangleSurface single_precision_floor(Random& random, std::uint32_t n, double away, Vec3& normal) {
  const Quat turn = random_turn(random);
  const Vec3 shift = away * random_direction(random);
  normal = turn * Vec3::UnitZ();
  TriangleSurface s;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) {
      const Vec3 x = turn * Vec3(-1.0 + 2.0 * i / n, -1.0 + 2.0 * j / n, 0.0) + shift;
      s.vertices.push_back(x.cast<float>().cast<double>());
    }
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t k = j * (n + 1) + i;
      s.triangles.push_back({k, k + 1, k + n + 2});
      s.triangles.push_back({k, k + n + 2, k + n + 1});
    }
  return s;
}

TriangleSurface apart(const TriangleSurface& s, Random& random, double off) {
  TriangleSurface out;
  for (const Triangle& t : s.triangles) {
    const auto k = static_cast<std::uint32_t>(out.vertices.size());
    for (const std::uint32_t v : t) out.vertices.push_back(s.vertices[v] + off * random_point(random));
    out.triangles.push_back({k, k + 1, k + 2});
  }
  return out;
}

std::size_t open_sides(const TriangleSurface& s) {
  const auto uses = sorted_edge_uses(s.triangles);
  std::size_t open = 0;
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].edge() == uses[begin].edge()) ++end;
    open += end - begin == 1;
  }
  return open;
}

}  // namespace

TEST_CASE("what is exact to rounding stays as it is, bit for bit", "[detection][join]") {
  Random random(71, 0);
  for (int k = 0; k < 20; ++k) {
    const auto s = moved(box_surface({1, 2, 3}), random_turn(random), 100.0 * random_point(random));
    const JoinedSurface joined = join_surface(s, 0.0);
    CHECK(joined.surface.vertices == s.vertices);
    CHECK(joined.surface.triangles == s.triangles);
    CHECK(joined.report.faces == 6);
    CHECK(joined.report.to_string().empty());
  }
}

TEST_CASE("a plane floor in single precision is one face up to 100 m from its origin", "[detection][join]") {
  Random random(72, 0);
  for (const double away : {0.0, 1.0, 14.0, 100.0})
    for (int k = 0; k < 5; ++k) {
      Vec3 normal;
      const TriangleSurface s = single_precision_floor(random, 20, away, normal);
      const double precision = std::ldexp(away + 2.0, -24);
      const JoinedSurface joined = join_surface(s, precision);
      INFO(away << " m away");
      CHECK(joined.report.faces == 1);
      CHECK(joined.surface.triangles.size() == s.triangles.size());
      // the fit of 441 corners, each off by at most the precision along each axis
      CHECK(joined.normals[0].cross(normal).norm() < 4.0 * precision);
      const Vec3 on_plane = joined.surface.vertices[0];
      for (const Vec3& v : joined.surface.vertices)
        CHECK(std::abs(joined.normals[0].dot(v - on_plane)) < 1e-13 * (away + 2.0));
      CHECK(joined.report.move_distance <= 4.0 * precision);
    }
}

TEST_CASE("corners a nanometre apart, triangles given twice and turned over become one closed box",
          "[detection][join]") {
  Random random(73, 0);
  const TriangleSurface box = box_surface({0.5, 0.3, 0.2});
  for (const double off : {0.0, 1e-12, 1e-9, 1e-7}) {
    TriangleSurface s = apart(box, random, off);
    for (std::size_t t = 0; t < s.triangles.size(); ++t)
      if (t % 3 == 1) std::swap(s.triangles[t][0], s.triangles[t][1]);
    const std::vector<Triangle> once = s.triangles;
    s.triangles.insert(s.triangles.end(), once.begin(), once.begin() + 5);
    const JoinedSurface joined = join_surface(s, off);
    INFO(off << " m");
    CHECK(joined.surface.vertices.size() == 8);
    CHECK(joined.report.doubled == 5);
    CHECK(joined.report.flipped > 0);
    CHECK(joined.report.faces == 6);
    CHECK(open_sides(joined.surface) == 0);
    const double mass = std::abs(surface_mass_properties(joined.surface).mass);
    CHECK(mass == Approx(8 * 0.5 * 0.3 * 0.2).epsilon(1e-12 + 40 * off));
  }
}

TEST_CASE("a corner in the middle of a side cuts the triangle across", "[detection][join]") {
  // two rows of squares over [0, 4] x [0, 2], the upper one cut elsewhere
  TriangleSurface s;
  const auto row = [&](double y, const std::vector<double>& x) {
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      const auto k = static_cast<std::uint32_t>(s.vertices.size());
      for (const Vec3& v : {Vec3(x[i], y, 0), Vec3(x[i + 1], y, 0), Vec3(x[i + 1], y + 1, 0), Vec3(x[i], y + 1, 0)})
        s.vertices.push_back(v);
      s.triangles.push_back({k, k + 1, k + 2});
      s.triangles.push_back({k, k + 2, k + 3});
    }
  };
  row(0.0, {0, 1, 2, 3, 4});
  row(1.0, {0, 0.3, 1.7, 2.2, 2.9, 4});
  const JoinedSurface joined = join_surface(s, 0.0);
  CHECK(joined.report.cut == 7);  // three corners of the lower row on sides of the upper one, four the other way
  CHECK(joined.report.faces == 1);
  CHECK(open_sides(joined.surface) == 4 + 5 + 2 + 2);
  double area = 0.0;
  for (const Triangle& t : joined.surface.triangles) {
    const auto& v = joined.surface.vertices;
    const double twice = (v[t[1]] - v[t[0]]).cross(v[t[2]] - v[t[0]]).z();
    CHECK(twice > 0.0);
    area += 0.5 * twice;
  }
  CHECK(area == Approx(8.0).epsilon(1e-14));
}

TEST_CASE("flaps a micrometre high on a floor of two metres are no part of it", "[detection][join]") {
  Random random(74, 0);
  Vec3 normal;
  TriangleSurface s = single_precision_floor(random, 4, 0.0, normal);
  for (Vec3& v : s.vertices) v = Vec3(v - normal * normal.dot(v));
  const std::size_t count = s.triangles.size();
  for (const double high : {1e-6, 1e-8, 1e-10})
    for (std::size_t t = 0; t < count; t += 5) {
      const Triangle at = s.triangles[t];
      s.vertices.push_back(0.4 * s.vertices[at[0]] + 0.6 * s.vertices[at[1]] + high * random_direction(random));
      s.triangles.push_back({at[0], at[1], static_cast<std::uint32_t>(s.vertices.size() - 1)});
    }
  const JoinedSurface joined = join_surface(s, 0.0);
  CHECK(joined.report.slivers == s.triangles.size() - count);
  CHECK(joined.surface.triangles.size() == count);
  CHECK(joined.report.faces == 1);
}
