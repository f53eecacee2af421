/// Iterative methods for linear complementarity problems.
#include <cmath>

#include "laws/factors.h"
#include "laws/nonsmooth/lcp.h"

namespace epafi {

namespace {

using Index = Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double scale_of(const LcpProblem& p) { return p.q.size() > 0 ? std::max(1e-300, p.q.cwiseAbs().maxCoeff()) : 1.0; }
bool late(const LcpSettings& s) { return s.interrupted && s.interrupted(); }

LcpReport report_of(const LcpProblem& p, const LcpSettings& s, int iterations, const VectorXd& z, bool limit) {
  const double residual = lcp_residual(p, z);
  if (residual <= s.tolerance * scale_of(p)) return {LcpStatus::solved, iterations, residual};
  return {limit ? LcpStatus::limit : LcpStatus::stalled, iterations, residual};
}

void start(const LcpProblem& p, VectorXd& z) {
  if (z.size() != p.q.size()) z = VectorXd::Zero(p.q.size());
  z = z.cwiseMax(0.0);
}

/// Fischer-Burmeister values of (z, w).
VectorXd fischer(const VectorXd& z, const VectorXd& w) {
  return z + w - (z.array().square() + w.array().square()).sqrt().matrix();
}

/// Rows a_i dz_i + b_i (M dz)_i = -f_i of a Newton step; `minimum` picks the smaller of z and w.
VectorXd newton_step(const LcpProblem& p, const VectorXd& z, const VectorXd& w, bool minimum, double damping) {
  const Index n = z.size();
  MatrixXd jacobian(n, n);
  VectorXd f(n);
  for (Index i = 0; i < n; ++i) {
    double a = 1.0, b = 0.0;
    if (minimum) {
      a = z[i] <= w[i] ? 1.0 : 0.0;
      b = 1.0 - a;
      f[i] = std::min(z[i], w[i]);
    } else {
      const double norm = std::hypot(z[i], w[i]);
      a = norm > 0.0 ? 1.0 - z[i] / norm : 1.0 - M_SQRT1_2;
      b = norm > 0.0 ? 1.0 - w[i] / norm : 1.0 - M_SQRT1_2;
      f[i] = z[i] + w[i] - norm;
    }
    jacobian.row(i) = b * p.M.row(i);
    // degenerate problems make the rows of M dependent: damping picks the short step
    jacobian(i, i) += a + damping * b * std::abs(p.M(i, i));
  }
  return solve_lu(jacobian, VectorXd(-f));
}

/// Newton with backtracking on the Fischer-Burmeister merit; its gradient where the Newton direction fails.
LcpReport semismooth(const LcpProblem& p, const LcpSettings& s, VectorXd& z, bool minimum) {
  start(p, z);
  VectorXd w = p.M * z + p.q;
  double damping = 1e-10;
  int k = 0;
  const auto merit = [&](const VectorXd& x, const VectorXd& y) { return 0.5 * fischer(x, y).squaredNorm(); };
  for (; k < s.iterations && !late(s); ++k) {
    if (z.cwiseMin(w).cwiseAbs().maxCoeff() <= s.tolerance * scale_of(p)) break;
    const double before = merit(z, w);
    bool moved = false;
    for (int attempt = 0; attempt < 3 && !moved; ++attempt, damping *= 100.0) {
      const VectorXd d = newton_step(p, z, w, minimum && attempt == 0, damping);
      if (!d.allFinite()) continue;
      const VectorXd dw = p.M * d;
      double t = 1.0;
      for (int h = 0; h < 30 && !moved; ++h, t *= 0.5) moved = merit(z + t * d, w + t * dw) < (1.0 - 1e-4 * t) * before;
      if (moved) z += 2.0 * t * d;
    }
    if (!moved) break;
    damping = std::max(1e-12, damping * 1e-3);
    w = p.M * z + p.q;
  }
  z = z.cwiseMax(0.0);
  return report_of(p, s, k, z, k >= s.iterations || late(s));
}

}  // namespace

LcpReport newton_min(const LcpProblem& p, const LcpSettings& s, VectorXd& z) { return semismooth(p, s, z, true); }
LcpReport fischer_burmeister(const LcpProblem& p, const LcpSettings& s, VectorXd& z) {
  return semismooth(p, s, z, false);
}

LcpReport projected_gauss_seidel(const LcpProblem& p, const LcpSettings& s, VectorXd& z) {
  start(p, z);
  int k = 0;
  for (; k < s.iterations && !late(s); ++k) {
    for (Index i = 0; i < z.size(); ++i)
      if (p.M(i, i) > 0.0) z[i] = std::max(0.0, z[i] - (p.M.row(i).dot(z) + p.q[i]) / p.M(i, i));
    if (!z.allFinite()) z.setZero();
    if (k % 8 == 7 && lcp_residual(p, z) <= s.tolerance * scale_of(p)) break;
  }
  return report_of(p, s, k, z, true);
}

LcpReport projected_gradient(const LcpProblem& p, const LcpSettings& s, VectorXd& z) {
  start(p, z);
  const double largest = p.M.cwiseAbs().rowwise().sum().maxCoeff();  // bounds the eigenvalues
  VectorXd g = p.M * z + p.q;
  double step = 1.0 / largest;
  const auto value = [&](const VectorXd& x, const VectorXd& gradient) { return 0.5 * x.dot(gradient + p.q); };
  double best = value(z, g), recent = best;
  int k = 0;
  for (; k < s.iterations && !late(s); ++k) {
    if (z.cwiseMin(g).cwiseAbs().maxCoeff() <= s.tolerance * scale_of(p)) break;
    VectorXd next = (z - step * g).cwiseMax(0.0), g_next = p.M * next + p.q;
    if (value(next, g_next) > recent) {  // the long step went up: the safe one
      next = (z - g / largest).cwiseMax(0.0);
      g_next = p.M * next + p.q;
    }
    const VectorXd dz = next - z, dg = g_next - g;
    const double curvature = dz.dot(dg);
    step = curvature > 0.0 ? std::max(dz.squaredNorm() / curvature, 1.0 / largest) : 1.0 / largest;
    z = next;
    g = g_next;
    if (k % 10 == 9) recent = value(z, g);  // monotone over windows of ten
  }
  return report_of(p, s, k, z, k >= s.iterations || late(s));
}

LcpReport conjugate_projected_gradient(const LcpProblem& p, const LcpSettings& s, VectorXd& z) {
  start(p, z);
  const double safe = 1.0 / p.M.cwiseAbs().rowwise().sum().maxCoeff();
  VectorXd g = p.M * z + p.q, direction;
  const auto on_face = [&](const VectorXd& x) { return (z.array() > 0.0).select(x, 0.0).eval(); };
  const auto chopped = [&] { return (z.array() > 0.0).select(0.0, g.cwiseMin(0.0)).eval(); };
  direction = on_face(g);
  int k = 0;
  for (; k < s.iterations && !late(s); ++k) {
    if (z.cwiseMin(g).cwiseAbs().maxCoeff() <= s.tolerance * scale_of(p)) break;
    const VectorXd free = on_face(g);
    if (chopped().squaredNorm() > free.cwiseMin(z / safe).squaredNorm()) {  // the face is wrong: open it
      z = (z - safe * g).cwiseMax(0.0);
      g = p.M * z + p.q;
      direction = on_face(g);
      continue;
    }
    const VectorXd md = p.M * direction;
    const double curvature = direction.dot(md);
    if (!(curvature > 0.0)) {
      z = (z - safe * g).cwiseMax(0.0);
      g = p.M * z + p.q;
      direction = on_face(g);
      continue;
    }
    const double full = g.dot(direction) / curvature;
    double feasible = full;
    for (Index i = 0; i < z.size(); ++i)
      if (direction[i] > 0.0) feasible = std::min(feasible, z[i] / direction[i]);
    z -= feasible * direction;
    g -= feasible * md;
    if (feasible < full) {  // ran into the wall: project and start anew
      z = (z - safe * on_face(g)).cwiseMax(0.0);
      g = p.M * z + p.q;
      direction = on_face(g);
    } else {
      const VectorXd next = on_face(g);
      direction = next - next.dot(md) / curvature * direction;
    }
  }
  z = z.cwiseMax(0.0);
  return report_of(p, s, k, z, k >= s.iterations || late(s));
}

}  // namespace epafi
