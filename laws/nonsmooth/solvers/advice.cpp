#include "laws/nonsmooth/solvers/advice.h"

#include <cstdio>

#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/newton.h"

namespace epafi {

namespace {

constexpr double most_work = 2e9;  // multiplications of a trial: one or two seconds

struct SolverTrial {
  const char* solver;
  double iterations;
  double work;  ///< of an iteration, in multiplications
};

/// The entry of that name; all trials are in the list.
const SolverEntry& listed_solver(const std::string& name) {
  for (const SolverEntry& entry : all_solvers())
    if (entry.entry.name == name) return entry;
  return all_solvers().front();
}

}  // namespace

std::string solver_that_would_do(const ConeProblem& problem, double tolerance) {
  const double n = static_cast<double>(problem.size()), sweep = 80.0 * n;
  Newton measure(1, tolerance);
  const double factorisation = measure.work(problem) + 350.0 * n;
  const SolverTrial trials[] = {{"newton", 100, factorisation},
                                {"proximal", 60, 2.0 * factorisation},
                                {"auto", 200, factorisation},
                                {"pgs", 5000, sweep}};
  for (const SolverTrial& trial : trials) {
    if (trial.iterations * trial.work > most_work) continue;
    Parameters parameters;
    parameters.set("tolerance", tolerance);
    parameters.set("iterations", trial.iterations);
    Impulses r(problem.size(), Vec3::Zero());
    const SolverReport report = listed_solver(trial.solver).make(parameters)->solve(problem, r);
    std::vector<Vec6> v;
    std::vector<Vec3> u;
    problem.relative_velocities(r, v, u);
    const double residual = problem.residual(r, u);
    if (!(residual <= tolerance)) continue;
    char text[200];
    std::snprintf(
        text, sizeof text,
        "contact.nonsmooth.solver = %s with contact.nonsmooth.iterations = %g solves such a step (residual %.2g "
        "after %d iterations)",
        trial.solver, trial.iterations, residual, report.iterations);
    return text;
  }
  return "none of the solvers brings such a step below it at little cost: more contact.nonsmooth.iterations, a shorter "
         "run.time_step or a larger contact.nonsmooth.tolerance does";
}

}  // namespace epafi
