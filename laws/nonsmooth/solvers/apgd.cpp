#include "laws/nonsmooth/solvers/apgd.h"

#include "engine/threads/order_free_sum.h"
#include "laws/nonsmooth/cone.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/newton.h"

namespace epafi {

void ProjectedGradient::descend(const ConeProblem& problem) {
  for (int attempt = 0; attempt < 60; ++attempt) {
    for (std::size_t i = 0; i < y_.size(); ++i)
      r_next_[i] = project_cone(y_[i] - (weight_[i] / lipschitz_) * g_[i], problem.friction[i]);
    problem.relative_velocities(r_next_, v_, u_next_);
    const auto [curvature, length] = order_free_sums<2>(y_.size(), [&](std::size_t i) -> std::array<double, 2> {
      if (weight_[i] <= 0.0) return {};
      const Vec3 d = r_next_[i] - y_[i];
      return {d.dot(u_next_[i] - u_y_[i]), d.squaredNorm() / weight_[i]};
    });
    if (curvature.sum <= lipschitz_ * length.sum) return;
    lipschitz_ *= 2.0;
  }
}

/// r = P_K(r - rho u): solves the convex problem, which the residual of exact friction cannot tell.
bool ProjectedGradient::is_stationary(const ConeProblem& problem, const Impulses& r) const {
  const double square = order_free_sum(r.size(), [&](std::size_t i) {
    return (r[i] - project_cone(r[i] - problem.scale * u_[i], problem.friction[i])).squaredNorm();
  });
  return std::sqrt(square) <= tolerance_ * problem.scale * problem.q_norm();
}

SolverReport ProjectedGradient::solve(const ConeProblem& problem, Impulses& r) {
  const std::size_t n = problem.size();
  contact_weights(problem, weight_);
  problem.relative_velocities(r, v_, u_);
  y_ = r;
  u_y_ = u_;
  best_ = r;
  r_next_.resize(n);
  g_.resize(n);
  lipschitz_ = 1.0;
  double momentum = 1.0;
  SolverReport report{false, 0, problem.residual(r, u_)};
  while (report.residual > aim(report) && report.iterations < iterations_ && !(report.iterations % 8 == 0 && stop())) {
    ++report.iterations;
    for (std::size_t i = 0; i < n; ++i) {
      g_[i] = u_y_[i];
      if (!relaxed_) g_[i].x() += problem.friction[i] * tangential_norm(u_[i]);
    }
    descend(problem);
    const double uphill = order_free_sum(n, [&](std::size_t i) { return g_[i].dot(r_next_[i] - r[i]); });
    const double next = 0.5 * (std::sqrt(momentum * momentum * (4.0 + momentum * momentum)) - momentum * momentum);
    const bool restart = !accelerated_ || uphill > 0.0;
    const double beta = restart ? 0.0 : momentum * (1.0 - momentum) / (momentum * momentum + next);
    momentum = restart ? 1.0 : next;
    for (std::size_t i = 0; i < n; ++i) {
      y_[i] = r_next_[i] + beta * (r_next_[i] - r[i]);
      u_y_[i] = u_next_[i] + beta * (u_next_[i] - u_[i]);
    }
    r.swap(r_next_);
    u_.swap(u_next_);
    lipschitz_ *= 0.95;
    const double residual = problem.residual(r, u_);
    if (residual < report.residual || relaxed_) {
      report.residual = residual;
      best_ = r;
    }
    if (relaxed_ && is_stationary(problem, r)) break;
  }
  r = best_;
  report.converged = report.residual <= tolerance_;
  return report;
}

namespace {
SolverEntry entry_of(const char* name, const char* summary, const char* source, bool accelerated) {
  Entry entry{name, summary, solver_fields({cone_field("relaxed", "without the De Saxce shift, convex")}, 500),
              solver_needs, source};
  return {std::move(entry), [accelerated](const Parameters& p) -> std::unique_ptr<ContactSolver> {
            return std::make_unique<ProjectedGradient>(static_cast<int>(p.number_or("iterations", 500)),
                                                       p.number_or("tolerance", 1e-6), accelerated,
                                                       p.has("cone") && p.text("cone") == "relaxed");
          }};
}
}  // namespace

SolverEntry apgd_entry() {
  return entry_of("apgd", "accelerated projected gradients with restart, matrix-free",
                  "Mazhar, Heyn, Negrut and Tasora 2015", true);
}
SolverEntry projected_gradient_entry() {
  return entry_of("projected-gradient", "projected gradients on the cones (Uzawa's method), matrix-free",
                  "Uzawa 1958; Tasora and Anitescu 2011", false);
}

}  // namespace epafi
