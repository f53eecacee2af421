#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/study/limits.h"

namespace epafi {
namespace {

/// Which summary number a quantity of fails_when is, and what failing there is called.
struct Quantity {
  const char *name, *number, *kind;
};
constexpr Quantity quantities[] = {{"energy_error", "energy.relative_error", "energy grew"},
                                   {"overlap_relative", "overlap.max_relative", "overlap beyond bound"},
                                   {"momentum_error", "momentum_error", "momentum not kept"},
                                   {"residual", "residual.max", "did not converge"},
                                   {"iterations", "iterations.max", "did not converge"},
                                   {"ns_per_body_step", "ns_per_body_step", "slower than budget"},
                                   {"bodies_lost", "bodies_lost", "tunnelled"},
                                   {"bodies_removed", "bodies_removed", "tunnelled"}};

std::string kind_of_bound(const std::string& name) {
  for (const auto& q : quantities)
    if (name == q.name) return q.kind;
  const std::string first = name.substr(0, name.find('.'));
  if (first == "energy") return "energy grew";
  if (name == "broad_phase_ns") return "slower than budget";
  return first == "drift" || first == "sag" ? "drifted or fell" : "wrong answer";
}

}  // namespace

std::string kind_of_failure(const std::vector<FailureSpec>& fails_when, const CaseResult& result, std::string& detail) {
  detail = result.trouble;
  if (result.status == "over_budget") return "slower than budget";
  if (result.status == "crashed") return "crashed";
  if (result.status == "wrong_scene") return "refused";
  if (result.trouble.find("unstable time step") != std::string::npos) return "unstable step";
  if (result.status == "failed")
    return result.trouble.find("lost body") != std::string::npos ? "tunnelled" : "non-finite";
  if (result.status == "bound_violated") {
    for (const auto& [name, ok] : result.summary.numbers)
      if (name.compare(0, 7, "checks.") == 0 && name.compare(name.size() - 3, 3, ".ok") == 0 && ok == 0)
        return kind_of_bound(name.substr(7, name.size() - 10));
    return "wrong answer";
  }
  for (const auto& f : fails_when) {
    std::optional<double> worst;
    for (const auto& q : quantities)
      if (f.quantity == q.name) worst = std::abs(result.number(q.number, 0.0));
    if (f.quantity == "broad_phase_ns")
      worst = 1e9 * result.number("stage_seconds.broad_phase", 0.0) /
              std::max(1.0, result.number("steps", 0.0) * result.number("bodies", 0.0));
    if (!worst) {
      const std::string before = "measures." + f.quantity + ".";
      worst = result.summary.number("measures." + f.quantity);  // NAME.component.max
      if (worst) worst = std::abs(*worst);
      for (const auto& [name, value] : result.summary.numbers)
        if (name.compare(0, before.size(), before) == 0 && name.compare(name.size() - 5, 5, ".last") == 0)
          worst = std::max(worst.value_or(0.0), std::abs(value));
    }
    if (!worst)
      throw SceneError("fails_when: '" + f.quantity +
                       "' is neither a quantity of every run nor a measure of the scene");
    if (*worst <= f.limit) continue;
    detail = fmt::format("{} = {:.6g} > {:.6g}", f.quantity, *worst, f.limit);
    return kind_of_bound(f.quantity);
  }
  return {};
}

}  // namespace epafi
