#include "scenes/study/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenes/full_registry.h"
#include "scenes/reader/expression.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/session.h"
#include "scenes/study/chart.h"

namespace epafi {
namespace {

namespace fs = std::filesystem;

std::string override_of(const ParameterSpec& p, double value) {
  return p.integer ? fmt::format("{}={}", p.key, std::llround(value)) : fmt::format("{}={:.17g}", p.key, value);
}

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

struct Seeker {
  const Study& study;
  fs::path folder;
  int jobs;
  std::function<void(const std::string&)> say;
  CaseLimits limits;
  LimitMap map;

  std::vector<std::string> overrides(std::size_t method, const std::vector<double>& at) const {
    std::vector<std::string> all = study.fixed;
    const auto& own = study.methods[method].overrides;
    all.insert(all.end(), own.begin(), own.end());
    for (std::size_t k = 0; k < at.size(); ++k) all.push_back(override_of(study.parameters[k], at[k]));
    return all;
  }

  fs::path folder_of(std::size_t method, const std::vector<double>& at) const {
    std::string name = fmt::format("method_{:02}", method);
    for (const double x : at) name += fmt::format("_{:.9g}", x);
    return folder / name;
  }

  /// In this process: an evaluation takes milliseconds.
  std::vector<LimitCase> evaluate_patches(std::size_t method, const std::vector<std::vector<double>>& places) {
    std::vector<LimitCase> out;
    for (const auto& at : places) {
      std::vector<std::string> parameters;
      for (std::size_t k = 0; k < at.size(); ++k) parameters.push_back(override_of(study.parameters[k], at[k]));
      out.push_back(judge_patch_case(study, method, parameters, at));
      say(fmt::format("{} [{}] at {:.6g}: {}{}{} {}", study.methods[method].name, study.methods[method].settings(),
                      fmt::join(at, ", "), out.back().status, out.back().kind.empty() ? "" : ": ", out.back().kind,
                      out.back().detail));
    }
    map.cases.insert(map.cases.end(), out.begin(), out.end());
    return out;
  }

  /// Runs what has not been run; results in the order asked.
  std::vector<LimitCase> evaluate(std::size_t method, const std::vector<std::vector<double>>& places) {
    if (is_patch_study(study)) return evaluate_patches(method, places);
    std::vector<LimitCase> out(places.size());
    std::vector<Case> todo;
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Case wanted{overrides(method, places[i]), folder_of(method, places[i])};
      const ReadResult read = read_scene(study.scene, wanted.overrides, full_registry());
      if (!read.scene) throw SceneError(read.problems);
      if (const auto old = finished_case(wanted, scene_hash(*read.scene)))
        out[i] = judge(method, places[i], *old);
      else
        todo.push_back(wanted), index.push_back(i);
    }
    const bool whole = run_cases(study.scene, todo, limits, jobs, [&](std::size_t k, const CaseResult& r) {
      LimitCase& c = out[index[k]] = judge(method, places[index[k]], r);
      say(fmt::format("{} [{}] at {:.6g}: {}{}{}", study.methods[method].name, study.methods[method].settings(),
                      fmt::join(c.at, ", "), c.status, c.kind.empty() ? "" : ": ", c.kind));
    });
    if (!whole) throw FileError("interrupted; run the same command again to go on");
    map.cases.insert(map.cases.end(), out.begin(), out.end());
    return out;
  }

  LimitCase judge(std::size_t method, const std::vector<double>& at, const CaseResult& r) const {
    LimitCase c{method, at, "ok", {}, {}, r.summary.text("state_hash")};
    c.kind = kind_of_failure(study.fails_when, r, c.detail);
    if (!c.kind.empty()) c.status = "failed";
    return c;
  }

  std::vector<double> place(std::optional<double> first, double last) const {
    return first ? std::vector{*first, last} : std::vector{last};
  }

