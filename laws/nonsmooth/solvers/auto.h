/// @file auto.h  No more than the scene needs, island by island: sweeps first; their measured contraction decides
/// whether to go on, to try the augmented Lagrangian (newton) or to go to the proximal Newton method. No clock is read:
/// costs are counted in multiplications, so that the same problem takes the same path on every machine and thread
/// count.
///   0. newton, where it had the last word in the last step, and for a try where sweeps have cost what it might save:
///      at rest one factorisation, and then none (calm);
///   1. sweeps in growing batches, while the contraction of the last batch promises the tolerance for less work than
///      Newton steps would take, and never for more work than those;
///   2. newton from the first guess, given up when it is behind the sweeps after a few factorisations;
///   3. proximal from the better of both.
/// Where 2 and 3 come no nearer than a tenth of the sweeps' residual four times in a row, islands as large are swept
/// alone for 1, 3, 7 .. 31 solves: stones at a friction of 1.5 have problems that no method here solves, and took 40
/// times as long as sweeps to come no nearer. `iterations` counts sweeps of stage 1 and factorisations of the others,
/// per island.
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

  /// From now on a solve takes at most about `credit` multiplications, but for chains (islands of low price), which
  /// have some steps in any case. Islands whose factorisation costs much are left as they start: by price always, above
  /// that of chains where Newton steps would take more than the credit. Infinite: no limits.
  void limit_work(double credit) { credit_ = credit; }
  /// Multiplications of the last solve, about.
  double work() const;
  /// Some island of the last solve was left.
  bool left_some() const;

 private:
  /// What one island keeps from step to step.
  struct Part {
    Part(int iterations, double tolerance) : newton(iterations, tolerance), proximal(iterations, tolerance) {}
    ConeProblem problem;
    Impulses r, swept, change;
    ConeSweep<PgsRule> sweep;
    Newton newton;
    Proximal proximal;
    std::vector<Vec6> v;
    std::vector<Vec3> u;
    double price = 0.0;       ///< of a factorisation, in sweeps
    double sweep_cost = 0.0;  ///< multiplications of a sweep
    double work = 0.0;        ///< multiplications of this solve
    double budget = 0.0;      ///< multiplications that this solve may take
    bool left = false;        ///< not solved: too expensive
    bool paused = false;      ///< swept alone: nothing else has helped such a one lately
    bool helped = true;       ///< by stages 2 and 3
  };
  /// Of newton's, where it had the last word: that it is to begin the next step, and its factor, which calms.
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
