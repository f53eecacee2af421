#include "laws/nonsmooth/solvers/avbd.h"

#include "laws/factors.h"
#include "laws/nonsmooth/cone.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/newton.h"

namespace epafi {

namespace {
constexpr double first_k = 1.0, largest_k = 16.0;  // of 1 / W_ii, see the header
constexpr int judging_interval = 12;               // iterations before the bound is judged again
}  // namespace

/// Contacts of each body, in contact order.
void BodyDescent::list_contacts(const ConeProblem& p) {
  begin_.assign(p.bodies() + 1, 0);
  const auto each = [&](const auto& f) {
    for (std::uint32_t i = 0; i < p.size(); ++i)
      for (const std::uint32_t body : p.rows[i].body)
        if (body != ConeProblem::no_body) f(i, body);
  };
  each([&](std::uint32_t, std::uint32_t body) { ++begin_[body + 1]; });
  for (std::size_t b = 0; b < p.bodies(); ++b) begin_[b + 1] += begin_[b];
  contact_.resize(begin_.back());
  next_.assign(begin_.begin(), begin_.end() - 1);
  each([&](std::uint32_t i, std::uint32_t body) { contact_[next_[body]++] = i; });
}

void BodyDescent::move(const ConeProblem& p, std::uint32_t body) {
  Mat6 lhs = p.mass[body];
  Vec6 rhs = -(p.mass[body] * v_[body]);
  for (std::size_t c = begin_[body]; c < begin_[body + 1]; ++c) {
    const std::uint32_t i = contact_[c];
    const ConeProblem::Row& row = p.rows[i];
    const Mat63& h = row.jacobian[row.body[0] == body ? 0 : 1];
    const Vec3 x = lambda_[i] - k_[i] * (p.q[i] + p.relative(i, v_) + Vec3(shift_[i], 0.0, 0.0));
    rhs.noalias() += h * project_cone(x, p.friction[i]);
    lhs.noalias() += h * (k_[i] * project_cone_derivative(x, p.friction[i])) * h.transpose();
  }
  v_[body] += solve_llt(lhs, rhs);
}

void BodyDescent::raise(const ConeProblem& p) {
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec3 u = p.q[i] + p.relative(i, v_);
    lambda_[i] = project_cone(lambda_[i] - k_[i] * (u + Vec3(shift_[i], 0.0, 0.0)), p.friction[i]);
    shift_[i] = p.friction[i] * tangential_norm(u);
    if (lambda_[i].x() > 0.0) k_[i] = std::min(growth_ * k_[i], bound_ * weight_[i]);
  }
}

SolverReport BodyDescent::solve(const ConeProblem& problem, Impulses& r) {
  if (!problem.has_bodies()) return {false, 0, infinity};  // the local form knows no bodies
  const std::size_t n = problem.size();
  contact_weights(problem, weight_);
  list_contacts(problem);
  k_.resize(n);
  shift_.resize(n);
  lambda_ = r;
  problem.body_velocities(r, v_);
  problem.relative_velocities(r, work_, u_);
  for (std::size_t i = 0; i < n; ++i) {
    k_[i] = first_k * weight_[i];
    shift_[i] = problem.friction[i] * tangential_norm(u_[i]);
  }
  SolverReport report{false, 0, problem.residual(r, u_)};
  bound_ = largest_k;
  int judged = 0;
  while (report.residual > aim(report) && report.iterations < iterations_ && !(report.iterations % 8 == 0 && stop())) {
    ++report.iterations;
    for (std::uint32_t body = 0; body < problem.bodies(); ++body) move(problem, body);
    raise(problem);
    problem.relative_velocities(lambda_, work_, u_);
    const double residual = problem.residual(lambda_, u_);
    if (residual < report.residual) {
      report.residual = residual;
      r = lambda_;
      judged = report.iterations;
    }
    if (report.iterations - judged < judging_interval || residual < 4.0 * report.residual) continue;
    bound_ = std::max(1.0, 0.5 * bound_);  // the multipliers overshoot: back to the best
    judged = report.iterations;
    for (std::size_t i = 0; i < n; ++i) k_[i] = std::min(k_[i], bound_ * weight_[i]);
    lambda_ = r;
    problem.body_velocities(r, v_);
  }
  report.converged = report.residual <= tolerance_;
  return report;
}

SolverEntry avbd_entry() {
  return solver_entry<BodyDescent>(
      "avbd", "augmented descent body by body, one 6 x 6 system each", "Giles, Diaz and Yuksel 2025", 50,
      Field{"growth", "", "", Kind::number, 1.2, {1, 10}, "factor of the penalty per iteration"});
}

}  // namespace epafi
