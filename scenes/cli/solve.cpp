/// `epafi solve`: friction-contact problems from files, by any solver; a row per problem and method. The residual is
/// measured here, not by the solver.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/threads/parallel.h"
#include "engine/units/error.h"
#include "engine/units/nearest.h"
#include "laws/nonsmooth/cone_sweep.h"
#include "laws/nonsmooth/no_solution.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "laws/nonsmooth/solvers/pgs.h"
#include "laws/nonsmooth/true_residual.h"
#include "scenes/cli/commands.h"
#include "scenes/cli/print.h"
#include "scenes/processor_time.h"
#include "scenes/stop.h"
#include "viz_export/files/json_writer.h"
#include "viz_export/files/page_target.h"
#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/hdf5_file.h"
#include "viz_export/hdf5/problem_file.h"

namespace epafi {

namespace {

struct Row {
  std::string problem, method, status, reason;
  int iterations = 0;
  double ms = 0.0, residual = 0.0, penetration_rate = 0.0, sweeps = 0.0;
};

std::vector<const SolverEntry*> chosen(const std::vector<std::string>& methods) {
  std::vector<const SolverEntry*> list;
  std::vector<std::string> names;
  for (const SolverEntry& s : all_solvers()) names.push_back(s.entry.name);
  for (const std::string& method : methods.empty() ? std::vector<std::string>{"auto"} : methods) {
    const std::size_t before = list.size();
    for (const SolverEntry& s : all_solvers())
      if (method == "all" || s.entry.name == method) list.push_back(&s);
    if (list.size() > before) continue;
    throw SceneError("--method: unknown solver '" + method + "'" + suggestion(method, names, "there are"));
  }
  return list;
}

ConeProblem blocks_of(const ProblemFile& file) {
  return std::visit([](const auto& form) { return ConeProblem::from(form); }, file.form);
}

/// CPU time of one Gauss-Seidel sweep over the problem [ms]: the unit of sweep-equivalents; the least of five trials.
double sweep_ms(const ConeProblem& problem) {
  ConeSweep<PgsRule> sweep;
  Impulses r(problem.size(), Vec3::Zero());
  sweep.load(problem);
  sweep.start(r);
  double least = infinity;
  for (int trial = 0; trial < 5; ++trial) {
    int count = 0;
    const double start = process_seconds();
    double now;
    do {
      for (int k = 0; k < 16; ++k) sweep.run(PgsRule{}, r);
      count += 16;
      now = process_seconds();
    } while (now - start < 2e-4);  // 200 readings of the clock
    least = std::min(least, 1e3 * (now - start) / count);
  }
  return least;
}

/// What a solver was asked for and what it says.
struct Asked {
  SolverReport report;
  double tolerance, iterations;
  bool late;
};

bool has_zero_row(const ConeProblem& problem) {
  for (std::size_t i = 0; i < problem.size(); ++i)
    if (!problem.moves(i) && problem.q[i].x() < 0.0) return true;
  return false;
}

/// Status of a row, and the reason where it is not "solved".
void judge(Row& row, const ConeProblem& problem, const Impulses& r, const std::vector<Vec3>& u, const Asked& asked) {
  const bool trusted = !beyond_measure(problem, r, asked.tolerance);
  if (row.residual <= asked.tolerance && trusted && !has_zero_row(problem)) return;
  if (const auto none = find_no_solution(problem, u)) {
    row.status = "no_solution";
    row.reason = none->text();
    return;
  }
  if (!std::isfinite(row.residual)) {
    row.status = "not_finite";
    row.reason = "impulses or velocities are no finite numbers";
  } else if (asked.report.residual == infinity && asked.report.iterations == 0) {
    row.status = "not_applicable";
    row.reason = "the method does not take problems of this form";
  } else if (!trusted) {
    row.status = "not_trusted";
    row.reason = "impulses so large that the rounding of W r is above the tolerance";
  } else {
    const bool ended = asked.report.iterations >= asked.iterations;
    row.status = asked.late ? "time_limit" : ended ? "iteration_limit" : "stalled";
    row.reason = fmt::format("residual {:.3g} above the tolerance {:.3g}", row.residual, asked.tolerance);
  }
}

/// Impulses for others to check: <problem>/reaction; of several methods those of the least residual there, and each
/// one's own under <problem>/METHOD/reaction.
class SolutionFile {
 public:
  explicit SolutionFile(const std::string& path) : file_(path, Hdf5File::Mode::create) {}
  void begin_problem(const std::string& name) {
    if (!names_.insert(name).second)
      throw SceneError("--solution: two problems are named '" + name + "'; solve them into files of their own");
    best_.reset();
  }
  void add(const Row& row, Impulses r, bool alone) {
    if (!alone) write(row.problem + "/" + row.method, r);
    if (best_ && !std::isnan(least_residual_) && !(row.residual < least_residual_)) return;
    least_residual_ = row.residual;
    best_ = std::move(r);
  }
  void end_problem(const std::string& name) {
    if (best_) write(name, *best_);
  }
  void close() { file_.close(); }

