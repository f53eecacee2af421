#include "laws/nonsmooth/solvers/staggered.h"

#include "laws/nonsmooth/cone.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/pgs.h"

namespace epafi {

namespace {
constexpr std::size_t largest = 1500;  // contacts: Lemke's tableau is then 50 MB
constexpr int tangential_sweeps = 20;
}  // namespace

Staggered::TangentialRule::Data Staggered::TangentialRule::pack(const Mat3& w) { return {PgsRule::pack(w).step_t}; }

Vec3 Staggered::TangentialRule::update(const Data& d, double mu, const Vec3& r, const Vec3& u) const {
  return project_disk({r.x(), r.y() - d.step * u.y(), r.z() - d.step * u.z()}, mu * r.x());
}

SolverReport Staggered::solve(const ConeProblem& problem, Impulses& r) {
  const std::size_t n = problem.size();
  if (n > largest) return {false, 0, infinity};
  normal_.M = problem.normal_matrix();
  normal_.q.resize(static_cast<Eigen::Index>(n));
  sweep_.load(problem);
  problem.relative_velocities(r, v_, u_);
  SolverReport report{false, 0, problem.residual(r, u_)};
  best_ = r;
  Eigen::VectorXd z(static_cast<Eigen::Index>(n));
  for (std::size_t i = 0; i < n; ++i) z[static_cast<Eigen::Index>(i)] = r[i].x();
  const bool friction = std::any_of(problem.friction.begin(), problem.friction.end(), [](double mu) { return mu > 0; });
  while (report.residual > aim(report) && report.iterations < iterations_ && !stop()) {
    tangential_ = r;
    for (Vec3& x : tangential_) x.x() = 0.0;
    problem.relative_velocities(tangential_, v_, u_);
    for (std::size_t i = 0; i < n; ++i) normal_.q[static_cast<Eigen::Index>(i)] = u_[i].x();
    LcpSettings settings{iterations_ - report.iterations, std::max(1e-15, 1e-3 * tolerance_), interrupted};
    const LcpReport lcp = method_(normal_, settings, z);
    report.iterations += std::max(1, lcp.iterations);
    for (std::size_t i = 0; i < n; ++i)
      r[i] = project_disk({z[static_cast<Eigen::Index>(i)], r[i].y(), r[i].z()},
                          problem.friction[i] * z[static_cast<Eigen::Index>(i)]);
    sweep_.start(r);
    for (int k = 0; k < tangential_sweeps && friction; ++k) sweep_.run({}, r);
    problem.relative_velocities(r, v_, u_);
    const double residual = problem.residual(r, u_);
    if (residual < report.residual) {
      report.residual = residual;
      best_ = r;
    }
    if (!friction || lcp.status == LcpStatus::ray) break;
  }
  r = best_;
  report.converged = report.residual <= tolerance_;
  return report;
}

namespace {
SolverEntry entry_of(const char* name, const char* summary, const char* source, LcpMethod method) {
  Entry entry{name, std::string(summary) + "; friction by staggering", solver_fields({}, 10000), solver_needs, source};
  return {std::move(entry), [method](const Parameters& p) -> std::unique_ptr<ContactSolver> {
            return std::make_unique<Staggered>(method, static_cast<int>(p.number_or("iterations", 10000)),
                                               p.number_or("tolerance", 1e-6));
          }};
}
}  // namespace

SolverEntry lemke_entry() {
  return entry_of("lemke", "Lemke's complementary pivoting of the normal problem, lexicographic",
                  "Cottle, Pang and Stone 1992", lemke);
}
SolverEntry dantzig_entry() {
  return entry_of("dantzig", "Dantzig's principal pivoting of the normal problem",
                  "Cottle and Dantzig 1968; Baraff 1994", dantzig);
}
SolverEntry conjugate_projected_gradient_entry() {
  return entry_of("conjugate-projected-gradient", "conjugate projected gradients on the normal problem",
                  "Dostal 1997; Renouf and Alart 2005", conjugate_projected_gradient);
}
SolverEntry newton_min_entry() {
  return entry_of("newton-min", "semismooth Newton on min(r_N, u_N)", "Kanzow 1996", newton_min);
}
SolverEntry fischer_burmeister_entry() {
  return entry_of("fischer-burmeister", "semismooth Newton on the Fischer-Burmeister function of the normal problem",
                  "Fischer 1992", fischer_burmeister);
}

}  // namespace epafi
