/// @file solver.h  What a non-smooth solver is: impulses of a friction-contact problem, warm start in, solution out.
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
  /// r: start on entry (feasible: every r_i in its cone), solution on return. `converged` and `residual` are the
  /// solver's own claim; callers measure again (residual.h).
  virtual SolverReport solve(const ContactProblem& problem, Impulses& r) = 0;
  /// The same for a problem in blocks: a file or an island. A solver that needs more than blocks returns an infinite
  /// residual.
  virtual SolverReport solve(const ConeProblem&, Impulses&) { return {false, 0, infinity}; }

  /// Shown before the solve of a step, for solvers that look beyond the problem.
  virtual void see(const World&, const BodyVelocities&, const ContactSet&, double) {}
  /// What bodies are to move beside dt v_{k+1} [m], [rad]; null: the position correction decides.
  virtual const BodyVelocities* displacement() const { return nullptr; }

  /// A start with this residual is the solution; negative: no start is, sweeps go on from step to step.
  virtual double good_start() const { return -1.0; }

  /// Takes `change`, velocities that impulses r leave at the contacts, out of r as well, by means left from the last
  /// solve of the same contacts: calms() says whether there are any. r stays feasible.
  virtual bool calms() const { return false; }
  virtual void calm(const std::vector<Vec3>& /*change*/, Impulses& /*r*/) {}
  /// Other contacts than in the last step, or bodies by other names: nothing of the last solve holds.
  virtual void forget() {}
  /// Those means, where a step may need them after a restart.
  virtual void visit(StateVisitor&) {}

  /// Asked now and then; true ends the solve with what there is. Empty in a run: steps must not depend on clocks.
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
  /// The residual to go on for: of a start a tenth of the tolerance, or errors of the size of the tolerance would add
  /// up from step to step.
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
