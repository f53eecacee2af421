#include "laws/nonsmooth/solvers/auto.h"

#include <algorithm>
#include <cmath>

#include "engine/threads/parallel.h"
#include "laws/nonsmooth/solvers/all_solvers.h"

namespace epafi {

namespace {

constexpr int first_batch = 8;
constexpr double newton_steps = 12.0;  // factorisations a Newton method takes on stacks: what sweeps must beat
constexpr int newton_limit = 80;       // pyramids and walls take 36 to 73
constexpr int patience = 20;           // factorisations after which newton must be ahead of the sweeps
constexpr int steps_again = 10;        // factorisations of a newton that was right in the last step
constexpr int steps_try = 8;  // of a try, after sweeps for twice as many; the next after ten times as many more

// with a credit (adaptive.h): stacks and arches cost 5 to 10, walls and piles of 40 boxes 20 to 30, of 200 hulls 100
constexpr double chain_price = 12.0, largest_price = 60.0;
constexpr double chain_steps = 600.0;   // factorisations that a chain has in any case
constexpr double proximal_price = 4.0;  // factorisations: LU costs two, and the sweeps behind it as much again

/// Multiplications of one sweep.
double sweep_work(const ConeProblem& problem) {
  return problem.has_bodies() ? 80.0 * static_cast<double>(problem.size())
                              : 9.0 * static_cast<double>(problem.column.size());
}

/// Refined impulses that miss the tolerance are of use where they come ten times nearer than sweeps.
bool helps(const SolverReport& swept, const SolverReport& refined) {
  return refined.converged || refined.residual <= 0.1 * swept.residual;
}

}  // namespace

void Auto::make_parts(std::size_t count) {
  while (parts_.size() < count) parts_.push_back(std::make_unique<Part>(iterations_, tolerance_));
  kept_.resize(count, Kept::nothing);
  spent_.resize(count, 0);
}

/// A newton that took many factorisations is right for the next step unless such a guess has failed lately.
Auto::Kept Auto::left_by(const Newton& newton, const SolverReport& report, std::int32_t spent) {
  if (!report.converged || (spent < 0 && report.iterations > steps_again)) return Kept::nothing;
  return newton.calms() ? Kept::factor : Kept::method;
}

/// Its multiplications over those of a sweep.
double Auto::factorisation(Part& part, const ConeProblem& problem) const {
  return (part.newton.work(problem) + 350.0 * static_cast<double>(problem.size())) / sweep_work(problem);
}

bool Auto::is_chain(const Part& part) const { return credit_ == infinity || part.price <= chain_price; }

/// How many steps of that price the part may still take; `most` or less.
int Auto::affordable(const Part& part, double each, int most) {
  const double steps = (part.budget - part.work) / each;
  return steps >= most ? most : std::max(0, static_cast<int>(steps));
}

/// Every island that is no chain gets a share of the credit by its cost: what one leaves no other may take, so that the
/// order in which threads come to them is nothing.
void Auto::share_credit(std::size_t count) {
  double asked = 0.0;
  for (std::size_t k = 0; k < count; ++k)
    if (!is_chain(*parts_[k])) asked += parts_[k]->price * parts_[k]->sweep_cost;
  for (std::size_t k = 0; k < count; ++k) {
    Part& part = *parts_[k];
    const double step = part.price * part.sweep_cost;
    part.budget = credit_ == infinity ? infinity : is_chain(part) ? chain_steps * step : credit_ * step / asked;
    part.left = !is_chain(part) && (part.price > largest_price || newton_steps * step > part.budget);
  }
}

bool Auto::left_some() const {
  return std::any_of(parts_.begin(), parts_.begin() + static_cast<std::ptrdiff_t>(islands_.size()),
                     [](const auto& part) { return part->left; });
}

double Auto::work() const {
  double sum = 0.0;
  for (std::size_t k = 0; k < islands_.size(); ++k) sum += parts_[k]->work;
  return sum;
}

/// Stage 0: r is the solution, or as it was.
SolverReport Auto::go_on(Part& part, const ConeProblem& problem, Impulses& r, std::size_t island) {
  const bool was_right = kept_[island] != Kept::nothing;
  if (!was_right && spent_[island] < 2.0 * steps_try * part.price) return {false, 0, infinity};
  const int least = std::min(was_right ? steps_again : steps_try, iterations_);
  const int most = affordable(part, part.price * part.sweep_cost, least);
  part.newton.interrupted = interrupted;
  part.newton.limit(most, most, infinity);
  part.change = r;
  const SolverReport report = part.newton.solve(problem, part.change);
  if (kept_[island] == Kept::factor && report.iterations == 0) part.newton.hold();  // others are at work
  kept_[island] = left_by(part.newton, report, 0);
  spent_[island] = report.converged ? 0 : static_cast<std::int32_t>(std::max(-10.0 * steps_try * part.price, -1e9));
  if (report.converged) r.swap(part.change);
  return report;
}

void Auto::appraise(Part& part, const ConeProblem& problem) const {
  part.price = factorisation(part, problem);
  part.sweep_cost = sweep_work(problem);
  part.work = 0.0;
}

/// Stages 0 and 1, of a part that is appraised.
SolverReport Auto::begin(Part& part, const ConeProblem& problem, Impulses& r, std::size_t island) {
  if (part.left) return {false, 0, infinity};
  part.paused = pause_ > 0 && problem.size() >= failed_;
  const SolverReport again = go_on(part, problem, r, island);
  part.work += again.iterations * part.price * part.sweep_cost;
  if (again.converged || again.iterations >= iterations_) return again;
  const int most = affordable(part, part.sweep_cost, iterations_ - again.iterations);
  SolverReport report = sweep(part, problem, r, most, part.price);
  part.work += report.iterations * part.sweep_cost;
  if (report.converged) spent_[island] = std::min(spent_[island] + report.iterations, 1 << 30);
  report.iterations += again.iterations;
  return report;
}

/// Stage 1: r is swept in place, at most `limit` times.
SolverReport Auto::sweep(Part& part, const ConeProblem& problem, Impulses& r, int limit, double price) {
  if (!part.paused)
    limit = static_cast<int>(std::min(std::max(newton_steps * price, 40.0), static_cast<double>(limit)));
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
    if (part.paused) continue;
    if (rate >= 0.0 || std::log(tolerance_ / report.residual) / rate > limit - report.iterations) break;
  }
  report.converged = report.residual <= tolerance_;
  return report;
}

