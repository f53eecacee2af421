/// @file newton.h  Augmented Lagrangian with a semismooth Newton method inside (Alart and Curnier 1991; in body space
/// Lee, Lee and Lee 2025). Outer: z <- P_K(z - rho u~), the shift mu |u_T| of u~ kept from the last outer step. Inner:
/// the convex problem of that z, by Newton with an exact line search on
///   phi(v) = |v|_M^2 / 2 - f.v + sum |P_K(z - rho u~)|^2 / (2 rho).
/// Every Newton step is one Cholesky factorisation of M + H D H^T, positive definite however hyperstatic the contacts.
/// rho grows tenfold when an outer step gains less than a factor of three and falls when the inner method stalls.
/// Cost: linear on stacks; 6 to 14 factorisations to 1e-9 for 5 to 100 boxes and for mass ratios to 1e4 (from r = 0).
/// At rest: the last factor takes small velocities out of the next start, so that stacks and pyramids go on without
/// iterations (calm); its matrix is state then.
/// Fails: cold on piles, where many contacts slide and the shift of the last step is no guess (there: proximal, auto).
#pragma once
#include "laws/nonsmooth/delassus_factor.h"
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

class Newton final : public ConeSolver {
 public:
  /// augmentation: a fixed rho relative to 3 / trace W_ii, 0 to let it follow the contraction.
  Newton(int iterations, double tolerance, double augmentation = 0.0)
      : ConeSolver(tolerance), iterations_(iterations), augmentation_(augmentation) {}
  using ConeSolver::solve;
  SolverReport solve(const ConeProblem& problem, Impulses& r) override;
  bool calms() const override { return factored_; }
  void calm(const std::vector<Vec3>& change, Impulses& r) override;
  void forget() override { factored_ = false; }
  void visit(StateVisitor& visitor) override;

  /// D of the last factor, by contact; empty where there is none.
  std::span<const Mat3> derivative() const { return factored_ ? std::span<const Mat3>(d_) : std::span<const Mat3>(); }
  /// After a solve that took no iteration: D as it was before, of the same contacts, with the geometry of now.
  void hold() { factored_ = stale_ = !d_.empty() && d_.size() == problem_->size(); }
  /// Restores the state after a solve of this problem (rows, mass, friction) with that D, for a resumed run.
  void resume(const ConeProblem& problem, std::vector<Mat3> derivative);

  /// At most so many factorisations; ends after `patience` of them while the residual is above `behind`.
  void limit(int iterations, int patience, double behind) {
    iterations_ = iterations;
    patience_ = patience;
    behind_ = behind;
  }
  /// Multiplications of one factorisation of this problem.
  double work(const ConeProblem& problem) {
    factor_.attach(problem);
    return factor_.work();
  }

 private:
  bool gives_up(const SolverReport& report) const {
    return report.iterations >= iterations_ || (report.iterations >= patience_ && report.residual > behind_);
  }
  /// The inner problem to a tenth of the outer residual; false when it stalls.
  bool minimise(SolverReport& report);
  /// Step length along (step_, du_): 1, or a root of phi'.
  double line_search() const;
  double slope(double t) const;
  /// z - rho (u + t du + shift n) of contact i.
  Vec3 argument(std::size_t i, double t) const;
  /// Fills g_ = P_K(argument) - lambda and returns its norm.
  double gradient();
  void next_multipliers();
  /// mu |u_T|; 0 where the contact sticks and the start was near: there u_T is an error, and its shift would be
  /// another.
  double wanted_shift(std::size_t i) const;

  int iterations_;
  double augmentation_;
  int patience_ = std::numeric_limits<int>::max();
  double behind_ = infinity;
  const ConeProblem* problem_ = nullptr;
  DelassusFactor factor_;
  bool factored_ = false;  ///< d_ and, unless stale_, factor_ are of this problem
  bool stale_ = false;     ///< factor_ is to be made of d_ again
  bool near_ = false;      ///< the start was within the tolerance
  double rho_ = 1.0, residual_ = 0.0, scale_ = 1.0;
  std::vector<double> weight_;    ///< per contact, of rho: 3 / trace W_ii [kg]
  std::vector<double> shift_;     ///< mu |u_T| of the last outer step [m/s]
  std::vector<Vec3> z_;           ///< multipliers [N s]
  std::vector<Vec3> lambda_, u_;  ///< inner iterate and its velocities u = W lambda + q
  std::vector<Vec3> g_, step_, du_;
  std::vector<Mat3> d_;
  std::vector<Vec6> v_;
  Impulses best_;
};

/// Data from which a factor is recomputed: rows and masses of `blocks`, friction, and D by contact; all empty where D
/// is.
void visit_factor(StateVisitor& visitor, ConeProblem& blocks, std::vector<Mat3>& derivative);

/// 3 / trace W_ii [kg]: the impulse that a velocity is worth at a contact; 0 where nothing moves.
void contact_weights(const ConeProblem& problem, std::vector<double>& weight);

}  // namespace epafi
