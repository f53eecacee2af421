#include "scenes/study/study_error.h"

#include <cmath>

#include "viz_export/hdf5/stored_run.h"

namespace epafi {

std::map<std::string, double> measured(const ErrorSpec& error, const CaseResult& result) {
  static const std::map<std::string, std::string> plain{{"overlap", "overlap.max_relative"},
                                                        {"energy", "energy.relative_error"},
                                                        {"residual", "residual.max"},
                                                        {"momentum", "momentum_error"}};
  std::map<std::string, double> values;
  const auto known = plain.find(error.name);
  if (known != plain.end()) {
    if (const auto v = result.summary.number(known->second)) values[error.name] = *v;
    return values;
  }
  const std::string before = "measures." + error.name + ".", after = "." + error.statistic;
  for (auto at = result.summary.numbers.lower_bound(before);
       at != result.summary.numbers.end() && at->first.compare(0, before.size(), before) == 0; ++at) {
    if (at->first.size() < after.size() || at->first.compare(at->first.size() - after.size(), after.size(), after) != 0)
      continue;
    const std::string component = at->first.substr(before.size(), at->first.size() - before.size() - after.size());
    if (error.component.empty() || error.component == component) values[component] = at->second;
  }
  return values;
}

std::optional<double> distance(const std::filesystem::path& run, const std::filesystem::path& reference) {
  const StoredRun a(run / "run.h5"), b(reference / "run.h5");
  if (a.snapshots() == 0 || b.snapshots() == 0) return std::nullopt;
  const StoredSnapshot x = a.snapshot(a.snapshots() - 1), y = b.snapshot(b.snapshots() - 1);
  if (x.bodies.size() != y.bodies.size()) return std::nullopt;
  double sum = 0;
  std::size_t moving = 0;
  for (std::size_t i = 0; i < x.bodies.size(); ++i) {
    if (x.bodies[i].id != y.bodies[i].id) return std::nullopt;
    if (x.bodies[i].is_wall()) continue;
    sum += (x.bodies[i].pose.position - y.bodies[i].pose.position).squaredNorm();
    ++moving;
  }
  return moving > 0 ? std::optional(std::sqrt(sum / static_cast<double>(moving))) : std::nullopt;
}

std::optional<double> study_error(const ErrorSpec& error, const CaseResult& result, const std::filesystem::path& folder,
                                  const Yardstick& yardstick) {
  if (error.name == "distance") return yardstick.folder.empty() ? std::nullopt : distance(folder, yardstick.folder);
  const auto values = measured(error, result);
  if (values.empty()) return std::nullopt;
  double sum = 0, scale = 0;
  for (const auto& [component, value] : values) {
    double target = error.exact.value_or(0.0);
    if (!error.exact && !yardstick.values.empty()) {
      const auto at = yardstick.values.find(component);
      if (at == yardstick.values.end()) return std::nullopt;
      target = at->second;
    }
    sum += (value - target) * (value - target);
    scale += target * target;
  }
  return error.relative && scale > 0 ? std::sqrt(sum / scale) : std::sqrt(sum);
}

}  // namespace epafi
