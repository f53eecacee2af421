// Boundary elements whose undeformed gap is projected between two meshes (detection/surfaces) against Hertz.
#include <cmath>
#include <numbers>

#include "detection/surfaces/projected_field.h"
#include "laws/wheel_rail/half_space/normal.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;

namespace {

const ElasticPair steel{210e9 / 2.6, 0.3, 0.0};
constexpr double patch = 2e-3;  // radius of contact [m]

/// Two balls whose lowest points touch at the origin, meshed over (-w, w)^2 of the frame's plane in n x n squares.
struct Caps {
  std::vector<Vec3> nodes;
  std::vector<Triangle> first, second;

  Caps(const GapField& field, double radius_first, double radius_second, double w, int n) {
    add(field, -radius_first, w, n, first);
    add(field, radius_second, w, n, second);
  }

 private:
  /// radius > 0: above the plane. The mesh is turned against the grid, so that nodes do not lie under cells.
  void add(const GapField& f, double radius, double w, int n, std::vector<Triangle>& out) {
    const auto begin = static_cast<std::uint32_t>(nodes.size()), row = static_cast<std::uint32_t>(n + 1);
    const double c = std::cos(0.3), s = std::sin(0.3);
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) {
        const double u = w * (2.0 * i / n - 1.0), v = w * (2.0 * j / n - 1.0), x = c * u - s * v, y = s * u + c * v;
        const double rise = radius - std::copysign(std::sqrt(radius * radius - x * x - y * y), radius);
        nodes.push_back(f.origin + x * f.frame.tangent1 + y * f.frame.tangent2 + rise * f.frame.normal);
      }
    const auto triangle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c3) {
      out.push_back(radius < 0.0 ? Triangle{a, b, c3} : Triangle{a, c3, b});  // the first looks up, the second down
    };
    for (std::uint32_t j = 0; j + 1 < row; ++j)
      for (std::uint32_t i = 0; i + 1 < row; ++i) {
        const std::uint32_t k = begin + j * row + i;
        triangle(k, k + 1, k + row + 1);
        triangle(k, k + row + 1, k + row);
      }
  }
};

GapField plane_at(const Vec3& origin, const Vec3& normal) {
  GapField f;
  f.origin = origin;
  f.frame = contact_frame(normal);
  f.nx = f.ny = 40;
  f.dx = f.dy = 2.6 * patch / 40;
  return f;
}

}  // namespace

TEST_CASE("the gap projected between two meshed balls is x^2/2R, wherever they are",
          "[physics][wheel_rail][surfaces]") {
  Random random(401, 0);
  for (const double other : {0.3, 0.1}) {
    GapField field = plane_at(5.0 * testing::random_direction(random), testing::random_direction(random));
    const int n = 64;
    const double w = 2.0 * patch, R = 1.0 / (1.0 / 0.3 + 1.0 / other), chord = std::pow(2.0 * w / n, 2) / (4.0 * R);
    const Caps caps(field, 0.3, other, w, n);
    project_gaps(caps.nodes, caps.first, caps.second, 1e-3, field);
    REQUIRE(field.gap.size() == 1600);
    for (std::size_t j = 0; j < field.ny; ++j)
      for (std::size_t i = 0; i < field.nx; ++i) {
        const double r2 = field.x(i) * field.x(i) + field.y(j) * field.y(j), exact = r2 / (2.0 * R);
        // chords of both meshes; slopes below r/R = 0.05 shorten by half their square
        CHECK(std::abs(field.at(i, j) - exact) < chord + 2e-3 * exact);
      }
    const double band = 0.2 * patch * patch / (2.0 * 0.3);
    project_gaps(caps.nodes, caps.first, caps.second, band, field);
    CHECK(std::isnan(field.at(0, 0)));
    CHECK(std::isfinite(field.at(20, 20)));
  }
}

TEST_CASE("boundary elements press two meshed balls as Hertz' do", "[physics][wheel_rail][surfaces]") {
  Random random(402, 0);
  const double Ra = 0.3, Rb = 0.15, R = 1.0 / (1.0 / Ra + 1.0 / Rb), E = steel.effective_modulus();
  // N = 4 E* a^3 / 3 R, p0 = 3 N / 2 pi a^2, approach a^2 / R (Johnson 1985, ch. 4)
  const double N = 4.0 * E * std::pow(patch, 3) / (3.0 * R);
  const double p0 = 1.5 * N / (std::numbers::pi * patch * patch);
  GapField field = plane_at({1.0, -2.0, 0.5}, testing::random_direction(random));
  const Caps caps(field, Ra, Rb, 2.0 * patch, 80);
  project_gaps(caps.nodes, caps.first, caps.second, 1e-3, field);
  const PatchGrid grid{field.nx, field.ny, field.dx, field.dy};
  const HalfSpaceNormal c = solve_half_space_normal(grid, field.gap, steel, {true, N});
  REQUIRE(c.report.converged);
  CHECK(c.max_pressure == Approx(p0).epsilon(0.01));
  CHECK(c.approach == Approx(patch * patch / R).epsilon(0.01));
  CHECK(c.area == Approx(std::numbers::pi * patch * patch).epsilon(0.02));
}
