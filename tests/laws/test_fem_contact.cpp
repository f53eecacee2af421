// Finite elements against Hertz, and the three ways to enforce contact against what defines them.
#include <cmath>
#include <numbers>

#include "laws/wheel_rail/fem/elastic_block.h"
#include "laws/wheel_rail/fem/surface_contact.h"
#include "laws/wheel_rail/normal/hertz_ellipse.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

constexpr double nu = 0.3, modulus = 210e9 / 2.0 / (1.0 - nu * nu), A = 0.5 / 0.3, N = 80e3;  // a ball of 300 mm

struct Case {
  BlockMesh mesh;
  SurfaceProblem nodes, surface;
  Eigen::VectorXd tributary;
};

const Case& ball_on_block(int across) {
  static std::vector<std::pair<int, Case>> made;
  for (const auto& [n, c] : made)
    if (n == across) return c;
  const double a = hertz_of_force(A, A, modulus, N).ellipse.a;
  Case c;
  c.mesh = make_block_mesh(0.0, 0.0, 1.25 * a, 1.25 * a, across, 1.6, 6.0);
  const Eigen::MatrixXd W = surface_flexibility(c.mesh, modulus * (1.0 - nu * nu), nu), M = surface_mass(c.mesh);
  const auto n = static_cast<Eigen::Index>(c.mesh.candidates());
  Eigen::VectorXd gap(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(k);
    gap[k] = A * (std::pow(c.mesh.candidate_x(i), 2) + std::pow(c.mesh.candidate_y(i), 2));
  }
  c.tributary = M.rowwise().sum();
  c.nodes = {W, gap, Eigen::VectorXd::Ones(n), Eigen::VectorXd::Ones(n)};
  c.surface = {M * W * M, M * gap, c.tributary, c.tributary};
  made.emplace_back(across, std::move(c));
  return made.back().second;
}

}  // namespace

TEST_CASE("multipliers carry the load, penalties penetrate by force over stiffness, augmentation closes the gap",
          "[laws][wheel_rail][fem]") {
  const Case& c = ball_on_block(6);
  for (const SurfaceProblem* s : {&c.nodes, &c.surface}) {
    const double penalty = s == &c.nodes ? 1e11 : 1e16;
    const SurfaceContact exact = solve_surface_contact(*s, {true, N}, Enforcement::lagrange, 0.0);
    CHECK(exact.report.converged);
    CHECK(exact.force == Approx(N).epsilon(1e-8));
    CHECK(exact.penetration < 1e-10 * exact.approach);
    const SurfaceContact soft = solve_surface_contact(*s, {true, N}, Enforcement::penalty, penalty);
    CHECK(soft.force == Approx(N).epsilon(1e-8));
    const Eigen::VectorXd g = s->gap + s->W * soft.p - soft.approach * s->level;
    for (Eigen::Index i = 0; i < g.size(); ++i)
      if (soft.p[i] > 0.0) CHECK(-g[i] / s->level[i] == Approx(soft.p[i] / penalty).epsilon(1e-6));
    CHECK(soft.penetration == Approx(soft.p.maxCoeff() / penalty).epsilon(1e-6));
    const SurfaceContact closed = solve_surface_contact(*s, {true, N}, Enforcement::augmented_lagrangian, penalty);
    CHECK(closed.report.converged);
    CHECK(closed.penetration < 1e-10 * closed.approach);
    CHECK((closed.p - exact.p).norm() < 1e-8 * exact.p.norm());
    // by approach: the force that made it
    CHECK(solve_surface_contact(*s, {false, exact.approach}, Enforcement::lagrange, 0.0).force ==
          Approx(N).epsilon(1e-9));
  }
}

