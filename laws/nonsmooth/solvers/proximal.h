/// @file proximal.h  The proximal point algorithm for exact Coulomb friction with a semismooth Newton method inside
/// (Alart and Curnier 1991; proximal form: Acary, Bremond and Huber 2018). Outer: given z, find
///   r_N = max(0, z_N - rho u_N),  r_T = P_disk(mu r_N)(z_T - rho u_T),  u = W r + q,   then z <- r.
/// The inner Jacobian is exact: a normal impulse changes the friction bound, so it is unsymmetric and factored by
/// block LU. rho doubles while the inner method takes few steps and is halved when its line search fails. After every
/// outer step come Gauss-Seidel sweeps for about the cost of a factorisation: they smooth what the projection of many
/// contacts at once leaves behind (100 polyhedra: half of the factorisations of the same method without sweeps).
/// Wins: piles, sliding, wedged systems, extreme mass ratios, to 1e-9. Loses: tall stacks from r = 0 (newton: a tenth
/// of the steps). Limit: the fill of three-dimensional piles above about a thousand bodies.
#pragma once
#include "laws/nonsmooth/cone_sweep.h"
#include "laws/nonsmooth/delassus_factor.h"
#include "laws/nonsmooth/solvers/pgs.h"
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

class Proximal final : public ConeSolver {
 public:
  Proximal(int iterations, double tolerance) : ConeSolver(tolerance), iterations_(iterations) {}
  using ConeSolver::solve;
  SolverReport solve(const ConeProblem& problem, Impulses& r) override;

  /// At most so many factorisations.
  void limit(int iterations) { iterations_ = iterations; }

 private:
  enum class Inner { solved, progress, failed };
  void load(const ConeProblem& problem);
  Inner solve_inner(SolverReport& report, int& steps);
  /// Fills f = image(z, u) - r and returns its norm.
  double defect(const std::vector<Vec3>& r, const std::vector<Vec3>& u, std::vector<Vec3>& f) const;
  /// Takes the longest of t = 1, 1/2, ... 1/32 that reduces the defect; false if none does.
  bool advance(double& norm);
  void smooth(int sweeps);

  int iterations_;
  const ConeProblem* problem_ = nullptr;
  DelassusFactor factor_;
  ConeSweep<PgsRule> sweep_;
  int sweeps_ = 0;  ///< after an outer step
  double rho_ = 1.0, residual_ = 0.0;
  std::vector<double> weight_;
  Impulses z_, best_;
  std::vector<Vec3> r_, u_, f_, step_, du_, r_try_, u_try_, f_try_;
  std::vector<Mat3> d_;
  std::vector<Vec6> v_;
};

}  // namespace epafi
