#include "detection/surfaces/surface_gap.h"

#include "detection/surfaces/tessellate.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;

namespace {

/// Two surfaces over one list of nodes.
struct Nodes {
  std::vector<Vec3> x;
  std::vector<Triangle> master, slave;
  void add(const TriangleSurface& s, std::vector<Triangle>& to, const Pose& pose = {}) {
    const auto first = static_cast<std::uint32_t>(x.size());
    for (const Vec3& v : s.vertices) x.push_back(pose.to_world(v));
    for (const Triangle& t : s.triangles) to.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
};

/// n x n squares over [0, size]^2 at z = 0, cut in two; `up`: normals along z.
TriangleSurface plate(std::uint32_t n, double size, bool up, double shift = 0.0) {
  TriangleSurface s;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= n; ++i) s.vertices.push_back({shift + size * i / n, shift + size * j / n, 0.0});
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
      s.triangles.push_back(up ? Triangle{a, b, c} : Triangle{a, c, b});
      s.triangles.push_back(up ? Triangle{a, c, d} : Triangle{a, d, c});
    }
  return s;
}

/// Ring about z: meshed with m x n quadrilaterals.
TriangleSurface torus(double ring, double tube, std::uint32_t m, std::uint32_t n) {
  TriangleSurface s;
  for (std::uint32_t i = 0; i < m; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const double p = 2 * M_PI * i / m, t = 2 * M_PI * j / n, r = ring + tube * std::cos(t);
      s.vertices.push_back({r * std::cos(p), r * std::sin(p), tube * std::sin(t)});
    }
  for (std::uint32_t i = 0; i < m; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t i2 = (i + 1) % m, j2 = (j + 1) % n;
      s.triangles.push_back({i * n + j, i2 * n + j, i2 * n + j2});
      s.triangles.push_back({i * n + j, i2 * n + j2, i * n + j2});
    }
  return s;
}

/// dg of all candidates for a small motion, by the rows and by evaluating again.
double worst_derivative(const GapOperator& op, const Nodes& nodes, Random& random) {
  GapRows rows, moved;
  op.evaluate(nodes.x, rows);
  std::vector<Vec3> step;
  for (std::size_t k = 0; k < nodes.x.size(); ++k) step.push_back(testing::random_direction(random));
  const double h = 1e-7;
  std::vector<Vec3> there = nodes.x;
  for (std::size_t k = 0; k < there.size(); ++k) there[k] += h * step[k];
  op.evaluate(there, moved);
  REQUIRE(moved.gap.size() == rows.gap.size());
  double worst = 0.0;
  for (std::size_t c = 0; c < rows.gap.size(); ++c) {
    double dg = 0.0, sum = 0.0;
    for (std::uint32_t r = rows.begin[c]; r < rows.begin[c + 1]; ++r) {
      dg += rows.weight[r] * rows.normal[c].dot(step[rows.node[r]]);
      sum += rows.weight[r];
    }
    CHECK(std::abs(sum) < 1e-12);  // a common shift opens nothing: forces along the rows balance
    worst = std::max(worst, std::abs((moved.gap[c] - rows.gap[c]) / h - dg));
  }
  return worst;
}

}  // namespace

TEST_CASE("the nearest point found by the tree is that of a scan, before and after the surface moved",
          "[detection][surface]") {
  Random random(101, 0);
  TriangleSurface s = torus(1.0, 0.4, 24, 16);
  SurfaceTree tree(s.vertices, s.triangles);
  for (int round = 0; round < 3; ++round) {
    for (int k = 0; k < 300; ++k) {
      const Vec3 x = 1.8 * testing::random_point(random);
      double least = infinity;
      for (const Triangle& t : s.triangles)
        least =
            std::min(least, nearest_on_triangle(x, {s.vertices[t[0]], s.vertices[t[1]], s.vertices[t[2]]}).distance);
      const auto found = tree.nearest(s.vertices, x);
      CHECK(found.at.distance == least);
      CHECK((tree.nearest(s.vertices, x, 0.5 * least).triangle == NearestOnSurface::none));
    }
    for (Vec3& v : s.vertices) v += 0.1 * testing::random_direction(random);
    tree.refit(s.vertices);
  }
}

TEST_CASE("nodes over a plate have their height as the gap, on either side and beyond no band",
          "[detection][surface]") {
  Random random(102, 0);
  Nodes nodes;
  nodes.add(plate(5, 1.0, true), nodes.master);
  const std::size_t first = nodes.x.size();
  nodes.add(plate(7, 0.8, false, 0.1), nodes.slave);
  for (std::size_t k = first; k < nodes.x.size(); ++k) nodes.x[k].z() = random.uniform(-0.2, 0.2);
  GapRows rows;
  std::vector<GapSite> sites;
  NodeToSurface(nodes.x, nodes.master, nodes.slave, 0.15).evaluate(nodes.x, rows, &sites);
  std::size_t wanted = 0;
  for (std::size_t k = first; k < nodes.x.size(); ++k) wanted += std::abs(nodes.x[k].z()) <= 0.15;
  REQUIRE(rows.gap.size() == wanted);
  CHECK(wanted < nodes.x.size() - first);
  for (std::size_t c = 0; c < wanted; ++c) {
    CHECK(rows.gap[c] == Approx(nodes.x[sites[c].slave].z()).margin(1e-15));
    CHECK((rows.normal[c] - Vec3::UnitZ()).norm() < 1e-15);
  }
}

