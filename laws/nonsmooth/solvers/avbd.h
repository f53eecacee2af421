/// @file avbd.h  Augmented descent body by body (Giles, Diaz and Yuksel 2025): every body in turn takes the velocity
/// that minimises its own inertia and the augmented Lagrangian of its contacts,
///   (M + sum H k D H^T) dv = M (v_free - v) + sum H P_K(lambda - k u~),
/// one 6 x 6 system per body; then lambda <- P_K(lambda - k u~) and k grows by `growth` at closed contacts. Bounded,
/// local, linear memory; k stays below 1e4 / W_ii. What it leaves is the difference between the impulses and the
/// velocities it moved: information travels one body per iteration, so that tall stacks lean on the warm start.
#pragma once
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

class BodyDescent final : public ConeSolver {
 public:
  BodyDescent(int iterations, double tolerance, double growth)
      : iterations_(iterations), tolerance_(tolerance), growth_(growth) {}
  using ConeSolver::solve;
  SolverReport solve(const ConeProblem& problem, Impulses& r) override;

 private:
  void list_contacts(const ConeProblem& problem);
  void move(const ConeProblem& problem, std::uint32_t body);
  void raise(const ConeProblem& problem);

  int iterations_;
  double tolerance_, growth_;
  std::vector<double> weight_, k_, shift_;
  std::vector<std::size_t> begin_;
  std::vector<std::uint32_t> contact_, next_;
  std::vector<Vec6> v_, work_;  ///< change of the velocities from the free ones
  std::vector<Vec3> u_;
  Impulses lambda_;
};

}  // namespace epafi
