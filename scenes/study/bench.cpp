#include "scenes/study/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/error.h"
#include "engine/report.h"
#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/study/case_run.h"
#include "scenes/study/study_error.h"

namespace epafi {
namespace {

/// Every combination of the lists of [benchmark] sizes; one empty combination where there is none.
std::vector<std::vector<std::string>> sizes_of(const Scene& scene) {
  std::vector<std::vector<std::string>> all{{}};
  if (!scene.benchmark) return all;
  for (const auto& v : scene.benchmark->sizes) {
    std::vector<std::vector<std::string>> longer;
    for (const auto& before : all)
      for (const auto& value : v.values) longer.push_back(before), longer.back().push_back(v.key + "=" + value);
    all = std::move(longer);
  }
  return all;
}

std::string row(const std::string& scene, const std::string& size, int threads, const ErrorSpec& error,
                const CaseResult& r, const std::filesystem::path& folder) {
  std::string line = fmt::format("{},\"{}\",{},{:.6g}", scene, size, threads, r.number("ns_per_body_step", NAN));
  for (const char* stage : stage_names)
    line += fmt::format(",{:.6g}", r.number(std::string("stage_seconds.") + stage, 0.0));
  const auto e = study_error(error, r, folder, {});
  line += fmt::format(",{},{},{},{:.6g},{}\n", error.name, e ? fmt::format("{:.6g}", std::abs(*e)) : "",
                      r.summary.text("state_hash"),
                      r.number("peak_memory_bytes", 0.0) / std::max(1.0, r.number("bodies", 1.0)), r.status);
  return line;
}

}  // namespace

std::string bench_header() {
  std::string line = "scene,size,threads,ns_per_body_step";
  for (const char* stage : stage_names) line += std::string(",") + stage + "_seconds";
  return line + ",error_measure,error,state_hash,bytes_per_body,status\n";
}

void run_bench(const BenchSetup& setup, const std::function<void(const std::string&)>& print) {
  const ReadResult read = read_scene(setup.scene, setup.overrides, full_registry());
  if (!read.scene) throw SceneError(read.problems);
  ErrorSpec error;
  error.name = read.scene->benchmark && !read.scene->benchmark->error.empty() ? read.scene->benchmark->error : "energy";
  for (const auto& size : sizes_of(*read.scene)) {
    std::string label;
    for (const auto& s : size) label += (label.empty() ? "" : "; ") + s;
    std::vector<std::vector<CaseResult>> results(setup.threads.size());
    std::vector<Case> cases;
    for (const int threads : setup.threads) {
      cases.push_back({setup.overrides, setup.folder / fmt::format("threads_{}", threads)});
      cases.back().overrides.insert(cases.back().overrides.end(), size.begin(), size.end());
    }
    for (int round = 0; round < setup.repeats; ++round)
      for (std::size_t k = 0; k < cases.size(); ++k) {
        results[k].push_back(run_case(setup.scene, cases[k], {setup.program, setup.threads[k], 0.0, true}));
        if (!results[k].back().completed() && results[k].back().summary.numbers.empty())
          throw SceneError(fmt::format("{} [{}] ended as '{}': {}", setup.scene, label, results[k].back().status,
                                       results[k].back().trouble));
      }
    const std::string hash = results[0][0].summary.text("state_hash");
    for (std::size_t k = 0; k < cases.size(); ++k) {
      auto& all = results[k];
      for (const auto& r : all)
        if (r.summary.text("state_hash") != hash)
          throw SceneError(
              fmt::format("{} [{}]: the state hash at {} threads differs", setup.scene, label, setup.threads[k]));
      std::sort(all.begin(), all.end(), [](const CaseResult& a, const CaseResult& b) {
        return a.number("ns_per_body_step", 0) < b.number("ns_per_body_step", 0);
      });
      print(row(setup.scene, label, setup.threads[k], error, all[all.size() / 2], cases[k].folder));
    }
  }
}

}  // namespace epafi
