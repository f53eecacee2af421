// The linear complementarity problems of case B06, by every method.
#include "laws/nonsmooth/lcp.h"

#include "laws/nonsmooth/cone_problem.h"
#include "tests/support/catch.h"
#include "tests/support/contact_worlds.h"

using namespace epafi;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

struct Method {
  const char* name;
  LcpMethod solve;
  bool symmetric_only;
};
const Method methods[] = {{"lemke", lemke, false},
                          {"dantzig", dantzig, true},
                          {"pgs", projected_gauss_seidel, true},
                          {"projected-gradient", projected_gradient, true},
                          {"conjugate-projected-gradient", conjugate_projected_gradient, true},
                          {"newton-min", newton_min, false},
                          {"fischer-burmeister", fischer_burmeister, false}};

MatrixXd murty(int n) {
  MatrixXd m = MatrixXd::Identity(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j) m(i, j) = 2.0;
  return m;
}
MatrixXd tridiagonal(int n, double below, double diagonal, double above) {
  MatrixXd m = MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i) {
    m(i, i) = diagonal;
    if (i > 0) m(i, i - 1) = below;
    if (i + 1 < n) m(i, i + 1) = above;
  }
  return m;
}
LcpReport run(const Method& method, const LcpProblem& p, VectorXd& z, int limit = 20000) {
  z = VectorXd::Zero(p.q.size());
  return method.solve(p, {limit, 1e-11, {}}, z);
}

}  // namespace

TEST_CASE("Murty's and Fathi's problems: z = (1, 0, ... 0), without the exponential run (B06)", "[laws][lcp][B06]") {
  for (const int n : {8, 16, 32, 64}) {
    const MatrixXd l = murty(n);
    const VectorXd minus = -VectorXd::Ones(n);
    const LcpProblem problems[] = {{l, minus}, {l * l.transpose(), minus}};
    for (int k = 0; k < 2; ++k)
      for (const Method& method : methods) {
        if (k == 0 && method.symmetric_only) continue;
        VectorXd z;
        const LcpReport report = run(method, problems[k], z);
        INFO(method.name << (k == 0 ? " murty " : " fathi ") << n << ": " << report.iterations << " residual "
                         << report.residual);
        const bool first_order = method.solve == projected_gauss_seidel || method.solve == projected_gradient;
        if (first_order && report.status != LcpStatus::solved) continue;  // cond(Fathi) grows like n^4: they say so
        CHECK(report.status == LcpStatus::solved);
        CHECK((z - VectorXd::Unit(n, 0)).cwiseAbs().maxCoeff() < 1e-8);
        CHECK(report.residual < 1e-10);
        if (method.solve == lemke || method.solve == dantzig) CHECK(report.iterations <= 4 * n);
      }
  }
}

TEST_CASE("tridiagonal problems by every method (B06)", "[laws][lcp][B06]") {
  const LcpProblem symmetric{tridiagonal(16, -1, 4, -1), -VectorXd::Ones(16)};
  const LcpProblem other{tridiagonal(16, 1, 4, -2), -VectorXd::Ones(16)};
  for (const Method& method : methods) {
    VectorXd z;
    INFO(method.name);
    CHECK(run(method, symmetric, z).residual < 1e-10);
    CHECK(z[0] == Approx(0.3660254).epsilon(1e-7));
    CHECK(z[8] == Approx(0.49998315).epsilon(1e-7));
    if (method.symmetric_only) continue;
    CHECK(run(method, other, z).residual < 1e-10);
    CHECK(z[0] == Approx(0.40824727).epsilon(1e-7));
    CHECK(z[15] == Approx(0.18350342).epsilon(1e-7));
  }
}

TEST_CASE("degenerate and rank-deficient problems are solved, an infeasible one is certified (B06)",
          "[laws][lcp][B06]") {
  for (const Method& method : methods) {
    INFO(method.name);
    VectorXd z;
    CHECK(run(method, {MatrixXd::Identity(4, 4), Eigen::Vector4d(0, 0, -1, 1)}, z).status == LcpStatus::solved);
    CHECK((z - VectorXd::Unit(4, 2)).norm() < 1e-10);
    CHECK(run(method, {MatrixXd::Ones(4, 4), -VectorXd::Ones(4)}, z).status == LcpStatus::solved);
    CHECK(z.sum() == Approx(1.0).epsilon(1e-10));
  }
  LcpProblem infeasible{MatrixXd::Zero(2, 2), -VectorXd::Ones(2)};
  infeasible.M(1, 1) = 1.0;
  VectorXd z;
  CHECK(run(methods[0], infeasible, z).status == LcpStatus::ray);
  CHECK(run(methods[1], infeasible, z).status == LcpStatus::ray);
  for (const Method& method : methods) CHECK(run(method, infeasible, z, 100).status != LcpStatus::solved);
}

TEST_CASE("Hilbert's matrix of condition 1e13 is solved in its residual (B06)", "[laws][lcp][B06]") {
  MatrixXd h(10, 10);
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) h(i, j) = 1.0 / (i + j + 1);
  const LcpProblem p{h, -h * VectorXd::Ones(10)};
  for (const Method& method : {methods[0], methods[1], methods[5], methods[6]}) {
    VectorXd z;
    const LcpReport report = run(method, p, z);
    INFO(method.name << " residual " << report.residual);
    CHECK(report.residual < 1e-10);  // z itself is known to cond * eps = 1e-3 only
  }
}

TEST_CASE("the rank-deficient LCP of a box stack is solved by pivoting, without a ray or a cycle (B06)",
          "[laws][lcp][B06]") {
  for (const int boxes : {5, 10, 20}) {
    ConeProblem blocks;
    blocks.load(test::stack_problem(boxes, 0.0));
    LcpProblem p{blocks.normal_matrix(), VectorXd(static_cast<Eigen::Index>(blocks.size()))};
    for (std::size_t i = 0; i < blocks.size(); ++i) p.q[static_cast<Eigen::Index>(i)] = blocks.q[i].x();
    for (const Method& method : {methods[0], methods[1], methods[4], methods[5], methods[6]}) {
      VectorXd z;
      const LcpReport report = run(method, p, z);
      INFO(method.name << " " << boxes << " boxes: " << report.iterations << " steps, residual " << report.residual);
      CHECK(report.residual < 1e-10);
      CHECK(z.head(4).sum() == Approx(boxes * 1000.0 * 9.81 / 240).epsilon(1e-7));
    }
  }
}
