#include "laws/nonsmooth/solvers/advice.h"

#include <chrono>
#include <cstdio>

#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/newton.h"

namespace epafi {

namespace {

constexpr double most_work = 2e9;     // multiplications of one factorisation: a second
constexpr double most_seconds = 1.0;  // of a trial

struct SolverTrial {
  const char* solver;
  double iterations;
  bool factors;
};
// the one that leaves the fewest steps of a run comes first
constexpr SolverTrial trials[] = {
    {"auto", 2000, true}, {"proximal", 500, true}, {"newton", 100, true}, {"pgs", 5000, false}};

/// The entry of that name; all trials are in the list.
const SolverEntry& listed_solver(const std::string& name) {
  for (const SolverEntry& entry : all_solvers())
    if (entry.entry.name == name) return entry;
  return all_solvers().front();
}

}  // namespace

std::string solver_that_would_do(const ConeProblem& problem, double tolerance) {
  const bool factors = Newton(1, tolerance).work(problem) <= most_work;
  for (const SolverTrial& trial : trials) {
    if (trial.factors && !factors) continue;
    Parameters parameters;
    parameters.set("tolerance", tolerance);
    parameters.set("iterations", trial.iterations);
    Impulses r(problem.size(), Vec3::Zero());
    const auto solver = listed_solver(trial.solver).make(parameters);
    const auto begin = std::chrono::steady_clock::now();
    const auto seconds = [begin] {
      return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    };
    solver->interrupted = [seconds] { return seconds() > most_seconds; };
    const SolverReport report = solver->solve(problem, r);
    const double spent = seconds();
    std::vector<Vec6> v;
    std::vector<Vec3> u;
    problem.relative_velocities(r, v, u);
    const double residual = problem.residual(r, u);
    if (!(residual <= tolerance)) continue;
    char text[240];
    std::snprintf(text, sizeof text,
                  "contact.nonsmooth.solver = %s with contact.nonsmooth.iterations = %g solves such a step (residual "
                  "%.2g after %d iterations from zero in %.3g ms)",
                  trial.solver, trial.iterations, residual, report.iterations, 1e3 * spent);
    return text;
  }
  return "none of the solvers brings such a step below it within a second: a shorter run.time_step or a larger "
         "contact.nonsmooth.tolerance does";
}

}  // namespace epafi