TEST_CASE("a ball on a block of hexahedra comes within 2 % of Hertz and nearer on finer meshes",
          "[laws][wheel_rail][fem][long]") {
  const HertzContact h = hertz_of_force(A, A, modulus, N);
  double last = 1.0;
  for (const int n : {4, 6, 8}) {
    const Case& c = ball_on_block(n);
    const SurfaceContact s = solve_surface_contact(c.nodes, {true, N}, Enforcement::lagrange, 0.0);
    // pressures at the nodes against the half sphere, in the mean: peak and edge alike
    double error = 0.0, size = 0.0;
    for (Eigen::Index k = 0; k < s.p.size(); ++k) {
      const auto i = static_cast<std::size_t>(k);
      const double r2 =
          (std::pow(c.mesh.candidate_x(i), 2) + std::pow(c.mesh.candidate_y(i), 2)) / (h.ellipse.a * h.ellipse.a);
      const double p = r2 < 1.0 ? h.max_pressure * std::sqrt(1.0 - r2) : 0.0, w = c.tributary[k];
      error += w * std::pow(s.p[k] / w - p, 2);
      size += w * p * p;
    }
    error = std::sqrt(error / size);
    CHECK(error < last);
    last = error;
    if (n == 8) CHECK(s.approach == Approx(h.approach).epsilon(0.02));
  }
  CHECK(last < 0.12);
}

TEST_CASE("the approach of a ball converges to Hertz with the second order of trilinear elements",
          "[laws][wheel_rail][fem][slow]") {
  // Elements everywhere grow finer, those outside too: growth^(1/2) for half the cell. The edge of a circle on squares
  // scatters the errors, so all meshes are fitted; the far faces (6 times the patch) leave 1e-3.
  const HertzContact h = hertz_of_force(A, A, modulus, N);
  double sx = 0, sy = 0, sxx = 0, sxy = 0, q = 0, qq = 0, e = 0, qe = 0, count = 0, peak = 0;
  for (int n = 4; n <= 10; ++n) {
    const BlockMesh mesh =
        make_block_mesh(0.0, 0.0, 1.25 * h.ellipse.a, 1.25 * h.ellipse.a, n, std::pow(1.5, 8.0 / n), 6.0);
    const auto size = static_cast<Eigen::Index>(mesh.candidates());
    SurfaceProblem p{surface_flexibility(mesh, modulus * (1.0 - nu * nu), nu), Eigen::VectorXd(size),
                     Eigen::VectorXd::Ones(size), Eigen::VectorXd::Ones(size)};
    for (Eigen::Index k = 0; k < size; ++k) {
      const auto i = static_cast<std::size_t>(k);
      p.gap[k] = A * (std::pow(mesh.candidate_x(i), 2) + std::pow(mesh.candidate_y(i), 2));
    }
    const SurfaceContact s = solve_surface_contact(p, {true, N}, Enforcement::lagrange, 0.0);
    const double error = s.approach / h.approach - 1.0, cell = 2.5 / n;
    const double x = std::log(cell), y = std::log(std::abs(error)), square = cell * cell;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
    count += 1.0;
    q += square;
    qq += square * square;
    e += error;
    qe += square * error;
    const Eigen::VectorXd tributary = surface_mass(mesh).rowwise().sum();
    if (n == 10) peak = s.p.cwiseQuotient(tributary).maxCoeff();
  }
  const double order = (count * sxy - sx * sy) / (count * sxx - sx * sx),
               limit = (e * qq - q * qe) / (count * qq - q * q);
  WARN("order " << order << ", limit of the approach " << 100.0 * limit << " % from Hertz, peak "
                << 100.0 * (peak / h.max_pressure - 1.0) << " %");
  CHECK(order == Approx(2.0).margin(0.8));
  CHECK(std::abs(limit) < 5e-3);
  CHECK(peak == Approx(h.max_pressure).epsilon(0.01));
}

