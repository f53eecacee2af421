/// @file solvers.cpp  Contact updates per second of every non-smooth solver, with the residual it reaches, on one core.
/// Usage: perf_solvers [sweeps [solver]]; perf_solvers mass: newton's time to 1e-8 in sweeps, for unequal masses. CPU
/// time of the thread (the machine may be busy); median of five solves from r = 0. A contact update is one contact's
/// three rows solved once; packing and the residual are in the time.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>

#include "engine/threads/parallel.h"
#include "laws/nonsmooth/cone_sweep.h"
#include "laws/nonsmooth/residual.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/pgs.h"
#include "scenes/processor_time.h"
#include "tests/support/contact_worlds.h"

namespace {

using namespace epafi;

void row(const char* name, const ContactProblem& problem, const SolverEntry& entry, int sweeps) {
  Parameters parameters;
  parameters.set("iterations", static_cast<double>(sweeps));
  parameters.set("tolerance", 0.0);
  const auto solver = entry.make(parameters);
  std::array<double, 5> seconds{};
  Impulses r;
  SolverReport report;
  for (double& s : seconds) {
    r.assign(problem.size(), Vec3::Zero());
    const double start = thread_seconds();
    report = solver->solve(problem, r);
    s = thread_seconds() - start;
  }
  std::sort(seconds.begin(), seconds.end());
  const Coloring& coloring = problem.coloring();
  BodyVelocities v;
  std::vector<Vec3> u;
  const Residual residual = measure_residual(problem, r, problem.mean_effective_mass(), v, u);
  const double updates = static_cast<double>(problem.size()) * report.iterations;
  fmt::print("{:>20} {:>6} {:>9} {:>7} {:>7} {:>7} {:>9.2f} {:>9.2f} {:>9.2f} {:>10.2e} {:>10.2e}\n", name,
             entry.entry.name, problem.size(), coloring.groups().size(), coloring.colors(), coloring.rounds(),
             1e3 * seconds[2], 1e-6 * updates / seconds[2], 1e-6 * updates / seconds[0], residual.value,
             residual.penetration_rate);
}

/// The least of 20 calls [s].
template <class F>
double least_seconds(const F& f) {
  double least = infinity;
  for (int k = 0; k < 20; ++k) {
    const double start = thread_seconds();
    f();
    least = std::min(least, thread_seconds() - start);
  }
  return least;
}

/// B01: newton to 1e-8 beside Gauss-Seidel sweeps of the same problem, in turns, from warm memory.
void mass_row(const std::string& name, const ContactProblem& problem) {
  ConeProblem blocks;
  blocks.load(problem);
  Impulses r;
  const double sweeps = least_seconds([&] {
    ConeSweep<PgsRule> sweep;
    sweep.load(blocks);
    r.assign(problem.size(), Vec3::Zero());
    sweep.start(r);
    for (int k = 0; k < 200; ++k) sweep.run(PgsRule{}, r);
  });
  Parameters strict;
  strict.set("iterations", 500.0);
  strict.set("tolerance", 1e-8);
  const auto solver = newton_entry().make(strict);
  SolverReport report;
  const double solution = least_seconds([&] {
    r.assign(problem.size(), Vec3::Zero());
    report = solver->solve(blocks, r);
  });
  BodyVelocities v;
  std::vector<Vec3> u;
  fmt::print("{:>24} {:>9} {:>15} {:>17.1f} {:>10.2e}\n", name, problem.size(), report.iterations,
             200.0 * solution / sweeps, measure_residual(problem, r, problem.mean_effective_mass(), v, u).value);
}

void mass_ratios() {
  fmt::print("{:>24} {:>9} {:>15} {:>17} {:>10}\n", "problem", "contacts", "factorisations", "sweep_equivalents",
             "residual");
  mass_row("20 boxes, 1:1000 in turns", test::stack_of(20, 0.5, 1.0 / 240, [](int i) { return i % 2 ? 1e6 : 1e3; }));
  for (double ratio = 1.0; ratio <= 1e6; ratio *= 10.0)
    mass_row(fmt::format("2 boxes, 1:{:g}", ratio), test::stack_problem(2, 0.5, 1.0 / 240, ratio));
}

}  // namespace

int main(int argc, char** argv) {
  const int sweeps = argc > 1 ? std::atoi(argv[1]) : 100;
  const std::string only = argc > 2 ? argv[2] : "";
  set_thread_count(1);
  if (argc > 1 && std::string(argv[1]) == "mass") {
    mass_ratios();
    return 0;
  }
  fmt::print("{:>20} {:>6} {:>9} {:>7} {:>7} {:>7} {:>9} {:>9} {:>9} {:>10} {:>10}\n", "problem", "solver", "contacts",
             "pairs", "colours", "rounds", "ms", "M/s", "best M/s", "residual", "pen. rate");
  const std::pair<const char*, ContactProblem> problems[] = {
      {"10 boxes", test::stack_problem(10, 0.5)},
      {"1000 bodies, 1 point", test::lattice_problem(10, 0.5)},
      {"1000 bodies, 4 points", test::lattice_problem(10, 0.5, 4)},
      {"27000 bodies, 1 point", test::lattice_problem(30, 0.5)},
  };
  for (const auto& [name, problem] : problems)
    for (const SolverEntry& entry : all_solvers())
      if (only.empty() || entry.entry.name == only) row(name, problem, entry, sweeps);
}
