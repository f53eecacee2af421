/// @file apgd.h  Projected gradients on the Coulomb cones, with Nesterov's acceleration (apgd; Mazhar, Heyn, Negrut and
/// Tasora 2015) or without (projected-gradient). Per contact the step is 3 / (L trace W_ii); L grows until
///   (r+ - y).(g(r+) - g(y)) <= L |r+ - y|^2,
/// the form in gradients: the one in values stalls at 1e-8 by cancellation. The acceleration restarts when it points
/// uphill (O'Donoghue and Candes 2015). Friction is exact: the De Saxce shift mu |u_T| is renewed at every iteration.
/// Without that shift (cone = "relaxed"; Anitescu 2006) the problem is convex and its solution unique, but a body that
/// slides at v leaves the plane at mu v: the residual shows the gap (case B04).
/// Matrix-free, linear memory. Iterations grow like the height of a stack (400 for 20 boxes to 1e-9), against its
/// square for sweeps. Wins: middle accuracy without a factor. Fails: sliding piles, mass ratios beyond 1e4.
#pragma once
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

class ProjectedGradient final : public ConeSolver {
 public:
  ProjectedGradient(int iterations, double tolerance, bool accelerated, bool relaxed)
      : ConeSolver(tolerance), iterations_(iterations), accelerated_(accelerated), relaxed_(relaxed) {}
  using ConeSolver::solve;
  SolverReport solve(const ConeProblem& problem, Impulses& r) override;

 private:
  /// r_next_ and u_next_ from y_ with a step that the curvature allows.
  void descend(const ConeProblem& problem);

  bool is_stationary(const ConeProblem& problem, const Impulses& r) const;

  int iterations_;
  bool accelerated_, relaxed_;
  double lipschitz_ = 1.0;
  std::vector<double> weight_;
  Impulses y_, r_next_, best_;
  std::vector<Vec3> u_, u_y_, u_next_, g_;
  std::vector<Vec6> v_;
};

}  // namespace epafi