TEST_CASE("pressures on hexahedra converge to Hertz with the first order of their edge",
          "[laws][wheel_rail][fem][slow]") {
  // p falls like a root at the edge, which lies anywhere within an element: a band of width h is wrong by sqrt(h), in
  // the mean square h. The edge of a circle on squares scatters the errors: the slope of all meshes counts.
  const HertzContact h = hertz_of_force(A, A, modulus, N);
  double sx = 0, sy = 0, sxx = 0, sxy = 0, count = 0;
  for (const int n :
       {12, 13, 16, 17, 20, 21, 24, 25}) {  // twice the elements across, and one where the edge is shifted
    const double cells = 0.25 * (n / 4 * 4) - (n % 4 ? 0.3 : 0.6), a = h.ellipse.a;
    const int across = n / 4 * 2;
    const double half = 0.5 * across / cells * a;
    const BlockMesh mesh = make_block_mesh(0.0, 0.0, half, half, across, 1.7, 5.0);
    const Eigen::VectorXd tributary = surface_mass(mesh).rowwise().sum();
    SurfaceProblem p{surface_flexibility(mesh, modulus * (1.0 - nu * nu), nu), tributary,
                     Eigen::VectorXd::Ones(tributary.size()), Eigen::VectorXd::Ones(tributary.size())};
    const auto r2 = [&](Eigen::Index k) {
      const auto i = static_cast<std::size_t>(k);
      return std::pow(mesh.candidate_x(i), 2) + std::pow(mesh.candidate_y(i), 2);
    };
    for (Eigen::Index k = 0; k < p.gap.size(); ++k) p.gap[k] = A * r2(k);
    const SurfaceContact s = solve_surface_contact(p, {true, N}, Enforcement::lagrange, 0.0);
    double error = 0.0, size = 0.0;
    for (Eigen::Index k = 0; k < s.p.size(); ++k) {
      const double exact = h.max_pressure * std::sqrt(std::max(0.0, 1.0 - r2(k) / (a * a))), w = tributary[k];
      error += w * std::pow(s.p[k] / w - exact, 2);
      size += w * exact * exact;
    }
    const double x = -std::log(cells), y = 0.5 * std::log(error / size);
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
    count += 1.0;
  }
  const double order = (count * sxy - sx * sy) / (count * sxx - sx * sx);
  WARN("order " << order);
  CHECK(order > 0.6);
  CHECK(order < 1.4);
}

TEST_CASE("stresses under a ball are those of Huber", "[laws][wheel_rail][fem][slow]") {
  // on the axis (Johnson 1985, eq. 3.45): s_z = -p0 / (1 + z^2/a^2), s_r = -p0 ((1 + nu)(1 - z/a atan(a/z)) - 1 / (2 (1
  // + z^2/a^2))); the largest equivalent stress is 0.62 p0 at 0.48 a
  const Case& c = ball_on_block(10);  // elements of a quarter of the radius
  const HertzContact h = hertz_of_force(A, A, modulus, N);
  const SurfaceContact s = solve_surface_contact(c.nodes, {true, N}, Enforcement::lagrange, 0.0);
  const BlockStress b = block_stresses(c.mesh, modulus * (1.0 - nu * nu), nu, s.p);
  const auto& m = b.mesh;
  const std::size_t i = (m.x.size() - 1) / 2, j = (m.y.size() - 1) / 2;  // the element beside the axis
  double largest = 0.0;
  for (std::size_t k = 0; k + 1 < m.z.size(); ++k) {
    const double z = 0.5 * (m.z[k] + m.z[k + 1]) / h.ellipse.a, f = 1.0 / (1.0 + z * z);
    const std::size_t e = b.element(i, j, k);
    if (z > 2.0) continue;
    CHECK(b.stress[e][2] == Approx(-h.max_pressure * f).margin(0.06 * h.max_pressure));
    const double side = -h.max_pressure * ((1.0 + nu) * (1.0 - z * std::atan(1.0 / z)) - 0.5 * f);
    CHECK(b.stress[e][0] == Approx(side).margin(0.08 * h.max_pressure));
    largest = std::max(largest, b.von_mises(e));
  }
  CHECK(largest == Approx(0.62 * h.max_pressure).epsilon(0.08));
  // the middle of the surface goes in by about the approach; far nodes as a point force has it
  const std::size_t top = (m.y.size() / 2) * m.x.size() + m.x.size() / 2;
  CHECK(b.displacement[top][2] == Approx(s.approach).epsilon(0.02));
}

TEST_CASE("the flexibility of the block is symmetric and far from the force that of a half-space",
          "[laws][wheel_rail][fem]") {
  const Case& c = ball_on_block(6);
  const auto& W = c.nodes.W;
  // the far faces follow a force in the middle, whoever is loaded: the asymmetry measures what that costs
  CHECK((W - W.transpose()).norm() < 2e-3 * W.norm());
  const Eigen::Index n = W.rows(), corner = 0, other = n - 1;
  const double r = std::hypot(c.mesh.candidate_x(0) - c.mesh.candidate_x(static_cast<std::size_t>(other)),
                              c.mesh.candidate_y(0) - c.mesh.candidate_y(static_cast<std::size_t>(other)));
  CHECK(W(corner, other) == Approx(1.0 / (std::numbers::pi * modulus * r)).epsilon(0.03));  // Boussinesq: 1 / (pi E* r)
}