TEST_CASE("nodes at a ball have their distance from it, to the sagitta of its chords", "[detection][surface]") {
  Random random(103, 0);
  double before = 0.0;
  for (const std::uint32_t segments : {16u, 32u, 64u}) {
    Nodes nodes;
    nodes.add(tessellate(Sphere{1.0}, {segments}), nodes.master);
    nodes.add(tessellate(Sphere{0.05}, {8}), nodes.slave, {1.03 * testing::random_direction(random), {}});
    GapRows rows;
    std::vector<GapSite> sites;
    NodeToSurface(nodes.x, nodes.master, nodes.slave, 0.5).evaluate(nodes.x, rows, &sites);
    REQUIRE(!rows.gap.empty());
    double worst = 0.0;
    for (std::size_t c = 0; c < rows.gap.size(); ++c) {
      const Vec3& x = nodes.x[sites[c].slave];
      worst = std::max(worst, std::abs(rows.gap[c] - (x.norm() - 1.0)));
      CHECK(rows.normal[c].dot(x.normalized()) > 0.95);
    }
    const double sagitta = 1.0 - std::pow(std::cos(M_PI / segments), 2);  // of a chord quadrilateral's middle
    CHECK(worst < 1.1 * sagitta);
    if (before > 0.0) CHECK(worst < 0.5 * before);  // second order: a quarter per halving, 0.5 for the random place
    before = worst;
  }
}

TEST_CASE("points at a ring have the signed distance from its tube, inside and out", "[detection][surface]") {
  Random random(104, 0);
  const double ring = 1.0, tube = 0.3;
  Nodes nodes;
  nodes.add(torus(ring, tube, 160, 80), nodes.master);
  for (int k = 0; k < 300; ++k) {
    const auto at = static_cast<std::uint32_t>(nodes.x.size());
    const Vec3 x = Vec3(1.5, 1.5, 0.5).cwiseProduct(testing::random_point(random));
    for (int j = 0; j < 3; ++j) nodes.x.push_back(x + 1e-3 * testing::random_direction(random));
    nodes.slave.push_back({at, at + 1, at + 2});
  }
  GapRows rows;
  std::vector<GapSite> sites;
  NodeToSurface(nodes.x, nodes.master, nodes.slave, 2.0).evaluate(nodes.x, rows, &sites);
  REQUIRE(rows.gap.size() == 900);
  int inside = 0;
  for (std::size_t c = 0; c < 900; ++c) {
    const Vec3& x = nodes.x[sites[c].slave];
    const double exact = std::hypot(std::hypot(x.x(), x.y()) - ring, x.z()) - tube;
    CHECK(std::abs(rows.gap[c] - exact) < 1.3 * (1 - std::cos(M_PI / 160)) + 0.3 * (1 - std::cos(M_PI / 80)) + 1e-12);
    inside += rows.gap[c] < 0.0;
  }
  CHECK(inside > 20);
}

TEST_CASE("the rows are the derivative of the gap", "[detection][surface]") {
  Random random(105, 0);
  Nodes nodes;
  nodes.add(torus(1.0, 0.3, 24, 16), nodes.master);
  nodes.add(tessellate(Sphere{0.25}, {12}), nodes.slave, {{1.0, 0.2, 0.5}, testing::random_turn(random)});
  const NodeToSurface by_nodes(nodes.x, nodes.master, nodes.slave, 1.0);
  const SurfaceToSurface by_surface(nodes.x, nodes.master, nodes.slave, 1.0);
  CHECK(worst_derivative(by_nodes, nodes, random) < 1e-4);  // curvature of the distance: h / gap
  CHECK(worst_derivative(by_surface, nodes, random) < 1e-4);
}

TEST_CASE("constant pressure passes between flat surfaces of different meshes", "[detection][surface]") {
  // The patch test: p times the areas along the rows is p A on the slave, the same back on the master, with the moment
  // of a uniform pressure; node-to-surface fails it on these meshes in the single forces, not in the sum.
  Nodes nodes;
  nodes.add(plate(5, 1.0, true), nodes.master);
  const std::size_t first = nodes.x.size();
  nodes.add(plate(7, 0.6, false, 0.2), nodes.slave);
  for (std::size_t k = first; k < nodes.x.size(); ++k) nodes.x[k].z() = 0.01;
  GapRows rows;
  std::vector<GapSite> sites;
  SurfaceToSurface(nodes.x, nodes.master, nodes.slave, 0.1).evaluate(nodes.x, rows, &sites);
  REQUIRE(rows.gap.size() == 3 * nodes.slave.size());
  const double pressure = 2.5;
  std::vector<double> force(nodes.x.size(), 0.0);
  for (std::size_t c = 0; c < rows.gap.size(); ++c) {
    CHECK(rows.gap[c] == Approx(0.01).epsilon(1e-13));
    for (std::uint32_t r = rows.begin[c]; r < rows.begin[c + 1]; ++r)
      force[rows.node[r]] += pressure * sites[c].area * rows.weight[r];
  }
  double on_slave = 0.0, on_master = 0.0;
  Vec3 moment = Vec3::Zero();
  for (std::size_t k = 0; k < force.size(); ++k) {
    (k < first ? on_master : on_slave) += force[k];
    moment += (nodes.x[k] - Vec3(0.5, 0.5, 0.0)).cross(force[k] * Vec3::UnitZ());
  }
  CHECK(on_slave == Approx(pressure * 0.36).epsilon(1e-13));
  CHECK(on_master == Approx(-pressure * 0.36).epsilon(1e-13));
  CHECK(moment.norm() < 1e-13);
  // On an inner slave node: the pressure times a third of the six triangles around it.
  const double square = std::pow(0.6 / 7, 2);
  CHECK(force[first + 3 * 8 + 3] == Approx(pressure * square).epsilon(1e-12));
}
