/// @file staggered.h  Solvers of the frictionless linear complementarity problem, made to serve exact Coulomb friction
/// by staggering (Panagiotopoulos 1975): the normal problem with the tangential impulses kept, then sweeps over the
/// tangential ones on disks mu r_N, and again until the residual is met. Without friction this is one solve of the
/// method. Dense: at most 1500 contacts, else an infinite residual is reported. The outer iteration contracts where
/// friction is small or contacts are loose; it circles where they are wedged, and says so by its residual.
/// `iterations` counts pivots or steps of the method.
#pragma once
#include "laws/nonsmooth/cone_sweep.h"
#include "laws/nonsmooth/lcp.h"
#include "laws/nonsmooth/solvers/solver.h"

namespace epafi {

class Staggered final : public ConeSolver {
 public:
  Staggered(LcpMethod method, int iterations, double tolerance)
      : ConeSolver(tolerance), method_(method), iterations_(iterations) {}
  using ConeSolver::solve;
  SolverReport solve(const ConeProblem& problem, Impulses& r) override;

 private:
  /// Tangential impulses on the disk of the r_N that stands; the normal ones stay.
  struct TangentialRule {
    struct Data {
      double step;  ///< 1 / largest eigenvalue of W_TT, 0 where nothing moves
    };
    static Data pack(const Mat3& w);
    Vec3 update(const Data& d, double mu, const Vec3& r, const Vec3& u) const;
  };

  LcpMethod method_;
  int iterations_;
  LcpProblem normal_;
  ConeSweep<TangentialRule> sweep_;
  Impulses tangential_, best_;
  std::vector<Vec3> u_;
  std::vector<Vec6> v_;
};

}  // namespace epafi
