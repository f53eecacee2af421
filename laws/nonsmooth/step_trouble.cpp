#include <cstdio>

#include "engine/threads/parallel.h"
#include "laws/nonsmooth/cone.h"
#include "laws/nonsmooth/no_solution.h"
#include "laws/nonsmooth/nonsmooth_step.h"
#include "laws/nonsmooth/solvers/advice.h"

namespace epafi {
namespace {

constexpr double unit_rounding = 2.2e-16;
constexpr std::size_t most_kept = 20'000;  // contacts of a step that is kept in blocks: 1 kB each

}  // namespace

std::string NonsmoothContact::advice() const {
  if (unsolvable_)
    return "contacts without solution are among them, which no solver and no number of iterations brings below it";
  return blocks_.size() > 0 ? solver_that_would_do(blocks_, tolerance_) : std::string();
}

std::vector<float> NonsmoothContact::residuals() const {
  std::vector<float> out(problem_.size());
  parallel_for(out.size(), [&](std::size_t i) {
    if (problem_.mobility[i] <= 0.0) return;
    const Vec3 r = with_impacts_ ? Vec3(r_[i] - impacts_.impulses()[i]) : r_[i];
    out[i] = static_cast<float>(natural_map(r, u_[i], problem_.friction[i], rho_).norm() / (rho_ * free_motion_.norm));
  });
  return out;
}

/// Of a step that was not solved. What has no solution is looked for in the 1st, 2nd, 4th, 8th ... of them: it costs as
/// much as a hundred sweeps.
SolverTrouble NonsmoothContact::look_for_trouble(const SolverReport& report) {
  if (report.converged) return {};
  ++unconverged_;
  std::size_t largest = 0;
  const auto moved = [&](std::size_t i) { return problem_.mobility[i] * r_[i].norm(); };
  for (std::size_t i = 1; i < r_.size(); ++i)
    if (moved(i) > moved(largest)) largest = i;
  const bool beyond = !r_.empty() && !(unit_rounding * moved(largest) <= free_motion_.largest);
  const bool due = (unconverged_ & (unconverged_ - 1)) == 0 && problem_.size() <= most_kept;
  if (!beyond && !due) return {};
  problem_.load_diagonal();
  blocks_.load(problem_);
  const auto none = find_no_solution(blocks_, u_);
  unsolvable_ = none.has_value();
  if (!beyond && !none) return {};
  const std::size_t at = none ? none->contacts.front() : largest;
  SolverTrouble out;
  out.slot = problem_.is_free(problem_.a[at]) ? problem_.a[at] : problem_.b[at];
  out.kind = beyond ? SolverTrouble::Kind::beyond_measure : SolverTrouble::Kind::no_solution;
  out.size = none ? none->closing : r_[largest].norm();
  char text[200] = "";
  if (beyond)
    std::snprintf(text, sizeof text, "impulses of %.3g N s: their rounding is more than all velocities%s",
                  r_[largest].norm(), none ? "; " : "");
  out.text = text;
  if (!none) return out;
  std::snprintf(text, sizeof text,
                "the contacts have no solution: %zu of them close with %.4g m/s together, whatever the bodies do",
                none->contacts.size(), none->closing);
  out.text += text;
  return out;
}

}  // namespace epafi