  void scan(std::size_t method, std::optional<double> first, Limit& limit) {
    std::vector<std::vector<double>> places;
    for (const double x : study.parameters.back().values) places.push_back(place(first, x));
    for (const LimitCase& c : evaluate(method, places)) {
      if (c.kind.empty()) {
        if (!limit.first_failing) limit.last_good = c.at.back();
        continue;
      }
      if (!limit.first_failing) limit.first_failing = c.at.back(), limit.kind = c.kind;
    }
  }

  /// The ends first; then halves until the interval is narrower than the tolerance.
  void bisect(std::size_t method, std::optional<double> first, Limit& limit) {
    const ParameterSpec& p = study.parameters.back();
    double good = p.values.front(), bad = p.values.back();
    const auto ends = evaluate(method, {place(first, good), place(first, bad)});
    bool falling = false;  // fails at the lower end, works at the upper
    if (!ends[0].kind.empty() && ends[1].kind.empty())
      std::swap(good, bad), falling = true;
    else if (!ends[0].kind.empty()) {
      limit.first_failing = p.values.front(), limit.kind = ends[0].kind;
      return;
    } else if (ends[1].kind.empty()) {
      limit.last_good = p.values.back();
      return;
    }
    limit.kind = (falling ? ends[0] : ends[1]).kind;
    while (std::abs(bad - good) > p.tolerance * std::max(std::abs(good), std::abs(bad)) &&
           !(p.integer && std::abs(bad - good) <= 1)) {
      double middle = p.log ? std::sqrt(good * bad) : 0.5 * (good + bad);
      if (p.integer) middle = std::round(middle);
      if (middle == good || middle == bad) break;
      const auto c = evaluate(method, {place(first, middle)});
      if (c[0].kind.empty())
        good = middle;
      else
        bad = middle, limit.kind = c[0].kind;
    }
    limit.last_good = good, limit.first_failing = bad;
  }

  std::optional<double> theory_at(std::optional<double> x) const {
    if (study.theory.empty()) return std::nullopt;
    const Names names{[&](std::string_view name) {
                        return name == "x" ? NameValue{NameValue::Status::found, x.value_or(0.0)} : NameValue{};
                      },
                      [] { return std::vector<std::string>{"x"}; }};
    const ExpressionResult r = evaluate_expression(study.theory, names);
    if (!r.value) throw SceneError(study.file + ": theory = \"" + study.theory + "\": " + r.problem);
    return r.value;
  }
  static ExpressionResult evaluate_expression(std::string_view text, const Names& names) {
    return epafi::evaluate(text, names);
  }

  void seek(std::size_t method, std::optional<double> first) {
    Limit limit{method, first, {}, {}, {}, theory_at(first)};
    if (study.parameters.back().bisect)
      bisect(method, first, limit);
    else
      scan(method, first, limit);
    map.limits.push_back(limit);
  }
};

}  // namespace

std::string kind_of_failure(const std::vector<FailureSpec>& fails_when, const CaseResult& result, std::string& detail) {
  detail = result.trouble;
  if (result.status == "over_budget") return "slower than budget";
  if (result.status == "crashed") return "crashed";
  if (result.status == "wrong_scene") return "refused";
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

LimitMap run_limits(const Study& study, const fs::path& folder, int jobs,
                    const std::function<void(const std::string&)>& say) {
  if (study.parameters.empty() || study.parameters.size() > 2)
    throw SceneError(study.file +
                     ": a limits study has one or two parameters; write parameter = { key =, from =, to = }");
  Study whole = study;
  if (whole.methods.empty()) whole.methods.push_back({"scene", {}});
  Seeker seeker{whole, folder, jobs, say, {study.program, study.threads, study.time_limit, true}, {}};
  seeker.map.study = whole;
  for (std::size_t m = 0; m < whole.methods.size(); ++m) {
    if (whole.parameters.size() == 1)
      seeker.seek(m, std::nullopt);
    else
      for (const double x : whole.parameters.front().values) seeker.seek(m, x);
  }
  return std::move(seeker.map);
}

}  // namespace epafi
