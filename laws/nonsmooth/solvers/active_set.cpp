#include "laws/nonsmooth/solvers/active_set.h"

#include "laws/nonsmooth/alart_curnier.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/newton.h"

namespace epafi {

namespace {
constexpr double stiff = 1e10;  // 1 / regularisation of the multipliers, relative to W_ii
}

std::size_t ActiveSet::choose(const ConeProblem& p, const Impulses& r) {
  std::size_t changes = 0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    const Vec3 x = r[i] - weight_[i] * u_[i];
    State state = State::open;
    if (weight_[i] > 0.0 && x.x() > 0.0)
      state = tangential_norm(x) <= p.friction[i] * x.x() ? State::stick : State::slide;
    changes += state != state_[i];
    state_[i] = state;
    const double t = tangential_norm(x);
    direction_[i] = t > 0.0 ? Vec3(0.0, x.y() / t, x.z() / t) : Vec3::Zero();
  }
  return changes;
}

/// (I + D W) dr = b: open r + dr = 0, stick u + du = 0, slide u_N + du_N = 0 with r_T + dr_T = mu (r_N + dr_N) e.
void ActiveSet::assemble(const ConeProblem& p, const Impulses& r) {
  for (std::size_t i = 0; i < r.size(); ++i) {
    d_[i].setZero();
    const double k = stiff * weight_[i];
    if (state_[i] == State::open) {
      b_[i] = -r[i];
    } else if (state_[i] == State::stick) {
      d_[i] = k * Mat3::Identity();
      b_[i] = -k * u_[i];
    } else {
      const Vec3 e = p.friction[i] * direction_[i];
      d_[i].col(0) = k * (Vec3::UnitX() + e);
      const double normal = -k * u_[i].x();
      b_[i] = normal * Vec3::UnitX() + (r[i].x() + normal) * e - Vec3(0.0, r[i].y(), r[i].z());
    }
  }
}

SolverReport ActiveSet::solve(const ConeProblem& problem, Impulses& r) {
  const std::size_t n = problem.size();
  problem.relative_velocities(r, v_, u_);
  SolverReport report{false, 0, problem.residual(r, u_)};
  best_ = r;
  factor_.attach(problem);
  contact_weights(problem, weight_);
  state_.assign(n, State::open);
  direction_.resize(n);
  d_.resize(n);
  b_.resize(n);
  int unchanged = 0;
  while (report.residual > aim(report) && report.iterations < iterations_ && unchanged < 5 && !stop()) {
    unchanged = choose(problem, r) == 0 ? unchanged + 1 : 0;
    assemble(problem, r);
    ++report.iterations;
    if (!factor_.factor(d_, false)) break;
    factor_.solve(b_, step_, du_);
    for (std::size_t i = 0; i < n; ++i) r[i] = project_cone(r[i] + step_[i], problem.friction[i]);
    problem.relative_velocities(r, v_, u_);
    const double residual = problem.residual(r, u_);
    if (residual < report.residual) {
      report.residual = residual;
      best_ = r;
    }
  }
  r = best_;
  report.converged = report.residual <= tolerance_;
  return report;
}

double Penalty::defect(const ConeProblem& p, const Impulses& r, const std::vector<Vec3>& u,
                       std::vector<Vec3>& f) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < r.size(); ++i) {
    f[i] = alart_curnier(Vec3::Zero(), u[i], p.friction[i], stiffness_ * weight_[i]) - r[i];
    sum += f[i].squaredNorm();
  }
  return std::sqrt(sum);
}

SolverReport Penalty::solve(const ConeProblem& problem, Impulses& r) {
  const std::size_t n = problem.size();
  factor_.attach(problem);
  contact_weights(problem, weight_);
  problem.relative_velocities(r, v_, u_);
  f_.resize(n);
  f_try_.resize(n);
  r_try_.resize(n);
  u_try_.resize(n);
  d_.resize(n);
  SolverReport report{false, 0, 0.0};
  double norm = defect(problem, r, u_, f_);
  const double enough = 1e-12 * norm;
  while (norm > enough && report.iterations < iterations_ && !stop()) {
    for (std::size_t i = 0; i < n; ++i)
      d_[i] = alart_curnier_slope(Vec3::Zero(), u_[i], problem.friction[i], stiffness_ * weight_[i]);
    ++report.iterations;
    if (!factor_.factor(d_, false)) break;
    factor_.solve(f_, step_, du_);
    double t = 1.0, trial = 0.0;
    for (int k = 0; k < 12; ++k, t *= 0.5) {
      for (std::size_t i = 0; i < n; ++i) {
        r_try_[i] = r[i] + t * step_[i];
        u_try_[i] = u_[i] + t * du_[i];
      }
      trial = defect(problem, r_try_, u_try_, f_try_);
      if (trial < (1.0 - 0.01 * t) * norm) break;
    }
    if (!(trial < norm)) break;
    r.swap(r_try_);
    u_.swap(u_try_);
    f_.swap(f_try_);
    norm = trial;
  }
  for (std::size_t i = 0; i < n; ++i) r[i] = project_cone(r[i], problem.friction[i]);
  problem.relative_velocities(r, v_, u_);
  report.residual = problem.residual(r, u_);
  report.converged = report.residual <= tolerance_;
  return report;
}

SolverEntry lagrange_entry() {
  return solver_entry<ActiveSet>("lagrange",
                                 "Lagrange multipliers: the KKT system of the closed contacts, with an active set",
                                 "Wriggers 2006", 50);
}

SolverEntry penalty_entry() {
  return solver_entry<Penalty>("penalty", "implicit penalty: contacts are springs and dashpots of finite stiffness",
                               "Wriggers 2006", 50,
                               Field{"stiffness", "rho", "", Kind::number, 1e4, positive, "relative to 1 / W_ii"});
}

}  // namespace epafi
