#include "laws/nonsmooth/solvers/newton.h"

#include "laws/nonsmooth/cone.h"
#include "laws/nonsmooth/solvers/all_solvers.h"

namespace epafi {

namespace {
// scan over the 20 files of stacks, arches and walls: 1e2 costs twice the steps, 1e4 and more fail on walls
constexpr double first_augmentation = 1e3, largest_augmentation = 1e7;
constexpr int most_inner = 40;
}  // namespace

void contact_weights(const ConeProblem& problem, std::vector<double>& weight) {
  weight.resize(problem.size());
  for (std::size_t i = 0; i < problem.size(); ++i)
    weight[i] = problem.moves(i) ? 3.0 / problem.diagonal[i].trace() : 0.0;
}

Vec3 Newton::argument(std::size_t i, double t) const {
  const Vec3 u = t == 0.0 ? u_[i] : Vec3(u_[i] + t * du_[i]);
  return z_[i] - rho_ * weight_[i] * Vec3(u.x() + shift_[i], u.y(), u.z());
}

double Newton::wanted_shift(std::size_t i) const {
  const double mu = problem_->friction[i];
  return near_ && sticks(z_[i], mu) ? 0.0 : mu * tangential_norm(u_[i]);
}

double Newton::gradient() {
  double sum = 0.0;
  for (std::size_t i = 0; i < z_.size(); ++i) {
    g_[i] = project_cone(argument(i, 0.0), problem_->friction[i]) - lambda_[i];
    sum += g_[i].squaredNorm();
  }
  return std::sqrt(sum);
}

double Newton::slope(double t) const {
  double sum = 0.0;
  for (std::size_t i = 0; i < z_.size(); ++i)
    sum += (lambda_[i] + t * step_[i] - project_cone(argument(i, t), problem_->friction[i])).dot(du_[i]);
  return sum;
}

double Newton::line_search() const {
  const double start = slope(0.0), accept = 0.1 * std::abs(start);
  double low = 0.0, high = 1.0, f_low = start, f_high = slope(1.0), t = 1.0;
  if (f_high <= accept) return 1.0;
  for (int k = 0; k < 20; ++k) {  // phi' rises: the Illinois rule, halving every third time
    t = k % 3 == 2 || !(f_high > f_low) ? 0.5 * (low + high) : (low * f_high - high * f_low) / (f_high - f_low);
    const double f = slope(t);
    if (std::abs(f) <= accept) break;
    if (f < 0.0) {
      low = t;
      f_low = f;
      f_high *= 0.5;
    } else {
      high = t;
      f_high = f;
      f_low *= 0.5;
    }
  }
  return t;
}

bool Newton::minimise(SolverReport& report) {
  const std::size_t n = z_.size();
  for (int inner = 0; inner <= most_inner; ++inner) {
    const double g = gradient();
    if (inner > 0 && g <= std::max(0.01 * residual_, 1e-14) * scale_) return true;
    if (gives_up(report) || stop()) return false;
    for (std::size_t i = 0; i < n; ++i)
      d_[i] = rho_ * weight_[i] * project_cone_derivative(argument(i, 0.0), problem_->friction[i]);
    ++report.iterations;
    factored_ = factor_.factor(d_);
    if (!factored_) return false;
    factor_.solve(g_, step_, du_);
    const double t = line_search();
    for (std::size_t i = 0; i < n; ++i) {
      lambda_[i] += t * step_[i];
      u_[i] += t * du_[i];
    }
  }
  return false;
}

/// z = lambda = P_K(z - rho u~), and the true velocities and residual of that.
void Newton::next_multipliers() {
  for (std::size_t i = 0; i < z_.size(); ++i) z_[i] = project_cone(argument(i, 0.0), problem_->friction[i]);
  lambda_ = z_;
  problem_->relative_velocities(z_, v_, u_);
  residual_ = problem_->residual(z_, u_);
}

SolverReport Newton::solve(const ConeProblem& problem, Impulses& r) {
  problem_ = &problem;
  factored_ = stale_ = false;
  const std::size_t n = problem.size();
  problem.relative_velocities(r, v_, u_);
  residual_ = problem.residual(r, u_);
  SolverReport report{residual_ <= tolerance_, 0, residual_};
  if (residual_ <= aim(report)) return report;
  near_ = residual_ <= tolerance_;
  factor_.attach(problem);
  contact_weights(problem, weight_);
  shift_.resize(n);
  g_.resize(n);
  d_.resize(n);
  z_ = r;
  lambda_ = r;
  best_ = r;
  rho_ = augmentation_ > 0.0 ? augmentation_ : first_augmentation;
  scale_ = problem.scale * problem.q_norm();
  double share = 1.0;  // of the new shift: halved where the outer steps overshoot
  for (std::size_t i = 0; i < n; ++i) shift_[i] = wanted_shift(i);
  while (report.residual > aim(report) && !gives_up(report) && !stop()) {
    const double last = residual_;
    const bool found = minimise(report);
    next_multipliers();
    if (residual_ < report.residual) {
      report.residual = residual_;
      best_ = z_;
    }
    share = residual_ > last ? std::max(0.5 * share, 0.05) : std::min(1.0, 1.5 * share);
    for (std::size_t i = 0; i < n; ++i) shift_[i] += share * (wanted_shift(i) - shift_[i]);
    if (!found)
      rho_ = std::max(0.1 * rho_, 0.1);
    else if (residual_ > 0.3 * last)
      rho_ = std::min(10.0 * rho_, largest_augmentation);
  }
  r = best_;
  report.converged = report.residual <= tolerance_;
  return report;
}

/// By the last factor: dr = -(I + D W)^-1 D change, with the contacts open, stuck or sliding as they were.
void Newton::calm(const std::vector<Vec3>& change, Impulses& r) {
  if (!factored_) return;
  if (stale_) {
    factor_.attach(*problem_);
    factored_ = factor_.factor(d_);
    if (!factored_) return;
  }
  stale_ = false;
  for (std::size_t i = 0; i < r.size(); ++i) g_[i] = -(d_[i] * change[i]);
  factor_.solve(g_, step_, du_);
  for (std::size_t i = 0; i < r.size(); ++i) r[i] = project_cone(r[i] + step_[i], problem_->friction[i]);
}

void visit_factor(StateVisitor& visitor, ConeProblem& blocks, std::vector<Mat3>& derivative) {
  std::vector<std::uint32_t> body;
  std::vector<Mat63> jacobian;
  if (derivative.empty()) {
    blocks.mass.clear();
    blocks.friction.clear();
    blocks.rows.clear();
  }
  for (const ConeProblem::Row& row : blocks.rows)
    for (std::size_t s = 0; s < 2; ++s) {
      body.push_back(row.body[s]);
      jacobian.push_back(row.jacobian[s]);
    }
  visitor.column("newton/body", body);
  visitor.column("newton/jacobian", jacobian);
  visitor.column("newton/mass", blocks.mass);
  visitor.column("newton/friction", blocks.friction);
  visitor.column("newton/derivative", derivative);
  blocks.rows.resize(body.size() / 2);
  for (std::size_t k = 0; k < body.size(); ++k) {
    blocks.rows[k / 2].body[k % 2] = body[k];
    blocks.rows[k / 2].jacobian[k % 2] = jacobian[k];
  }
}

void Newton::resume(const ConeProblem& problem, std::vector<Mat3> derivative) {
  d_ = std::move(derivative);
  g_.resize(d_.size());
  problem_ = &problem;
  factored_ = stale_ = !d_.empty();
}

/// The matrix of the last factor while calm() may need it; a restart factors it again. Saved, it is factored again as
/// well: 5 ms a checkpoint for a pyramid of 1275 cubes.
void Newton::visit(StateVisitor& visitor) {
  ConeProblem& blocks = own_blocks();
  if (!factored_ || problem_ != &blocks) d_.clear();
  visit_factor(visitor, blocks, d_);
  resume(blocks, std::move(d_));
}

SolverEntry newton_entry() {
  return solver_entry<Newton>(
      "newton", "augmented Lagrangian with a semismooth Newton method inside; sparse Cholesky in body space",
      "Alart and Curnier 1991; Lee, Lee and Lee 2025", 50);
}

SolverEntry augmented_lagrangian_entry() {
  return solver_entry<Newton>(
      "augmented-lagrangian",
      "Uzawa's iteration on the augmented Lagrangian of a fixed augmentation, semismooth Newton inside",
      "Alart and Curnier 1991; Simo and Laursen 1992", 50,
      Field{"augmentation", "r", "", Kind::number, 1e3, positive, "relative to 1 / W_ii"});
}

}  // namespace epafi
