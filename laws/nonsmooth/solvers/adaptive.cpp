#include "laws/nonsmooth/solvers/adaptive.h"

#include <algorithm>

#include "laws/nonsmooth/solvers/all_solvers.h"

namespace epafi {

namespace {
constexpr double lane_work = 20.0;    // multiplications of a contact in a sweep of four at a time, by its time
constexpr double over_sweeps = 1.5;   // of the work of all sweeps: average cost of a step
constexpr double first_steps = 20.0;  // whose credit is there at the start
constexpr double first_credit = 2e7;  // beside it: 10 ms
constexpr double unspent = 0.5;       // of it: failed attempts cost little and are made again in the next step
constexpr double most_saved = 200.0;  // steps whose credit is kept
constexpr std::int32_t longest_pause = 63;
constexpr int direct_iterations = 2000;  // of the attempt, as `auto`
}  // namespace

Adaptive::Adaptive(const Parameters& parameters)
    : sweeps_(PgsRule{}, parameters),
      direct_(direct_iterations, parameters.number_or("tolerance", 1e-6)),
      most_sweeps_(parameters.number_or("iterations", 50)) {}

SolverReport Adaptive::solve_directly(const ContactProblem& problem, Impulses& r) {
  direct_.limit_work(std::max(credit_, 0.0));
  direct_.interrupted = interrupted;
  const SolverReport report = direct_.solve(problem, r);
  credit_ -= direct_.work();
  return report;
}

SolverReport Adaptive::solve(const ContactProblem& problem, Impulses& r) {
  const SolverReport report = choose(problem, r);
  solved_ = report.converged;
  return report;
}

SolverReport Adaptive::choose(const ContactProblem& problem, Impulses& r) {
  const double sweep = lane_work * static_cast<double>(problem.size()), step = over_sweeps * most_sweeps_ * sweep;
  if (!started_) credit_ = first_credit + first_steps * step;
  started_ = true;
  credit_ = std::min(credit_ + step, first_credit + most_saved * step);
  SolverReport direct{false, 0, infinity};
  start_ = r;
  if (direct_was_right_) {
    direct = solve_directly(problem, r);
    if (direct.converged) return direct;
  }
  SolverReport swept = sweeps_.solve(problem, r);
  credit_ -= sweep * swept.iterations;
  swept.iterations += direct.iterations;
  if (!direct_was_right_ && !swept.converged && pause_-- <= 0) {
    direct = solve_directly(problem, start_);
    swept.iterations += direct.iterations;
    next_pause_ = std::min(2 * next_pause_ + 1, longest_pause);
    if (direct.converged || credit_ > unspent * first_credit) next_pause_ = 0;
    if (direct_.left_some()) next_pause_ = longest_pause;  // islands that are too expensive remain so for a while
    pause_ = next_pause_;
    if (direct.converged) {
      r.swap(start_);
      direct_was_right_ = true;
      return {true, swept.iterations, direct.residual};
    }
  }
  direct_was_right_ = false;
  direct_.forget();
  return swept;
}

SolverReport Adaptive::solve(const ConeProblem& problem, Impulses& r) {
  direct_.interrupted = interrupted;
  direct_.limit_work(infinity);
  return direct_.solve(problem, r);
}

void Adaptive::visit(StateVisitor& visitor) {
  direct_.visit(visitor);
  visitor.value("adaptive/credit", credit_);
  visitor.value("adaptive/started", started_);
  visitor.value("adaptive/pause", pause_);
  visitor.value("adaptive/next_pause", next_pause_);
  visitor.value("adaptive/direct", direct_was_right_);
  visitor.value("adaptive/solved", solved_);
}

SolverEntry adaptive_entry() {
  Entry entry{"adaptive", "sweeps, then Newton steps on islands where a factorisation is cheap; the default",
              solver_fields(), solver_needs, ""};
  return {std::move(entry), [](const Parameters& parameters) -> std::unique_ptr<ContactSolver> {
            return std::make_unique<Adaptive>(parameters);
          }};
}

}  // namespace epafi
