#include "scenes/study/chart.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace epafi {

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  const std::size_t n = v.size();
  return n % 2 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

Chart chart_of(const Study& study, const std::filesystem::path& folder,
               const std::function<void(const std::string&)>& say) {
  if (is_corpus_study(study) || is_patch_study(study))
    if (!study.more_errors.empty() || !study.axis.empty() || study.cost != Study::Cost::run)
      throw SceneError(study.file +
                       ": a list of errors, axis and cost are for scenes that run, not for single contacts");
  if (is_corpus_study(study)) return run_corpus_chart(study, say);
  return is_patch_study(study) ? run_patch_chart(study, say) : run_chart(study, folder, say);
}

void set_times(ChartPoint& point, const std::vector<double>& times) {
  if (times.empty()) return;
  point.time = median(times);
  point.least_time = *std::min_element(times.begin(), times.end());
  point.time_spread = *std::max_element(times.begin(), times.end()) - point.least_time;
}

std::vector<std::size_t> order_of_turns(const Study& study) {
  std::map<std::string, std::size_t> seen;
  std::vector<std::pair<std::size_t, std::size_t>> turns;  // how many of its name came before, and which it is
  for (std::size_t k = 0; k < study.methods.size(); ++k) turns.emplace_back(seen[study.methods[k].name]++, k);
  std::sort(turns.begin(), turns.end());
  std::vector<std::size_t> order;
  for (const auto& turn : turns) order.push_back(turn.second);
  return order;
}

std::vector<std::size_t> front_of(const Chart& chart, std::size_t measure) {
  const auto error = [&](std::size_t k) {
    const ChartPoint& p = chart.points[k];
    return measure == 0 ? p.error : measure <= p.more_errors.size() ? p.more_errors[measure - 1] : NAN;
  };
  std::vector<std::size_t> good, front;
  for (std::size_t k = 0; k < chart.points.size(); ++k)
    if (chart.points[k].good() && !chart.points[k].is_reference && !std::isnan(error(k))) good.push_back(k);
  std::stable_sort(good.begin(), good.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(chart.points[a].time, error(a)) < std::pair(chart.points[b].time, error(b));
  });
  double best = INFINITY;
  for (const std::size_t k : good)
    if (error(k) < best) {
      front.push_back(k);
      best = error(k);
    }
  return front;
}

void mark_front(Chart& chart) {
  if (chart.one_question)
    for (const std::size_t k : front_of(chart, 0)) chart.points[k].pareto = true;
  if (!chart.asks_accuracy) return;
  for (std::size_t k = 0; k < chart.points.size(); ++k) {
    const ChartPoint& p = chart.points[k];
    const bool candidate = p.good() && !p.is_reference && p.accurate;
    if (candidate && (!chart.recommended || p.time < chart.points[*chart.recommended].time)) chart.recommended = k;
  }
}

}  // namespace epafi
