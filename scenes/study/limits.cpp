#include "scenes/study/limits.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
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

/// The limit of one method at one value of the first parameter, while it is sought.
struct Search {
  Limit limit;
  double good = 0.0, bad = 0.0;  ///< of a bisection
  bool begun = false, ended = false;
  std::vector<double> waiting = {};     ///< of a scan: what has not been asked, coarse to fine
  std::vector<LimitCase> answers = {};  ///< of a scan

  std::vector<double> place(double last) const { return limit.at ? std::vector{*limit.at, last} : std::vector{last}; }
};

/// The ends, then what halves the gaps: 0 n-1, middle, quarters ...
std::vector<double> coarse_to_fine(const std::vector<double>& values) {
  std::vector<double> out;
  std::vector<bool> taken(values.size(), false);
  const auto take = [&](std::size_t k) {
    if (!taken[k]) {
      out.push_back(values[k]);
      taken[k] = true;
    }
  };
  if (values.empty()) return out;
  take(0);
  take(values.size() - 1);
  for (std::size_t stride = values.size() / 2; stride > 0; stride /= 2)
    for (std::size_t k = stride; k < values.size(); k += stride) take(k);
  return out;
}

struct Seeker {
  const Study& study;
  fs::path folder;
  int jobs;
  std::function<void(const std::string&)> say;
  CaseLimits limits;
  LimitMap map;
  std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();

  double left() const {
    const double spent = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return study.budget > 0 ? study.budget - spent : INFINITY;
  }

  std::vector<std::string> settings_at(const std::vector<double>& at) const {
    std::vector<std::string> all;
    for (std::size_t k = 0; k < at.size(); ++k) all.push_back(override_of(study.parameters[k], at[k]));
    return all;
  }

  Case case_of(std::size_t method, const std::vector<double>& at) const {
    std::vector<std::string> all = study.fixed;
    for (const auto& more : {study.methods[method].overrides, settings_at(at)})
      all.insert(all.end(), more.begin(), more.end());
    std::string name = fmt::format("method_{:02}", method);
    for (const double x : at) name += fmt::format("_{:.9g}", x);
    return {all, folder / name};
  }

  void report(const LimitCase& c) const {
    say(fmt::format("{} [{}] at {:.6g}: {}{}{} {}", study.methods[c.method].name, study.methods[c.method].settings(),
                    fmt::join(c.at, ", "), c.status, c.kind.empty() ? "" : ": ", c.kind, c.detail));
  }

  LimitCase judge(std::size_t method, const std::vector<double>& at, const CaseResult& r) const {
    LimitCase c{method, at, "ok", {}, {}, r.summary.text("state_hash")};
    c.kind = kind_of_failure(study.fails_when, r, c.detail);
    if (!c.kind.empty()) c.status = "failed";
    return c;
  }

  using Question = std::pair<std::size_t, std::vector<double>>;  ///< method and place

