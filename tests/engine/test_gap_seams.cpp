// The seams for patch models and finite elements, each with a toy on both sides that knows nothing of the other.
#include <cmath>

#include "engine/railway/gap_field.h"
#include "engine/railway/gap_operator.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

/// Detection's side: a paraboloid of radius R pressed by delta into a plane, on n x n cells over a square of side 2 l.
GapField paraboloid_on_plane(double radius, double delta, double l, std::size_t n) {
  GapField field;
  field.frame = contact_frame(Vec3::UnitZ());
  field.nx = field.ny = n;
  field.dx = field.dy = 2 * l / static_cast<double>(n);
  field.curvature_x = field.curvature_y = 1 / radius;
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < n; ++i)
      field.gap.push_back((field.x(i) * field.x(i) + field.y(j) * field.y(j)) / (2 * radius) - delta);
  return field;
}

/// Laws' side: Winkler's foundation, pressure k max(0, -h).
double winkler_force(const GapField& field, double k) {
  double force = 0;
  for (double h : field.gap) force += k * std::max(0.0, -h) * field.dx * field.dy;
  return force;
}

/// Detection's side of finite elements: nodes against the plane z = 0.
class NodesOnPlane final : public GapOperator {
 public:
  void evaluate(std::span<const Vec3> positions, GapRows& out) const override {
    out.clear();
    for (std::uint32_t i = 0; i < positions.size(); ++i) {
      out.gap.push_back(positions[i].z());
      out.normal.push_back(Vec3::UnitZ());
      out.node.push_back(i);
      out.weight.push_back(1.0);
      out.begin.push_back(i + 1);
    }
  }
};

}  // namespace

TEST_CASE("a patch model reads a gap field it did not make: Winkler force of a paraboloid", "[engine][seams]") {
  // F = k integral of (delta - r^2 / 2R) over r^2 < 2 R delta = pi k R delta^2
  const double radius = 0.3, delta = 1e-4, k = 1e12;
  const GapField field = paraboloid_on_plane(radius, delta, 1.1 * std::sqrt(2 * radius * delta), 400);
  CHECK(winkler_force(field, k) == Approx(M_PI * k * radius * delta * delta).epsilon(1e-4));  // midpoint rule: O(1/n^2)
}

TEST_CASE("a penalty on a gap operator balances the load: nodes on springs under gravity", "[engine][seams]") {
  // each node has weight m g and penalty p: rests at g = -m g / p, found by Newton steps through the operator alone
  const double weight = 2.0, penalty = 1e5;
  std::vector<Vec3> nodes{{0, 0, 0.1}, {1, 0, -0.2}, {0, 1, 0}};
  const NodesOnPlane op;
  GapRows rows;
  for (int newton = 0; newton < 3; ++newton) {
    op.evaluate(nodes, rows);
    for (std::size_t c = 0; c < rows.gap.size(); ++c)
      for (std::uint32_t r = rows.begin[c]; r < rows.begin[c + 1]; ++r) {
        const double residual = -weight - penalty * rows.gap[c] * rows.weight[r];
        nodes[rows.node[r]] += residual / (penalty * rows.weight[r] * rows.weight[r]) * rows.normal[c];
      }
  }
  for (const Vec3& x : nodes) CHECK(x.z() == Approx(-weight / penalty).epsilon(1e-12));
}
