#include "scenes/study/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/error.h"
#include "engine/report.h"
#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/study/case_run.h"
#include "scenes/study/machine_speedup.h"
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

/// Amdahl's serial fraction of a stage from its times on 1 and n threads: t_n = t_1 (s + (1 - s) / n).
double serial_fraction(double one, double many, int threads) { return (threads * many / one - 1.0) / (threads - 1.0); }

/// What the machine itself gives, looked at after every round: what others leave of a shared one changes by the minute.
class Machine {
 public:
  /// Nothing where there is no one thread to compare with.
  explicit Machine(const std::vector<int>& threads) {
    if (std::ranges::count(threads, 1) == 0) return;
    for (const int n : threads)
      if (n != 1) seen_.push_back({n, {}});
  }
  void look() {
    for (auto& [n, all] : seen_) all.push_back(machine_speedup(n));
  }
  /// One line of medians for every number of threads beside 1.
  std::string lines() {
    std::string lines;
    for (auto& [n, looks] : seen_) {
      const auto median = [&all = looks](double MachineSpeedup::*of) {
        std::ranges::sort(all, {}, of);
        return all[all.size() / 2].*of;
      };
      lines +=
          fmt::format("# machine, {} threads: arithmetic {:.2f}x, triad {:.2f}x, a word there and back {:.0f} ns\n", n,
                      median(&MachineSpeedup::arithmetic), median(&MachineSpeedup::triad),
                      1e9 * median(&MachineSpeedup::round_trip));
    }
    return lines;
  }

 private:
  std::vector<std::pair<int, std::vector<MachineSpeedup>>> seen_;
};

/// One line per stage that takes a hundredth of the time of one thread or more, each a comment of the table: share of
/// the time, the part of it outside loops that are shared out over threads (serial, on one thread), and for every
/// number of threads beside 1 the speed-up and the serial fraction that alone would explain it; where memory binds that
/// is larger than the serial part.
std::string amdahl_table(const std::vector<const CaseResult*>& medians, const std::vector<int>& threads) {
  const auto first = std::find(threads.begin(), threads.end(), 1);
  if (first == threads.end() || threads.size() < 2) return {};
  const CaseResult& one = *medians[static_cast<std::size_t>(first - threads.begin())];
  const auto seconds = [](const CaseResult& r, const std::string& kind, const std::string& stage) {
    if (stage != "all") return r.number(kind + "." + stage, 0.0);
    double sum = 0.0;
    for (const char* each : stage_names) sum += r.number(kind + "." + each, 0.0);
    return sum;
  };
  std::string table;
  std::vector<std::string> stages(stage_names.begin(), stage_names.end());
  stages.push_back("all");
  for (const std::string& stage : stages) {
    const double alone = seconds(one, "stage_seconds", stage), total = seconds(one, "stage_seconds", "all");
    if (alone < 0.01 * total) continue;
    table += fmt::format("# {:>12} {:5.1f} %, serial {:.1f} % of it", stage, 100.0 * alone / total,
                         100.0 * seconds(one, "serial_seconds", stage) / alone);
    for (std::size_t k = 0; k < threads.size(); ++k) {
      if (threads[k] == 1) continue;
      const double many = seconds(*medians[k], "stage_seconds", stage);
      table += fmt::format("  {} threads: {:.2f}x, as if {:.1f} % were serial", threads[k], alone / many,
                           100.0 * serial_fraction(alone, many, threads[k]));
    }
    table += "\n";
  }
  return table;
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
    Machine machine(setup.threads);
    for (int round = 0; round < setup.repeats; ++round, machine.look())
      for (std::size_t k = 0; k < cases.size(); ++k) {
        results[k].push_back(run_case(setup.scene, cases[k], {setup.program, setup.threads[k], 0.0, true}));
        if (!results[k].back().completed() && results[k].back().summary.numbers.empty())
          throw SceneError(fmt::format("{} [{}] ended as '{}': {}", setup.scene, label, results[k].back().status,
                                       results[k].back().trouble));
      }
    const std::string hash = results[0][0].summary.text("state_hash");
    std::vector<const CaseResult*> medians;
    for (std::size_t k = 0; k < cases.size(); ++k) {
      auto& all = results[k];
      for (const auto& r : all)
        if (r.summary.text("state_hash") != hash)
          throw SceneError(
              fmt::format("{} [{}]: the state hash at {} threads differs", setup.scene, label, setup.threads[k]));
      std::sort(all.begin(), all.end(), [](const CaseResult& a, const CaseResult& b) {
        return a.number("ns_per_body_step", 0) < b.number("ns_per_body_step", 0);
      });
      medians.push_back(&all[all.size() / 2]);
      print(row(setup.scene, label, setup.threads[k], error, *medians.back(), cases[k].folder));
    }
    if (const std::string table = amdahl_table(medians, setup.threads); !table.empty()) print(table + machine.lines());
  }
}

}  // namespace epafi
