/// @file active_set.h  The two seed methods of the textbook (Wriggers 2006, ch. 5), on exact Coulomb contact.
///   lagrange: every contact is open, sticks or slides; the multipliers of all closed contacts follow from one linear
///     (KKT) system, then every contact takes the state that its impulse and velocity tell. Hyperstatic sets are
///     regularised by 1e-10 of W_ii, which picks one of their solutions. Ends when no state changes and the residual is
///     met; sets may cycle, and cycles are reported. 2 to 10 systems on stacks and arches.
///   penalty: impulses are what springs and dampers of finite stiffness give, found implicitly in one problem,
///     r = P(-rho u): never infeasible, never exact. The residual shows what the softness costs.
#pragma once
#include "laws/nonsmooth/delassus_factor.h"
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

class ActiveSet final : public ConeSolver {
 public:
  ActiveSet(int iterations, double tolerance) : ConeSolver(tolerance), iterations_(iterations) {}
  using ConeSolver::solve;
  SolverReport solve(const ConeProblem& problem, Impulses& r) override;

 private:
  enum class State : char { open, stick, slide };
  /// The state of each contact; counts those that change.
  std::size_t choose(const ConeProblem& problem, const Impulses& r);
  void assemble(const ConeProblem& problem, const Impulses& r);

  int iterations_;
  DelassusFactor factor_;
  std::vector<double> weight_;
  std::vector<State> state_;
  std::vector<Vec3> direction_;  ///< of sliding friction, tangential
  std::vector<Mat3> d_;
  std::vector<Vec3> b_, step_, du_, u_;
  std::vector<Vec6> v_;
  Impulses best_;
};

class Penalty final : public ConeSolver {
 public:
  Penalty(int iterations, double tolerance, double stiffness)
      : ConeSolver(tolerance), iterations_(iterations), stiffness_(stiffness) {}
  using ConeSolver::solve;
  SolverReport solve(const ConeProblem& problem, Impulses& r) override;

 private:
  double defect(const ConeProblem& problem, const Impulses& r, const std::vector<Vec3>& u, std::vector<Vec3>& f) const;

  int iterations_;
  double stiffness_;
  DelassusFactor factor_;
  std::vector<double> weight_;
  std::vector<Mat3> d_;
  std::vector<Vec3> f_, step_, du_, u_, u_try_, f_try_;
  std::vector<Vec6> v_;
  Impulses r_try_;
};

}  // namespace epafi