 private:
  void write(const std::string& group, const Impulses& r) {
    std::vector<double> flat;
    for (const Vec3& x : r) flat.insert(flat.end(), {x.x(), x.y(), x.z()});
    file_.write<double>(group + "/reaction", flat, {.columns = 3});
  }

  Hdf5File file_;
  std::set<std::string> names_;
  std::optional<Impulses> best_;
  double least_residual_ = infinity;
};

/// One cold solve from r = 0.
Row solve_one(const ConeProblem& problem, const SolverEntry& entry, const SolveOptions& o, double limit, Impulses& r) {
  Parameters parameters;
  parameters.set("tolerance", o.tolerance);
  parameters.set("iterations", std::min(o.max_iterations, 2e9));
  const auto solver = entry.make(parameters);
  r.assign(problem.size(), Vec3::Zero());
  const double start = process_seconds();
  bool late = false;
  solver->interrupted = [&] { return late = process_seconds() - start > limit; };
  const SolverReport report = solver->solve(problem, r);
  Row row;
  row.method = entry.entry.name;
  row.status = "solved";
  row.iterations = report.iterations;
  row.ms = 1e3 * (process_seconds() - start);
  std::vector<Vec6> v;
  std::vector<Vec3> u;
  problem.relative_velocities(r, v, u);
  const TrueResidual measured = true_residual(problem, r);
  row.residual = measured.value;
  row.penetration_rate = measured.penetration_rate;
  judge(row, problem, r, u, {report, o.tolerance, o.max_iterations, late});
  return row;
}

std::string csv(const std::vector<Row>& rows) {
  std::string text = "problem,method,status,iterations,ms,residual,penetration_rate,sweep_equivalents,reason\n";
  for (const Row& r : rows)
    text += fmt::format("{},{},{},{},{:.4g},{:.3e},{:.3e},{:.4g},{}\n", r.problem, r.method, r.status, r.iterations,
                        r.ms, r.residual, r.penetration_rate, r.sweeps, r.reason);
  return text;
}

std::string json(const std::vector<Row>& rows) {
  JsonWriter w;
  w.begin_array();
  for (const Row& r : rows)
    w.begin_object()
        .member("problem", r.problem)
        .member("method", r.method)
        .member("status", r.status)
        .member("iterations", r.iterations)
        .member("ms", r.ms)
        .member("residual", r.residual)
        .member("penetration_rate", r.penetration_rate)
        .member("sweep_equivalents", r.sweeps)
        .member("reason", r.reason)
        .end_object();
  w.end_array();
  return w.text() + "\n";
}

}  // namespace

int command_solve(const SolveOptions& o) {
  const auto limit = parse_duration(o.time_limit);
  if (!limit) throw SceneError("--time-limit '" + o.time_limit + "' is no duration; write 1s, 0.5s or 2m");
  for (const std::string& path : o.problems)
    for (const std::string& target : {o.out, o.solution}) require_not_the_input(target, path);
  const auto solvers = chosen(o.methods);
  set_thread_count(1);  // the time is that of one core
  std::unique_ptr<SolutionFile> solution;
  if (!o.solution.empty()) solution = std::make_unique<SolutionFile>(o.solution);
  std::vector<Row> rows;
  const bool to_stdout = o.out.empty() && !o.json;
  if (to_stdout) print(csv({}));
  for (const std::string& path : o.problems) {
    const ProblemFile file = read_problem(path);
    if (solution) solution->begin_problem(file.name);
    const ConeProblem problem = blocks_of(file);
    const double sweep = sweep_ms(problem);
    for (const SolverEntry* entry : solvers) {
      Impulses r;
      rows.push_back(solve_one(problem, *entry, o, *limit, r));
      rows.back().sweeps = rows.back().ms / sweep;
      rows.back().problem = file.name;
      if (to_stdout) {
        const std::string line = csv({rows.back()});
        print(line.substr(line.find('\n') + 1));
        flush_printed();
      }
      if (solution) solution->add(rows.back(), std::move(r), solvers.size() == 1);
    }
    if (solution) solution->end_problem(file.name);
  }
  if (solution) solution->close();
  const std::string text = o.json ? json(rows) : csv(rows);
  if (!o.out.empty()) {
    write_whole_file(o.out, {text});
  } else if (o.json) {
    print(text);
  }
  const bool solved = std::all_of(rows.begin(), rows.end(), [](const Row& row) { return row.status == "solved"; });
  return solved ? exit_done : exit_bound;
}

}  // namespace epafi
