/// @file adaptive.h  The default: sweeps of pgs, then Newton steps on islands where these are cheap. Costs are counted
/// in multiplications, not by a clock, so that a problem takes the same path on every machine and thread count. The
/// price of an island is the cost of a factorisation over that of a sweep. Stacks, arches and robots are chains: price
/// 5 to 10, always factored where sweeps end above the tolerance. Walls and small piles: factored while credit lasts.
/// Large piles (200 hulls: price 100, 2000 spheres: 10^4): sweeps only, as pgs.
///   credit  of a step 1.5 times the work of `sweeps`, at the start that of 20 steps and 2e7 multiplications (10 ms)
/// An attempt ends when it has spent the credit, a chain's after 600 factorisations or their worth (auto.h), so that a
/// run costs at most 1.5 times what pgs does, but for the start and for chains. Where Newton steps were right in the
/// last step they come first (auto.h); at rest a step has its solution at the start and costs nothing. Attempts that
/// fail are made again in the next step while half of the first credit is there, as in small scenes it always is, then
/// after 1, 3, 7 ... 63 steps; those that cost too much after 63.
#pragma once
#include "laws/nonsmooth/solvers/auto.h"
#include "laws/nonsmooth/solvers/gauss_seidel.h"
#include "laws/nonsmooth/solvers/pgs.h"

namespace epafi {

class Adaptive final : public ContactSolver {
 public:
  explicit Adaptive(const Parameters& parameters);
  SolverReport solve(const ContactProblem& problem, Impulses& r) override;
  /// A single problem from a cold start: no limit of work.
  SolverReport solve(const ConeProblem& problem, Impulses& r) override;
  /// After an unsolved step no start is good enough: its residual is not computed, which saves one or two sweeps.
  double good_start() const override { return solved_ ? direct_.good_start() : -1.0; }
  bool calms() const override { return direct_.calms(); }
  void calm(const std::vector<Vec3>& change, Impulses& r) override { direct_.calm(change, r); }
  void forget() override { direct_.forget(); }
  void visit(StateVisitor& visitor) override;

 private:
  SolverReport solve_directly(const ContactProblem& problem, Impulses& r);
  SolverReport choose(const ContactProblem& problem, Impulses& r);

  GaussSeidel<PgsRule> sweeps_;
  Auto direct_;
  double most_sweeps_;
  Impulses start_;
  bool started_ = false;
  double credit_ = 0.0;            ///< multiplications; < 0 where a chain has taken more
  std::int32_t pause_ = 0;         ///< steps until the next attempt
  std::int32_t next_pause_ = 0;    ///< behind it, if it fails
  bool direct_was_right_ = false;  ///< in the last step
  bool solved_ = true;             ///< in the last step, by whatever means
};

}  // namespace epafi
