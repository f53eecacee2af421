/// @file siconos.cpp  Friction-contact problems solved by Epafi and, on the same machine in the same minute, by the
/// numerics of Siconos (Debian: libsiconos-numerics-dev): OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 perf_siconos
/// [RESIDUAL] FILE... One row per problem: the least processor time of one cold solve whose residual, measured here
/// (laws/nonsmooth/residual.h), is at most RESIDUAL (1e-6). Every method of Siconos is asked with its own tolerances of
/// 1e-3 to 1e-10, three times each, because they are scaled otherwise; each solve is a process of its own that may take
/// 2 s. Methods in W form get sparse blocks, ADMM a sparse matrix.
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <optional>

#include "engine/threads/parallel.h"
#include "laws/nonsmooth/solvers/all_solvers.h"
#include "viz_export/hdf5/problem_file.h"

extern "C" {
#include <siconos/numerics/CSparseMatrix_internal.h>
#include <siconos/numerics/FrictionContactProblem.h>
#include <siconos/numerics/Friction_cst.h>
#include <siconos/numerics/NonSmoothDrivers.h>
#include <siconos/numerics/NumericsMatrix.h>
#include <siconos/numerics/NumericsSparseMatrix.h>
#include <siconos/numerics/SolverOptions.h>
#include <siconos/numerics/SparseBlockMatrix.h>
}

using namespace epafi;

namespace {

constexpr double longest = 2.0;  // of a solve [s]
constexpr int repeats = 3;

struct Method {
  const char* name;
  int id;
  bool blocks;  ///< W as 3 x 3 blocks, else as a sparse matrix
  int iterations;
};
const Method methods[] = {
    {"NSGS", SICONOS_FRICTION_3D_NSGS, true, 1000000},   {"NSN_AC", SICONOS_FRICTION_3D_NSN_AC, true, 500},
    {"NSN_FB", SICONOS_FRICTION_3D_NSN_FB, true, 500},   {"PROX", SICONOS_FRICTION_3D_PROX, true, 2000},
    {"VI_EG", SICONOS_FRICTION_3D_VI_EG, true, 1000000}, {"ADMM", SICONOS_FRICTION_3D_ADMM, false, 1000000}};

struct Answer {
  double ms = 0.0, residual = INFINITY;
};

/// Of this thread: the clock of a process under RLIMIT_CPU advances by whole ticks of 4 ms only.
double processor_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double residual_of(const ConeProblem& problem, const Impulses& r) {
  std::vector<Vec6> v;
  std::vector<Vec3> u;
  problem.relative_velocities(r, v, u);
  const double value = problem.residual(r, u);
  return std::isfinite(value) ? value : INFINITY;
}

/// In a child: a solver that crashes or does not end takes nothing with it.
std::optional<Answer> apart(const std::function<Answer()>& solve) {
  int pipes[2];
  if (pipe(pipes) != 0) return std::nullopt;
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    const rlimit limit{static_cast<rlim_t>(repeats * longest), static_cast<rlim_t>(repeats * longest) + 1};
    setrlimit(RLIMIT_CPU, &limit);
    if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr)) _exit(1);
    const Answer a = solve();
    _exit(write(pipes[1], &a, sizeof a) == sizeof a ? 0 : 1);
  }
  close(pipes[1]);
  Answer a;
  const bool whole = read(pipes[0], &a, sizeof a) == sizeof a;
  close(pipes[0]);
  waitpid(child, nullptr, 0);
  return whole ? std::optional(a) : std::nullopt;
}

Answer by_epafi(const ConeProblem& problem, const char* name, double tolerance) {
  Answer best{INFINITY, INFINITY};
  for (const SolverEntry& s : all_solvers()) {
    if (s.entry.name != name) continue;
    for (int k = 0; k < repeats; ++k) {
      Parameters parameters;
      parameters.set("tolerance", tolerance);
      parameters.set("iterations", 1e6);
      const auto solver = s.make(parameters);
      Impulses r(problem.size(), Vec3::Zero());
      const double begin = processor_ms();
      solver->solve(problem, r);
      best.ms = std::min(best.ms, processor_ms() - begin);
      best.residual = residual_of(problem, r);
    }
  }
  return best;
}