/// Stages 2 and 3, where stage 1 left off.
SolverReport Auto::refine(Part& part, const ConeProblem& problem, Impulses& r, const SolverReport& swept,
                          std::size_t island) {
  part.newton.interrupted = part.proximal.interrupted = interrupted;
  const double factorisation_cost = part.price * part.sweep_cost;
  const int most = affordable(part, factorisation_cost, std::min(newton_limit, iterations_ - swept.iterations));
  part.newton.limit(most, patience, swept.residual);
  const SolverReport newton = part.newton.solve(problem, r);
  part.work += newton.iterations * factorisation_cost;
  kept_[island] = left_by(part.newton, newton, spent_[island]);
  if (newton.residual > swept.residual) r.swap(part.swept);
  const int count = swept.iterations + newton.iterations;
  const SolverReport report{newton.converged, count, std::min(newton.residual, swept.residual)};
  if (report.converged || count >= iterations_ || stop()) return report;
  const int last = affordable(part, proximal_price * factorisation_cost, iterations_ - count);
  if (last == 0) return report;
  part.proximal.limit(last);
  part.change = r;
  const SolverReport proximal = part.proximal.solve(problem, r);
  part.work += proximal_price * proximal.iterations * factorisation_cost;
  if (!(proximal.residual <= report.residual)) r.swap(part.change);
  return {proximal.converged, count + proximal.iterations, std::min(proximal.residual, report.residual)};
}

/// Whether stages 2 and 3 were of use to an island. Islands come in order of size.
void Auto::note(std::size_t contacts, bool helped) {
  if (helped)
    solves_now_ = solves_now_ || contacts >= failed_;
  else if (fails_now_ == 0)
    fails_now_ = contacts;
}

/// After a solve. With a credit the caller has pauses of its own.
void Auto::look_back() {
  constexpr std::int32_t forgiven = 3, most = 8;  // failures: without a pause, and with the longest
  if (pause_ > 0) --pause_;
  if (solves_now_) failures_ = 0;
  if (fails_now_ > 0 && credit_ == infinity && !stop()) {
    failed_ = fails_now_;
    failures_ = std::min(failures_ + 1, most);
    pause_ = (1 << std::max(failures_ - forgiven, 0)) - 1;
  }
  fails_now_ = 0;
  solves_now_ = false;
}

/// Island k of several, appraised.
void Auto::extract_part(std::size_t k, const ConeProblem& problem, const Impulses& r) {
  Part& part = *parts_[k];
  const auto contacts = islands_.contacts(k);
  islands_.extract(problem, k, part.problem);
  part.r.resize(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) part.r[i] = r[contacts[i]];
  part.swept = part.r;
  appraise(part, part.problem);
}

/// It is left, and its start is no solution: then nothing that others do makes one of the whole.
bool Auto::is_hopeless(Part& part) const {
  if (!part.left) return false;
  part.problem.relative_velocities(part.r, part.v, part.u);
  return !(part.problem.residual(part.r, part.u) <= tolerance_);
}

/// The islands for stages 2 and 3, the small ones first: an interrupted solve has most of them done.
void Auto::order_unfinished() {
  order_.clear();
  for (std::uint32_t k = 0; k < islands_.size(); ++k)
    if (unfinished(*parts_[k], reports_[k])) order_.push_back(k);
  std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(islands_.contacts(a).size(), a) < std::pair(islands_.contacts(b).size(), b);
  });
}

