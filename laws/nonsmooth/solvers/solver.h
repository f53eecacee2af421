/// @file solver.h  Interface of non-smooth solvers: they compute the impulses of a friction-contact problem from a warm
/// start.
#pragma once
#include <functional>
#include <memory>

#include "engine/step/report.h"
#include "engine/units/registry.h"
#include "laws/nonsmooth/cone_problem.h"

namespace epafi {

class ContactSolver {
 public:
  virtual ~ContactSolver() = default;
  /// r: start on entry (every r_i in its cone), solution on return. `converged` and `residual` are the solver's own
  /// values; callers measure again (residual.h).
  virtual SolverReport solve(const ContactProblem& problem, Impulses& r) = 0;
  /// The same for a problem in blocks: a file or an island. A solver that needs more than blocks returns an infinite
  /// residual.
  virtual SolverReport solve(const ConeProblem&, Impulses&) { return {false, 0, infinity}; }

  /// Called before the solve of a step, for solvers that need more than the problem.
  virtual void see(const World&, const BodyVelocities&, const ContactSet&, double) {}
  /// Displacements of bodies beside dt v_{k+1} [m], [rad]; null: position correction computes them.
  virtual const BodyVelocities* displacement() const { return nullptr; }

  /// Residual at or below which a start is accepted as the solution; negative: never.
  virtual double good_start() const { return -1.0; }

  /// Corrects r for the velocities `change` that it leaves at the contacts [m/s], with the factor of the last solve of
  /// the same contacts; calms(): whether there is one. r stays feasible.
  virtual bool calms() const { return false; }
  virtual void calm(const std::vector<Vec3>& /*change*/, Impulses& /*r*/) {}
  /// Discards data of the last solve, since contacts or slots of bodies have changed.
  virtual void forget() {}
  /// State that a step needs after a restart (the factor).
  virtual void visit(StateVisitor&) {}

  /// Called now and then; true ends the solve with the present impulses. Empty in a run: steps must not depend on
  /// clocks.
  std::function<bool()> interrupted;

 protected:
  bool stop() const { return interrupted && interrupted(); }
};

/// A solver that works on blocks alone.
class ConeSolver : public ContactSolver {
 public:
  explicit ConeSolver(double tolerance) : tolerance_(tolerance) {}
  using ContactSolver::solve;
  SolverReport solve(const ContactProblem& problem, Impulses& r) final {
    blocks_.load(problem);
    return solve(blocks_, r);
  }
  double good_start() const final { return aim({}); }

 protected:
  /// Residual to reach: for a start a tenth of the tolerance, since errors of the size of the tolerance would
  /// accumulate from step to step.
  double aim(const SolverReport& report) const { return report.iterations == 0 ? 0.1 * tolerance_ : tolerance_; }

  /// The problem of the last step.
  ConeProblem& own_blocks() { return blocks_; }

  double tolerance_;

 private:
  ConeProblem blocks_;
};

/// One line of the list of solvers.
struct SolverEntry {
  Entry entry;
  std::function<std::unique_ptr<ContactSolver>(const Parameters&)> make;
};

/// Fields that every solver has.
inline std::vector<Field> solver_fields(std::vector<Field> own = {}, double iterations = 50.0) {
  std::vector<Field> all{
      {"iterations", "", "", Kind::integer, iterations, {1, 1e9}, "sweeps or iterations per step at most"},
      {"tolerance", "", "", Kind::number, 1e-6, not_negative, "residual at which the solver stops"},
      {"warm_start", "", "", Kind::boolean, true, {}, "start from the impulses of the last step"},
      {"correction", "beta", "", Kind::number, 0.2, unit_interval,
       "share of the overlap beyond slop that a step corrects"},
      {"slop", "", "", Kind::number, 1e-4, not_negative, "overlap that is not corrected, relative to the body"},
      {"impact",
       "",
       "",
       Kind::text,
       Value(std::string("energetic")),
       {},
       "law of restitution: energetic (gains no energy), newton (all contacts at once), poisson, or sequential (one "
       "impact at a time)",
       false,
       {"energetic", "newton", "poisson", "sequential"}},
  };
  all.insert(all.end(), own.begin(), own.end());
  return all;
}

/// Needs of a solver.
inline constexpr Needs solver_needs{.slip_velocity = true, .memory = true};

/// Entry of a Solver(iterations, tolerance, numbers of its own fields in their order). iterations: default.
template <class Solver, class... Own>
SolverEntry solver_entry(const char* name, const char* summary, const char* source, double iterations,
                         const Own&... own) {
  return {{name, summary, solver_fields({own...}, iterations), solver_needs, source},
          [=](const Parameters& p) -> std::unique_ptr<ContactSolver> {
            return std::make_unique<Solver>(static_cast<int>(p.number_or("iterations", iterations)),
                                            p.number_or("tolerance", 1e-6),
                                            p.number_or(own.name, std::get<double>(*own.default_value))...);
          }};
}

/// The field `cone` of a solver that can also relax Coulomb's cone.
inline Field cone_field(const std::string& relaxed, const std::string& what) {
  return {"cone",
          "",
          "",
          Kind::text,
          Value(std::string("coulomb")),
          {},
          "set of friction: coulomb (exact), or " + relaxed + ": " + what + "; the residual shows the gap",
          false,
          {"coulomb", relaxed}};
}

}  // namespace epafi
