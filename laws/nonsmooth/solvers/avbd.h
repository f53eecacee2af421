/// @file avbd.h  Augmented descent body by body (Giles, Diaz and Yuksel 2025): every body in turn takes the velocity
/// that minimises its own inertia and the augmented Lagrangian of its contacts,
///   (M + sum H k D H^T) dv = M (v_free - v) + sum H P_K(lambda - k u~),
/// one 6 x 6 system per body; then lambda <- P_K(lambda - k u~) and k grows by `growth` at closed contacts. Bounded,
/// local, linear memory. One round over the bodies does not solve the inner problem, so that the multipliers overshoot
/// when k is large: without a bound (1e4 / W_ii) chains of 5 bodies diverge after 300 iterations. k stays below 16 /
/// W_ii, the bound is halved where the residual has grown fourfold over the best. With it 5, 10, 20 boxes to 1e-6 take
/// 102, 188, 220 iterations (pgs 2750, 34278, more than 260000), an arch of 21 607, a pyramid of 12 layers 204 and a
/// wall 234. Limits: mass ratio 1e2 takes 1492, 1e4 more than 70000; a cold pile of 100 polyhedra stays at 2e-5 after
/// 3000.
#pragma once
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

class BodyDescent final : public ConeSolver {
 public:
  BodyDescent(int iterations, double tolerance, double growth)
      : ConeSolver(tolerance), iterations_(iterations), growth_(growth) {}
  using ConeSolver::solve;
  SolverReport solve(const ConeProblem& problem, Impulses& r) override;

 private:
  void list_contacts(const ConeProblem& problem);
  void move(const ConeProblem& problem, std::uint32_t body);
  void raise(const ConeProblem& problem);

  int iterations_;
  double growth_, bound_ = 1.0;  ///< bound of k W_ii
  std::vector<double> weight_, k_, shift_;
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> contact_, next_;
  std::vector<Vec6> v_, work_;  ///< change of the velocities from the free ones
  std::vector<Vec3> u_;
  Impulses lambda_;
};

}  // namespace epafi
