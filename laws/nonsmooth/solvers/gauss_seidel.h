/// @file gauss_seidel.h  The sweeps of a Gauss-Seidel solver and when to stop them. Cheap test after every sweep: the
/// change of r in the sweep, scaled like the residual. When it falls below the tolerance the true residual decides; if
/// it is not met the cheap threshold is lowered in proportion (Acary, Bremond and Huber 2018). Cost: linear in contacts
/// per sweep. On n stacked boxes 0.93 n^2 sweeps per decade, on mass ratio q about 2.3 q: the fast end of the chart for
/// loose systems, not for tall stacks or heavy bodies on light ones.
#pragma once
#include <cmath>

#include "laws/nonsmooth/residual.h"
#include "laws/nonsmooth/solvers/solver.h"
#include "laws/nonsmooth/sweep.h"

namespace epafi {

template <LocalRule Rule>
class GaussSeidel final : public ContactSolver {
 public:
  GaussSeidel(Rule rule, const Parameters& parameters)
      : rule_(rule),
        iterations_(static_cast<int>(parameters.number_or("iterations", 50))),
        tolerance_(parameters.number_or("tolerance", 1e-6)) {}

  SolverReport solve(const ContactProblem& problem, Impulses& r) override {
    coloring_.update(problem);
    return problem.rotates ? iterate(with_rotation_, problem, r) : iterate(without_rotation_, problem, r);
  }

 private:
  template <class S>
  SolverReport iterate(S& sweep, const ContactProblem& problem, Impulses& r) {
    const double rho = problem.mean_effective_mass();
    problem.velocities(r, v_);
    sweep.load(problem, coloring_, r, v_);
    const double scale = cheap_scale(problem, rho);
    double threshold = tolerance_ * scale;
    SolverReport report{false, 0, 0.0};
    while (report.iterations < iterations_) {
      const double change = std::sqrt(sweep.run(rule_));
      ++report.iterations;
      if (change > threshold) continue;
      sweep.store(r);
      report.residual = measure_residual(problem, r, rho, v_, u_).value;
      report.converged = report.residual <= tolerance_;
      if (report.converged || change <= rounding * norm(r)) return report;  // nothing more to gain
      threshold = change * std::min(0.5, tolerance_ / report.residual);
    }
    sweep.store(r);
    return report;
  }

  static constexpr double rounding = 1e-15;  // of ||r||: a change of a few ulp of most impulses is noise

  static double norm(const Impulses& r) {
    double sum = 0.0;
    for (const Vec3& x : r) sum += x.squaredNorm();
    return std::sqrt(sum);
  }

  /// rho ||q||, or rho where q = 0.
  double cheap_scale(const ContactProblem& problem, double rho) const {
    double q2 = 0.0;
    for (std::size_t i = 0; i < problem.size(); ++i) q2 += problem.free_relative_velocity(i).squaredNorm();
    return rho * (q2 > 0.0 ? std::sqrt(q2) : 1.0);
  }

  Rule rule_;
  int iterations_;
  double tolerance_;
  Coloring coloring_;
  Sweep<true, Rule> with_rotation_;
  Sweep<false, Rule> without_rotation_;
  BodyVelocities v_;
  std::vector<Vec3> u_;
};

}  // namespace epafi
