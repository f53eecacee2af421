#include "laws/nonsmooth/solvers/admm.h"

#include <algorithm>

#include "laws/nonsmooth/cone.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/newton.h"

namespace epafi {

namespace {
constexpr double first_rho = 1.0, least_rho = 1e-6, largest_rho = 1e9;
constexpr int balance_every = 10;
constexpr double balance = 5.0;  // ratio of the residuals that calls for another rho
}  // namespace

bool Admm::factor(const ConeProblem& problem) {
  for (std::size_t i = 0; i < problem.size(); ++i) d_[i] = rho_ * weight_[i] * Mat3::Identity();
  return factor_.factor(d_);
}

void Admm::iterate(const ConeProblem& problem, Impulses& r, double& primal, double& dual) {
  const std::size_t n = problem.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double shift = problem.friction[i] * tangential_norm(u_[i]);
    const Vec3 wanted = y_[i] - problem.q[i] - Vec3(shift, 0.0, 0.0);
    b_[i] = r[i] + rho_ * weight_[i] * wanted;
  }
  factor_.solve(b_, lambda_, w_lambda_);
  primal = dual = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    const double k = rho_ * weight_[i], shift = problem.friction[i] * tangential_norm(u_[i]);
    u_[i] = problem.q[i] + w_lambda_[i];
    if (k <= 0.0) continue;
    const Vec3 t = r[i] - k * (u_[i] + Vec3(shift, 0.0, 0.0));
    const Vec3 next = project_cone(t, problem.friction[i]), y = (next - t) / k;
    primal += (next - r[i]).squaredNorm() / weight_[i];
    dual += (k * k) * (y - y_[i]).squaredNorm() / weight_[i];
    r[i] = next;
    y_[i] = y;
  }
}

SolverReport Admm::solve(const ConeProblem& problem, Impulses& r) {
  const std::size_t n = problem.size();
  problem.relative_velocities(r, v_, u_);
  SolverReport report{false, 0, problem.residual(r, u_)};
  best_ = r;
  contact_weights(problem, weight_);
  d_.resize(n);
  b_.resize(n);
  y_.assign(n, Vec3::Zero());
  for (std::size_t i = 0; i < n; ++i)
    y_[i] = project_dual_cone(de_saxce(u_[i], problem.friction[i]), problem.friction[i]);
  rho_ = first_rho;
  if (report.residual > aim(report)) factor_.attach(problem);
  bool sound = report.residual <= aim(report) || factor(problem);
  while (sound && report.residual > aim(report) && report.iterations < iterations_ && !stop()) {
    double primal = 0.0, dual = 0.0;
    iterate(problem, r, primal, dual);
    ++report.iterations;
    problem.relative_velocities(r, v_, true_u_);
    const double residual = problem.residual(r, true_u_);
    if (residual < report.residual) {
      report.residual = residual;
      best_ = r;
    }
    if (report.iterations % balance_every != 0) continue;
    const double ratio = std::sqrt(primal / std::max(dual, 1e-300));
    if (ratio > balance || ratio < 1.0 / balance) {
      rho_ = std::clamp(rho_ * std::clamp(ratio, 0.01, 100.0), least_rho, largest_rho);
      sound = factor(problem);
    }
  }
  r = best_;
  report.converged = report.residual <= tolerance_;
  return report;
}

SolverEntry admm_entry() {
  return solver_entry<Admm>(
      "admm", "alternating directions with the De Saxce shift, one sparse factorisation per change of rho",
      "Carpentier, Le Lidec and Montaut 2024", 500);
}

}  // namespace epafi
