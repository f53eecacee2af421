#include "laws/wheel_rail/fem/surface_contact.h"

#include <algorithm>
#include <vector>

#include "laws/factors.h"

namespace epafi {
namespace {

constexpr int most_rounds = 100, most_augmentations = 60;
constexpr double closed = 1e-10;  // penetration after augmentation, relative to the approach

/// One active-set solution with compliance c = 1/penalty in series (0: rigid) and multipliers `held` already applied.
bool solve_active(const SurfaceProblem& s, const NormalTarget& target, double c, const Eigen::VectorXd& held,
                  SurfaceContact& out) {
  const Eigen::Index n = s.gap.size();
  std::vector<bool> in(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) in[static_cast<std::size_t>(i)] = out.p[i] > 0.0;
  for (int round = 0; round < most_rounds; ++round) {
    ++out.report.iterations;
    std::vector<Eigen::Index> a;
    for (Eigen::Index i = 0; i < n; ++i)
      if (in[static_cast<std::size_t>(i)]) a.push_back(i);
    const auto m = static_cast<Eigen::Index>(a.size());
    if (m == 0) return false;
    Eigen::MatrixXd A(m, m);
    Eigen::MatrixXd b(m, 2);
    for (Eigen::Index i = 0; i < m; ++i) {
      for (Eigen::Index j = 0; j < m; ++j)
        A(i, j) = s.W(a[static_cast<std::size_t>(i)], a[static_cast<std::size_t>(j)]);
      const Eigen::Index I = a[static_cast<std::size_t>(i)];
      A(i, i) += c * s.level[I];
      b(i, 0) = s.level[I];
      b(i, 1) = -s.gap[I] + c * s.level[I] * held[I];
    }
    const Eigen::MatrixXd x = solve_lu(A, b);
    double f0 = 0.0, f1 = 0.0;
    for (Eigen::Index i = 0; i < m; ++i) {
      f0 += s.weight[a[static_cast<std::size_t>(i)]] * x(i, 0);
      f1 += s.weight[a[static_cast<std::size_t>(i)]] * x(i, 1);
    }
    out.approach = target.by_force ? (target.value - f1) / f0 : target.value;
    out.p.setZero();
    for (Eigen::Index i = 0; i < m; ++i) out.p[a[static_cast<std::size_t>(i)]] = out.approach * x(i, 0) + x(i, 1);
    const Eigen::VectorXd g = s.gap + s.W * out.p - out.approach * s.level;
    bool same = true;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (in[k] && out.p[i] < 0.0) {
        in[k] = false;
        same = false;
      } else if (!in[k] && g[i] - c * s.level[i] * held[i] < -1e-13 * out.approach * s.level[i]) {
        in[k] = true;
        same = false;
      }
    }
    if (same) return true;
  }
  return false;
}

}  // namespace

SurfaceContact solve_surface_contact(const SurfaceProblem& s, const NormalTarget& target, Enforcement method,
                                     double penalty) {
  SurfaceContact out;
  const Eigen::Index n = s.gap.size();
  out.p = Eigen::VectorXd::Ones(n);
  out.report = {true, 0, 0.0};
  Eigen::VectorXd held = Eigen::VectorXd::Zero(n);
  const double c = method == Enforcement::lagrange ? 0.0 : 1.0 / penalty;
  for (int k = 0; k < (method == Enforcement::augmented_lagrangian ? most_augmentations : 1); ++k) {
    out.report.converged = solve_active(s, target, c, held, out);
    const Eigen::VectorXd g = s.gap + s.W * out.p - out.approach * s.level;
    out.penetration = 0.0;
    for (Eigen::Index i = 0; i < n; ++i) out.penetration = std::max(out.penetration, -g[i] / s.level[i]);
    held = out.p;
    if (out.penetration < closed * out.approach) break;
  }
  if (method == Enforcement::augmented_lagrangian)
    out.report.converged = out.report.converged && out.penetration < closed * out.approach;
  out.force = s.weight.dot(out.p);
  out.report.residual = target.by_force ? std::abs(out.force / target.value - 1.0) : 0.0;
  return out;
}

}  // namespace epafi
