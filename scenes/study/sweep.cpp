#include "scenes/study/sweep.h"

#include <fmt/format.h>

#include <set>

#include "engine/units/error.h"
#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/session.h"

namespace epafi {
namespace {

constexpr std::size_t most_sweep_cases = 100000;

Scene scene_or_throw(const std::string& path, const std::vector<std::string>& overrides) {
  ReadResult read = read_scene(path, overrides, full_registry());
  if (!read.scene) throw SceneError(read.problems);
  return std::move(*read.scene);
}

}  // namespace

SweepPlan plan_sweep(const std::string& path, const std::vector<std::string>& overrides,
                     const std::filesystem::path& folder) {
  const Scene scene = scene_or_throw(path, overrides);
  if (scene.sweep.empty())
    throw SceneError(path + ": the scene has no [sweep]; write for example [sweep] with \"params.n\" = [100, 200]");
  SweepPlan sweep{path, overrides, {}, {}, {{}}, {}};
  for (const auto& v : scene.sweep) {
    sweep.keys.push_back(v.key);
    std::vector<std::vector<std::string>> longer;
    for (const auto& before : sweep.values)
      for (const auto& value : v.values) {
        longer.push_back(before);
        longer.back().push_back(value);
      }
    sweep.values = std::move(longer);
    if (sweep.values.size() > most_sweep_cases) throw SceneError(path + ": [sweep] has more than 100000 cases");
  }
  for (std::size_t k = 0; k < sweep.values.size(); ++k) {
    Case one{overrides, folder / fmt::format("case_{:04}", k)};
    for (std::size_t i = 0; i < sweep.keys.size(); ++i)
      one.overrides.push_back(sweep.keys[i] + "=" + sweep.values[k][i]);
    sweep.hashes.push_back(scene_hash(scene_or_throw(path, one.overrides)));
    sweep.cases.push_back(std::move(one));
  }
  return sweep;
}

std::string list_sweep(const SweepPlan& sweep) {
  std::string out;
  for (std::size_t k = 0; k < sweep.cases.size(); ++k) {
    const auto done = finished_case(sweep.cases[k], sweep.hashes[k]);
    out += fmt::format("{} {}", k, done ? done->status : "open");
    for (std::size_t i = 0; i < sweep.keys.size(); ++i) out += fmt::format(" {}={}", sweep.keys[i], sweep.values[k][i]);
    out += "\n";
  }
  return out;
}

std::string collect_sweep(const SweepPlan& sweep) {
  std::vector<std::optional<CaseResult>> results;
  std::set<std::string> names;
  for (std::size_t k = 0; k < sweep.cases.size(); ++k) {
    results.push_back(finished_case(sweep.cases[k], sweep.hashes[k]));
    if (!results.back()) continue;
    for (const auto& [name, value] : results.back()->summary.numbers) names.insert(name);
  }
  const auto cell = [](std::string text) {
    std::erase(text, '"');
    return text.find(',') == std::string::npos ? text : "\"" + text + "\"";
  };
  std::string out = "case,status";
  for (const auto& key : sweep.keys) out += "," + key;
  for (const auto& name : names) out += "," + name;
  out += ",state_hash\n";
  for (std::size_t k = 0; k < sweep.cases.size(); ++k) {
    out += fmt::format("{},{}", k, results[k] ? results[k]->status : "open");
    for (const auto& value : sweep.values[k]) out += "," + cell(value);
    for (const auto& name : names) {
      const auto number = results[k] ? results[k]->summary.number(name) : std::nullopt;
      out += number ? fmt::format(",{}", *number) : ",";
    }
    out += "," + (results[k] ? results[k]->summary.text("state_hash") : "") + "\n";
  }
  return out;
}

}  // namespace epafi
