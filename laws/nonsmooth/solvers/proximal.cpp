#include "laws/nonsmooth/solvers/proximal.h"

#include <algorithm>

#include "laws/nonsmooth/alart_curnier.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/newton.h"

namespace epafi {

namespace {

constexpr double first_weight = 1e3, least_weight = 1e-2, largest_weight = 1e9;
constexpr int inner_limit = 12, halvings = 6;

}  // namespace

double Proximal::defect(const std::vector<Vec3>& r, const std::vector<Vec3>& u, std::vector<Vec3>& f) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    f[i] = alart_curnier(z_[i], u[i], problem_->friction[i], rho_ * weight_[i]) - r[i];
    sum += f[i].squaredNorm();
  }
  return std::sqrt(sum);
}

bool Proximal::advance(double& norm) {
  double t = 1.0;
  for (int k = 0; k < halvings; ++k, t *= 0.5) {
    for (std::size_t i = 0; i < r_.size(); ++i) {
      r_try_[i] = r_[i] + t * step_[i];
      u_try_[i] = u_[i] + t * du_[i];
    }
    const double trial = defect(r_try_, u_try_, f_try_);
    if (!(trial <= (1.0 - 0.1 * t) * norm)) continue;
    r_.swap(r_try_);
    u_.swap(u_try_);
    f_.swap(f_try_);
    norm = trial;
    return true;
  }
  return false;
}

/// The proximal problem of z to a tenth of the way from z to its solution.
Proximal::Inner Proximal::solve_inner(SolverReport& report, int& steps) {
  const std::size_t n = z_.size();
  r_ = z_;
  double norm = defect(r_, u_, f_);
  const double first = norm, rounding = 1e-13 * problem_->scale * problem_->q_norm();
  for (steps = 1; steps <= inner_limit && report.iterations < iterations_ && !stop(); ++steps) {
    for (std::size_t i = 0; i < n; ++i)
      d_[i] = alart_curnier_slope(z_[i], u_[i], problem_->friction[i], rho_ * weight_[i]);
    ++report.iterations;
    if (!factor_.factor(d_, false)) return Inner::failed;
    factor_.solve(f_, step_, du_);
    if (!advance(norm)) return Inner::failed;
    double move = 0.0;
    for (std::size_t i = 0; i < n; ++i) move += (r_[i] - z_[i]).squaredNorm();
    if (norm <= 0.1 * std::sqrt(move) || norm <= rounding) return Inner::solved;
  }
  return norm < 0.5 * first ? Inner::progress : Inner::failed;
}

/// Sweeps z; takes them back where they lead away from the solution (strong friction on a tilted W: A27).
void Proximal::smooth(int sweeps) {
  problem_->relative_velocities(z_, v_, u_);
  const double before = problem_->residual(z_, u_);
  r_try_ = z_;
  u_try_ = u_;
  sweep_.start(z_);
  for (int k = 0; k < sweeps; ++k) {
    sweep_.run(PgsRule{}, z_);
    if (k % 16 == 15 && stop()) break;
  }
  problem_->relative_velocities(z_, v_, u_);
  residual_ = problem_->residual(z_, u_);
  if (residual_ <= 3.0 * before) return;  // a rise that Newton undoes: piles need it
  z_.swap(r_try_);
  u_.swap(u_try_);
  residual_ = before;
}

void Proximal::load(const ConeProblem& problem) {
  problem_ = &problem;
  factor_.attach(problem);
  sweep_.load(problem);
  contact_weights(problem, weight_);
  const std::size_t n = problem.size();
  f_.resize(n);
  f_try_.resize(n);
  r_try_.resize(n);
  u_try_.resize(n);
  d_.resize(n);
  // a contact update costs about 80 multiplications in body form; assembly of its D about 700
  const double sweep =
      problem.has_bodies() ? 80.0 * static_cast<double>(n) : 9.0 * static_cast<double>(problem.column.size());
  const double step = 2.0 * factor_.work() + 700.0 * static_cast<double>(n);
  sweeps_ = static_cast<int>(std::clamp(step / sweep, 4.0, 100.0));
}

SolverReport Proximal::solve(const ConeProblem& problem, Impulses& r) {
  load(problem);
  z_ = r;
  rho_ = first_weight;
  problem.relative_velocities(r, v_, u_);
  residual_ = problem.residual(r, u_);
  SolverReport report{false, 0, residual_};
  best_ = r;
  const auto keep = [&] {
    if (residual_ < report.residual) {
      report.residual = residual_;
      best_ = z_;
    }
  };
  if (report.residual > aim(report)) {
    smooth(sweeps_);
    keep();
  }
  while (report.residual > aim(report) && report.iterations < iterations_ && !stop()) {
    int steps = 0;
    const Inner inner = solve_inner(report, steps);
    if (inner != Inner::failed)
      for (std::size_t i = 0; i < z_.size(); ++i) z_[i] = project_cone(r_[i], problem.friction[i]);
    smooth(sweeps_);
    keep();
    if (inner == Inner::solved)
      rho_ = std::min(rho_ * (steps <= 2 ? 2.0 : steps <= 4 ? 1.5 : 1.2), largest_weight);
    else
      rho_ = std::max(0.5 * rho_, least_weight);
  }
  r = best_;
  report.converged = report.residual <= tolerance_;
  return report;
}

SolverEntry proximal_entry() {
  return solver_entry<Proximal>(
      "proximal",
      "proximal point with a semismooth Newton method on the Alart-Curnier map inside; sparse LU, with sweeps",
      "Alart and Curnier 1991; Acary, Bremond and Huber 2018", 50);
}

}  // namespace epafi