SolverReport Auto::solve(const ConeProblem& problem, Impulses& r) {
  islands_.find(problem);
  const std::size_t count = islands_.size();
  make_parts(count);
  if (count == 1) {
    parts_[0]->swept = r;
    appraise(*parts_[0], problem);
    share_credit(1);
    const SolverReport swept = begin(*parts_[0], problem, parts_[0]->swept, 0);
    if (!unfinished(*parts_[0], swept) || stop()) {
      look_back();
      r.swap(parts_[0]->swept);
      return swept;
    }
    const SolverReport refined = refine(*parts_[0], problem, r, swept, 0);
    note(problem.size(), helps(swept, refined));
    look_back();
    return refined;
  }
  reports_.assign(count, {});
  parallel_for(
      count, [&](std::size_t k) { extract_part(k, problem, r); }, 1);
  share_credit(count);
  for (std::size_t k = 0; k < count; ++k)
    if (is_hopeless(*parts_[k])) return {false, 0, infinity};
  parallel_for(
      count, [&](std::size_t k) { reports_[k] = begin(*parts_[k], parts_[k]->problem, parts_[k]->swept, k); }, 1);
  order_unfinished();
  parallel_for(
      order_.size(),
      [&](std::size_t j) {
        Part& part = *parts_[order_[j]];
        if (stop()) return;
        const SolverReport swept = reports_[order_[j]];
        reports_[order_[j]] = refine(part, part.problem, part.r, swept, order_[j]);
        part.helped = helps(swept, reports_[order_[j]]);
        part.swept.swap(part.r);
      },
      1);
  for (const std::uint32_t k : order_) note(islands_.contacts(k).size(), parts_[k]->helped);
  look_back();
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

bool Auto::calms() const { return std::find(kept_.begin(), kept_.end(), Kept::factor) != kept_.end(); }

void Auto::calm(const std::vector<Vec3>& change, Impulses& r) {
  parallel_for(
      kept_.size(),
      [&](std::size_t k) {
        if (kept_[k] != Kept::factor) return;
        Part& part = *parts_[k];
        const auto contacts = islands_.contacts(k);
        part.change.resize(contacts.size());
        part.r.resize(contacts.size());
        for (std::size_t i = 0; i < contacts.size(); ++i) {
          part.change[i] = change[contacts[i]];
          part.r[i] = r[contacts[i]];
        }
        part.newton.calm(part.change, part.r);
        if (!part.newton.calms()) kept_[k] = Kept::method;  // its matrix could not be factored again
        for (std::size_t i = 0; i < contacts.size(); ++i) r[contacts[i]] = part.r[i];
      },
      1);
}

/// Which method was right is a good guess for other contacts, too.
void Auto::forget() {
  for (std::int32_t& spent : spent_) spent = std::min(spent, 0);
  drop_factors();
}

void Auto::drop_factors() { std::replace(kept_.begin(), kept_.end(), Kept::factor, Kept::method); }

/// D of all contacts, 0 in islands without a factor; empty where none has one.
std::vector<Mat3> Auto::derivative() const {
  std::vector<Mat3> all;
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    if (kept_[k] != Kept::factor) continue;
    all.resize(islands_.contact_count(), Mat3(Mat3::Zero()));
    const auto contacts = islands_.contacts(k);
    for (std::size_t i = 0; i < contacts.size(); ++i) all[contacts[i]] = parts_[k]->newton.derivative()[i];
  }
  return all;
}

/// The factors of kept_ from what `derivative` gave; of the problem rows, mass and friction count.
void Auto::resume(const ConeProblem& problem, const std::vector<Mat3>& derivative) {
  islands_.find(problem);
  for (std::size_t k = 0; k < kept_.size(); ++k) {
    if (kept_[k] != Kept::factor) continue;
    Part& part = *parts_[k];
    const auto contacts = islands_.contacts(k);
    std::vector<Mat3> own;
    for (const std::uint32_t i : contacts) own.push_back(derivative[i]);
    if (islands_.size() > 1) islands_.extract(problem, k, part.problem);
    part.newton.resume(islands_.size() > 1 ? part.problem : problem, std::move(own));
  }
}

/// What newton had the last word on, and its matrices while calm() may need them.
void Auto::visit(StateVisitor& visitor) {
  ConeProblem& blocks = own_blocks();
  if (blocks.size() != islands_.contact_count()) drop_factors();  // of another problem than a step's
  std::vector<Mat3> all = derivative();
  visit_factor(visitor, blocks, all);
  visitor.column("auto/kept", kept_);
  visitor.column("auto/spent", spent_);
  visitor.value("auto/failed", failed_);
  visitor.value("auto/pause", pause_);
  visitor.value("auto/failures", failures_);
  make_parts(kept_.size());
  if (all.empty()) return;
  blocks.q.assign(all.size(), Vec3::Zero());
  blocks.diagonal.assign(all.size(), Mat3::Zero());
  resume(blocks, all);
}

SolverEntry auto_entry() {
  return solver_entry<Auto>("auto", "by island: sweeps, then newton or proximal if sweeps contract too slowly", "",
                            2000);
}

}  // namespace epafi
