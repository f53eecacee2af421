/// @file auto.h  Chooses a method for each island: sweeps first; their measured contraction decides whether to
/// continue, to try the augmented Lagrangian (newton) or the proximal Newton method. Costs are counted in
/// multiplications, not by a clock, so that a problem takes the same path on every machine and thread count.
///   0. newton, where it had the last word in the last step, and for a try where sweeps have cost what it might save:
///      at rest one factorisation, and then none (calm);
///   1. sweeps in growing batches, while the contraction of the last batch promises the tolerance for less work than
///      Newton steps would take, and never for more work than those;
///   2. newton from the first guess, given up when it is behind the sweeps after a few factorisations;
///   3. proximal from the better of both.
/// If 2 and 3 fail to reach a tenth of the sweeps' residual four times in a row, islands of that size have only sweeps
/// for 1, 3, 7 .. 31 solves: no method here solves the problems of stones with friction 1.5, and the attempts take 40
/// times as long as sweeps. `iterations` counts sweeps of stage 1 and factorisations of the others, per island.
#pragma once
#include <memory>

#include "laws/nonsmooth/islands.h"
#include "laws/nonsmooth/solvers/newton.h"
#include "laws/nonsmooth/solvers/proximal.h"

namespace epafi {

class Auto final : public ConeSolver {
 public:
  Auto(int iterations, double tolerance) : ConeSolver(tolerance), iterations_(iterations) {}
  using ConeSolver::solve;
  SolverReport solve(const ConeProblem& problem, Impulses& r) override;
  bool calms() const override;
  void calm(const std::vector<Vec3>& change, Impulses& r) override;
  void forget() override;
  void visit(StateVisitor& visitor) override;

  /// Limits each solve to about `credit` multiplications, except for chains (islands with a cheap factorisation), which
  /// always have some Newton steps. Islands with an expensive factorisation keep their start: above a largest price
  /// always, below it if Newton steps would exceed the credit. Infinite: no limits.
  void limit_work(double credit) { credit_ = credit; }
  /// Approximate number of multiplications of the last solve.
  double work() const;
  /// True if some island of the last solve was left unsolved because of its cost.
  bool left_some() const;

 private:
  /// Data of one island, kept from step to step.
  struct Part {
    Part(int iterations, double tolerance) : newton(iterations, tolerance), proximal(iterations, tolerance) {}
    ConeProblem problem;
    Impulses r, swept, change;
    ConeSweep<PgsRule> sweep;
    Newton newton;
    Proximal proximal;
    std::vector<Vec6> v;
    std::vector<Vec3> u;
    double price = 0.0;       ///< cost of a factorisation over that of a sweep
    double sweep_cost = 0.0;  ///< multiplications of a sweep
    double work = 0.0;        ///< multiplications of this solve
    double budget = 0.0;      ///< multiplications that this solve may take
    bool left = false;        ///< not solved: too expensive
    bool paused = false;      ///< sweeps only, since stages 2 and 3 have failed lately
    bool helped = true;       ///< by stages 2 and 3
  };
  /// Kept from newton for the next step, if it solved the island: that it comes first, or also its factor (calm).
  enum class Kept : std::uint8_t { nothing, method, factor };

  void make_parts(std::size_t count);
  static Kept left_by(const Newton& newton, const SolverReport& report, std::int32_t spent);
  double factorisation(Part& part, const ConeProblem& problem) const;
  void appraise(Part& part, const ConeProblem& problem) const;
  void share_credit(std::size_t count);
  static int affordable(const Part& part, double each, int most);
  SolverReport begin(Part& part, const ConeProblem& problem, Impulses& r, std::size_t island);
  SolverReport go_on(Part& part, const ConeProblem& problem, Impulses& r, std::size_t island);
  SolverReport sweep(Part& part, const ConeProblem& problem, Impulses& r, int limit, double price);
  SolverReport refine(Part& part, const ConeProblem& problem, Impulses& r, const SolverReport& swept,
                      std::size_t island);
  void extract_part(std::size_t k, const ConeProblem& problem, const Impulses& r);
  bool is_hopeless(Part& part) const;
  bool unfinished(const Part& part, const SolverReport& swept) const {
    return !part.left && !part.paused && !swept.converged && swept.iterations < iterations_;
  }
  bool is_chain(const Part& part) const;
  void drop_factors();
  std::vector<Mat3> derivative() const;
  void resume(const ConeProblem& problem, const std::vector<Mat3>& derivative);

  void order_unfinished();
  void note(std::size_t contacts, bool helped);
  void look_back();

  int iterations_;
  double credit_ = infinity;
  Islands islands_;
  std::vector<std::unique_ptr<Part>> parts_;
  std::vector<Kept> kept_;           ///< by island of the last solve
  std::vector<std::int32_t> spent_;  ///< sweeps that were enough, of the same contacts; < 0: a newton has failed
  std::vector<SolverReport> reports_;
  std::vector<std::uint32_t> order_;
  std::uint64_t failed_ = 0;     ///< contacts of the smallest island that stages 2 and 3 have left where they were
  std::int32_t pause_ = 0;       ///< solves in which islands of that size are swept alone
  std::int32_t failures_ = 0;    ///< in a row
  std::uint64_t fails_now_ = 0;  ///< as failed_, of this solve; 0: none
  bool solves_now_ = false;      ///< stages 2 or 3 have solved an island as large, in this solve
  std::vector<Vec6> v_;
  std::vector<Vec3> u_;
};

}  // namespace epafi