  /// Answers in the order asked; empty for what the budget leaves out.
  std::vector<std::optional<LimitCase>> evaluate(const std::vector<Question>& asked) {
    std::vector<std::optional<LimitCase>> out(asked.size());
    if (is_patch_study(study)) {  // in this process: an evaluation takes milliseconds
      for (std::size_t i = 0; i < asked.size() && left() > 0; ++i) {
        out[i] = judge_patch_case(study, asked[i].first, settings_at(asked[i].second), asked[i].second);
        report(*out[i]);
      }
      return out;
    }
    std::vector<Case> todo;
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < asked.size(); ++i) {
      const Case wanted = case_of(asked[i].first, asked[i].second);
      const ReadResult read = read_scene(study.scene, wanted.overrides, full_registry());
      if (!read.scene) throw SceneError(read.problems);
      if (const auto old = finished_case(wanted, scene_hash(*read.scene)))
        out[i] = judge(asked[i].first, asked[i].second, *old);
      else {
        todo.push_back(wanted);
        index.push_back(i);
      }
    }
    CaseLimits cut = limits;
    cut.seconds = std::min(limits.seconds, left());
    cut.until = study.budget > 0
                    ? std::optional(begin + std::chrono::milliseconds(static_cast<long>(1e3 * study.budget)))
                    : std::nullopt;
    const bool whole = run_cases(study.scene, todo, cut, jobs, [&](std::size_t k, const CaseResult& r) {
      if (r.status == "over_budget" && cut.seconds < limits.seconds) return;  // of the study, not of the case
      const auto& [method, at] = asked[index[k]];
      out[index[k]] = judge(method, at, r);
      report(*out[index[k]]);
    });
    if (!whole) throw FileError("interrupted; run the same command again to go on");
    return out;
  }

  /// What a search asks next: the ends and the middle of a scan, then its other values; the ends of a bisection, then
  /// the middle of what is left.
  std::vector<double> next(Search& s) const {
    const ParameterSpec& p = study.parameters.back();
    if (s.ended) return {};
    if (!p.bisect) {
      if (!s.begun) s.waiting = coarse_to_fine(p.values);
      const std::size_t n = std::min(s.waiting.size(), s.begun ? 2 * s.answers.size() : std::size_t{3});
      std::vector<double> now(s.waiting.begin(), s.waiting.begin() + static_cast<std::ptrdiff_t>(n));
      s.waiting.erase(s.waiting.begin(), s.waiting.begin() + static_cast<std::ptrdiff_t>(n));
      return now;
    }
    if (!s.begun) return {p.values.front(), p.values.back()};
    const bool close = std::abs(s.bad - s.good) <= p.tolerance * std::max(std::abs(s.good), std::abs(s.bad));
    if (close || (p.integer && std::abs(s.bad - s.good) <= 1)) return {};
    double middle = p.log ? std::sqrt(s.good * s.bad) : 0.5 * (s.good + s.bad);
    if (p.integer) middle = std::round(middle);
    if (middle == s.good || middle == s.bad) return {};
    return {middle};
  }

  void learn(Search& s, const std::vector<LimitCase>& answers) const {
    const bool first = !s.begun;
    s.begun = true;
    if (!study.parameters.back().bisect) {
      s.answers.insert(s.answers.end(), answers.begin(), answers.end());
      return;
    }
    if (!first) {
      const LimitCase& c = answers.front();
      if (c.kind.empty())
        s.good = c.at.back();
      else {
        s.bad = c.at.back();
        s.limit.kind = c.kind;
      }
      s.limit.last_good = s.good;
      s.limit.first_failing = s.bad;
      return;
    }
    const LimitCase &low = answers[0], &high = answers[1];
    s.ended = low.kind.empty() == high.kind.empty();
    const bool falling = !low.kind.empty();  // fails at the lower end, works at the upper
    s.good = falling ? high.at.back() : low.at.back();
    s.bad = falling ? low.at.back() : high.at.back();
    s.limit.kind = falling ? low.kind : high.kind;
    if (s.ended && falling)
      s.limit.first_failing = low.at.back();
    else if (s.ended)
      s.limit.last_good = high.at.back();
    else {
      s.limit.last_good = s.good;
      s.limit.first_failing = s.bad;
    }
  }

  /// The limit that a scan has shown: the last value before its first failure.
  static void conclude(Search& s) {
    std::sort(s.answers.begin(), s.answers.end(), [](const LimitCase& a, const LimitCase& b) { return a.at < b.at; });
    for (const LimitCase& c : s.answers) {
      if (!c.kind.empty()) {
        s.limit.first_failing = c.at.back();
        s.limit.kind = c.kind;
        return;
      }
      s.limit.last_good = c.at.back();
    }
  }

  std::optional<double> theory_at(std::optional<double> x) const {
    if (study.theory.empty()) return std::nullopt;
    const Names names{[&](std::string_view name) {
                        return name == "x" ? NameValue{NameValue::Status::found, x.value_or(0.0)} : NameValue{};
                      },
                      [] { return std::vector<std::string>{"x"}; }};
    const ExpressionResult r = epafi::evaluate(study.theory, names);
    if (!r.value) throw SceneError(study.file + ": theory = \"" + study.theory + "\": " + r.problem);
    return r.value;
  }

  /// One round: what every search asks next, all at once. False where nothing was left to ask or to spend.
  bool round(std::vector<Search>& searches) {
    std::vector<Question> asked;
    std::vector<std::size_t> count;
    for (Search& s : searches) {
      const auto values = next(s);
      count.push_back(values.size());
      for (const double x : values) asked.emplace_back(s.limit.method, s.place(x));
    }
    if (asked.empty()) return false;
    const auto answers = evaluate(asked);
    std::size_t at = 0;
    for (std::size_t k = 0; k < searches.size(); at += count[k++]) {
      std::vector<LimitCase> own;
      for (std::size_t i = at; i < at + count[k]; ++i)
        if (answers[i]) {
          own.push_back(*answers[i]);
          map.cases.push_back(*answers[i]);
        }
      map.whole = map.whole && own.size() == count[k];
      const bool all_there = own.size() == count[k] && count[k] > 0;
      if (all_there || (!study.parameters.back().bisect && !own.empty()))
        learn(searches[k], own);
      else
        searches[k].ended = true;
    }
    return true;
  }
};

}  // namespace

LimitMap run_limits(const Study& study, const fs::path& folder, int jobs,
                    const std::function<void(const std::string&)>& say) {
  if (study.parameters.empty() || study.parameters.size() > 2)
    throw SceneError("a limits study has one or two parameters; write parameter = { key =, from =, to = }",
                     {study.file, 1, 1});
  Study whole = study;
  if (whole.methods.empty()) whole.methods.push_back({"scene", {}});
  Seeker seeker{whole, folder, jobs, say, {study.program, study.threads, study.time_limit, true}, {}};
  seeker.map.study = whole;
  std::vector<Search> searches;
  for (std::size_t m = 0; m < whole.methods.size(); ++m) {
    if (whole.parameters.size() == 1)
      searches.push_back({{m, {}, {}, {}, {}, seeker.theory_at({})}});
    else
      for (const double x : whole.parameters.front().values)
        searches.push_back({{m, x, {}, {}, {}, seeker.theory_at(x)}});
  }
  bool finished = false;
  while (!finished && seeker.left() > 0) finished = !seeker.round(searches);
  seeker.map.whole = seeker.map.whole && finished;
  for (Search& s : searches) {
    if (!whole.parameters.back().bisect) Seeker::conclude(s);
    seeker.map.limits.push_back(s.limit);
  }
  std::stable_sort(seeker.map.cases.begin(), seeker.map.cases.end(), [](const LimitCase& a, const LimitCase& b) {
    return std::tie(a.method, a.at) < std::tie(b.method, b.at);
  });
  return std::move(seeker.map);
}

}  // namespace epafi