NumericsMatrix* sparse(const Eigen::MatrixXd& w) {
  NumericsMatrix* m = NM_create(NM_SPARSE, static_cast<int>(w.rows()), static_cast<int>(w.cols()));
  NM_triplet_alloc(m, (w.array() != 0.0).count());
  m->matrix2->origin = NSM_TRIPLET;
  for (Eigen::Index c = 0; c < w.cols(); ++c)
    for (Eigen::Index i = 0; i < w.rows(); ++i)
      if (w(i, c) != 0.0) NM_entry(m, static_cast<int>(i), static_cast<int>(c), w(i, c));
  return m;
}

Answer by_siconos(const ConeProblem& problem, const Method& method, double tolerance) {
  Answer best{INFINITY, INFINITY};
  const auto n = static_cast<int>(problem.size());
  for (int k = 0; k < repeats; ++k) {
    NumericsMatrix* w = sparse(problem.dense());
    if (method.blocks) {
      SparseBlockStructuredMatrix* blocks = SBM_new();
      SBM_from_csparse(3, NM_csc(w), blocks);
      w = NM_new_SBM(3 * n, 3 * n, blocks);
    }
    std::vector<double> q, mu = problem.friction, r(3 * problem.size(), 0.0), u(3 * problem.size(), 0.0);
    for (const Vec3& x : problem.q) q.insert(q.end(), {x.x(), x.y(), x.z()});
    FrictionContactProblem* asked = frictionContactProblem_new_with_data(3, n, w, q.data(), mu.data());
    SolverOptions* options = solver_options_create(method.id);
    options->dparam[SICONOS_DPARAM_TOL] = tolerance;
    options->iparam[SICONOS_IPARAM_MAX_ITER] = method.iterations;
    const double begin = processor_ms();
    fc3d_driver(asked, r.data(), u.data(), options);
    best.ms = std::min(best.ms, processor_ms() - begin);
    Impulses impulses;
    for (std::size_t i = 0; i < problem.size(); ++i) impulses.emplace_back(r[3 * i], r[3 * i + 1], r[3 * i + 2]);
    best.residual = residual_of(problem, impulses);
  }
  return best;
}

void row(const std::string& path, double wanted) {
  const ProblemFile file = read_problem(path);
  const ConeProblem problem = std::visit([](const auto& form) { return ConeProblem::from(form); }, file.form);
  const auto ours = apart([&] { return by_epafi(problem, "auto", wanted); });
  Answer best{INFINITY, INFINITY};
  const char* best_name = "none";
  for (const Method& m : methods)
    for (double tolerance = 1e-3; tolerance > 5e-11; tolerance *= 0.1) {
      const auto a = apart([&] { return by_siconos(problem, m, tolerance); });
      if (!a) break;  // out of time or crashed: finer ones too
      if (a->residual > wanted) continue;
      if (a->ms < best.ms) {
        best = *a;
        best_name = m.name;
      }
      break;
    }
  const bool solved = ours && ours->residual <= wanted;
  std::printf("| %s | %s | %s | %s |\n", file.name.c_str(),
              solved ? (std::to_string(ours->ms).substr(0, 5) + " ms").c_str() : "not reached",
              std::isfinite(best.ms) ? (std::to_string(best.ms).substr(0, 5) + " ms").c_str() : "not reached in 2 s",
              best_name);
}

}  // namespace

int main(int argc, char** argv) {
  set_thread_count(1);  // the clock is that of one thread
  int first = 1;
  double wanted = 1e-6;
  if (argc > 1) {
    char* end = nullptr;
    const double value = std::strtod(argv[1], &end);
    if (*end == 0 && value > 0) {
      wanted = value;
      first = 2;
    }
  }
  if (first >= argc) {
    std::puts("usage: perf_siconos [RESIDUAL] FILE...");
    return 2;
  }
  std::printf("| problem, residual %g | Epafi, auto | Siconos, best of six | which |\n|---|---|---|---|\n", wanted);
  for (int k = first; k < argc; ++k) row(argv[k], wanted);
}
