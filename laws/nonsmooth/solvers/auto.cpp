#include "laws/nonsmooth/solvers/auto.h"

#include <algorithm>
#include <cmath>

#include "engine/parallel.h"
#include "laws/nonsmooth/solvers/all_solvers.h"

namespace epafi {

namespace {

constexpr int first_batch = 8;
constexpr double newton_steps = 12.0;  // factorisations a Newton method takes on stacks: what sweeps must beat
constexpr int newton_limit = 80;       // pyramids and walls take 36 to 73
constexpr int patience = 20;           // factorisations after which newton must be ahead of the sweeps

}  // namespace

/// Stage 1: r is swept in place.
SolverReport Auto::sweep(Part& part, const ConeProblem& problem, Impulses& r) {
  const double n = static_cast<double>(problem.size());
  const double cost = problem.has_bodies() ? 80.0 * n : 9.0 * static_cast<double>(problem.column.size());
  const auto limit = static_cast<int>(std::clamp(newton_steps * (part.newton.work(problem) + 350.0 * n) / cost, 40.0,
                                                 static_cast<double>(iterations_)));
  part.sweep.load(problem);
  part.sweep.start(r);
  problem.relative_velocities(r, part.v, part.u);
  SolverReport report{false, 0, problem.residual(r, part.u)};
  for (int batch = first_batch; report.residual > aim(report) && !stop(); batch *= 2) {
    batch = std::min(batch, limit - report.iterations);
    if (batch <= 0) break;
    for (int k = 0; k < batch; ++k) part.sweep.run(PgsRule{}, r);
    report.iterations += batch;
    problem.relative_velocities(r, part.v, part.u);
    const double last = report.residual;
    report.residual = problem.residual(r, part.u);
    if (report.iterations < 3 * first_batch || report.residual <= tolerance_) continue;
    const double rate = std::log(report.residual / last) / batch;  // per sweep, < 0 when it contracts
    if (rate >= 0.0 || std::log(tolerance_ / report.residual) / rate > limit - report.iterations) break;
  }
  report.converged = report.residual <= tolerance_;
  return report;
}

/// Stages 2 and 3, where stage 1 left off.
SolverReport Auto::refine(Part& part, const ConeProblem& problem, Impulses& r, const SolverReport& swept) {
  part.newton.interrupted = part.proximal.interrupted = interrupted;
  part.newton.limit(std::min(newton_limit, iterations_ - swept.iterations), patience, swept.residual);
  const SolverReport newton = part.newton.solve(problem, r);
  if (newton.residual > swept.residual) r.swap(part.swept);
  const int count = swept.iterations + newton.iterations;
  const SolverReport report{newton.converged, count, std::min(newton.residual, swept.residual)};
  if (report.converged || count >= iterations_ || stop()) return report;
  part.proximal.limit(iterations_ - count);
  const SolverReport proximal = part.proximal.solve(problem, r);
  return {proximal.converged, count + proximal.iterations, proximal.residual};
}

/// Island k of several, stage 1.
SolverReport Auto::begin_part(std::size_t k, const ConeProblem& problem, const Impulses& r) {
  Part& part = *parts_[k];
  const auto contacts = islands_.contacts(k);
  islands_.extract(problem, k, part.problem);
  part.r.resize(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) part.r[i] = r[contacts[i]];
  part.swept = part.r;
  return sweep(part, part.problem, part.swept);
}

SolverReport Auto::solve(const ConeProblem& problem, Impulses& r) {
  islands_.find(problem);
  const std::size_t count = islands_.size();
  while (parts_.size() < count) parts_.push_back(std::make_unique<Part>(iterations_, tolerance_));
  if (count == 1) {
    parts_[0]->swept = r;
    const SolverReport swept = sweep(*parts_[0], problem, parts_[0]->swept);
    if (!unfinished(swept) || stop()) {
      r.swap(parts_[0]->swept);
      return swept;
    }
    return refine(*parts_[0], problem, r, swept);
  }
  reports_.assign(count, {});
  parallel_for(
      count, [&](std::size_t k) { reports_[k] = begin_part(k, problem, r); }, 1);
  order_.clear();  // the small ones first: an interrupted solve has most of them done
  for (std::uint32_t k = 0; k < count; ++k)
    if (unfinished(reports_[k])) order_.push_back(k);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(islands_.contacts(a).size(), a) < std::pair(islands_.contacts(b).size(), b);
  });
  parallel_for(
      order_.size(),
      [&](std::size_t j) {
        Part& part = *parts_[order_[j]];
        if (stop()) return;
        reports_[order_[j]] = refine(part, part.problem, part.r, reports_[order_[j]]);
        part.swept.swap(part.r);
      },
      1);
  SolverReport report{true, 0, 0.0};
  for (std::size_t k = 0; k < count; ++k) {
    const auto contacts = islands_.contacts(k);
    for (std::size_t i = 0; i < contacts.size(); ++i) r[contacts[i]] = parts_[k]->swept[i];
    report.iterations = std::max(report.iterations, reports_[k].iterations);
  }
  problem.relative_velocities(r, v_, u_);
  report.residual = problem.residual(r, u_);
  report.converged = report.residual <= tolerance_;
  return report;
}

SolverEntry auto_entry() {
  Entry entry{"auto",
              "per island: sweeps first, then newton or proximal where their contraction is too slow",
              solver_fields({}, 2000),
              {.slip_velocity = true, .memory = true},
              ""};
  return {std::move(entry), [](const Parameters& parameters) -> std::unique_ptr<ContactSolver> {
            return std::make_unique<Auto>(static_cast<int>(parameters.number_or("iterations", 2000)),
                                          parameters.number_or("tolerance", 1e-6));
          }};
}

}  // namespace epafi
