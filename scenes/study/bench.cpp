#include "scenes/study/bench.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/step/report.h"
#include "engine/units/error.h"
#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/study/case_run.h"
#include "scenes/study/machine_speedup.h"
#include "scenes/study/study_error.h"
#include "viz_export/files/json_writer.h"

namespace epafi {
namespace {

/// Every combination of the lists of [benchmark] sizes; one empty combination where there is none.
std::vector<std::vector<std::string>> sizes_of(const Scene& scene) {
  std::vector<std::vector<std::string>> all{{}};
  if (!scene.benchmark) return all;
  for (const auto& v : scene.benchmark->sizes) {
    std::vector<std::vector<std::string>> longer;
    for (const auto& before : all)
      for (const auto& value : v.values) {
        longer.push_back(before);
        longer.back().push_back(v.key + "=" + value);
      }
    all = std::move(longer);
  }
  return all;
}

BenchRow row_of(const std::string& scene, const std::string& size, int threads, const ErrorSpec& error,
                const CaseResult& r, const std::filesystem::path& folder) {
  BenchRow row;
  row.scene = scene;
  row.size = size;
  row.threads = threads;
  row.ns_per_body_step = r.number("ns_per_body_step", NAN);
  for (const char* stage : stage_names)
    row.stage_seconds.push_back(r.number(std::string("stage_seconds.") + stage, 0.0));
  row.error_measure = error.name;
  if (const auto e = study_error(error, r, folder, {})) row.error = std::abs(*e);
  row.state_hash = r.summary.text("state_hash");
  row.bytes_per_body = r.number("peak_memory_bytes", 0.0) / std::max(1.0, r.number("bodies", 1.0));
  row.status = r.status;
  return row;
}

/// Amdahl's serial fraction of a stage from its times on 1 and n threads: t_n = t_1 (s + (1 - s) / n).
double serial_fraction(double one, double many, int threads) { return (threads * many / one - 1.0) / (threads - 1.0); }

double ns_of(const CaseResult& r) { return r.number("ns_per_body_step", NAN); }

/// The runs of one size of the scene.
struct Size {
  const BenchSetup& setup;
  std::string label;
  std::vector<Case> cases;                       ///< by numbers of threads
  std::vector<std::vector<CaseResult>> results;  ///< the same, by round

  Size(const BenchSetup& s, const std::vector<std::string>& overrides) : setup(s), results(s.threads.size()) {
    for (const auto& o : overrides) label += (label.empty() ? "" : "; ") + o;
    for (const int n : s.threads) {
      cases.push_back({s.overrides, s.folder / fmt::format("threads_{}", n)});
      cases.back().overrides.insert(cases.back().overrides.end(), overrides.begin(), overrides.end());
    }
  }
  void run_round() {
    for (std::size_t k = 0; k < cases.size(); ++k) {
      results[k].push_back(run_case(setup.scene, cases[k], {setup.program, setup.threads[k], 0.0, true}));
      require_result(results[k].back());
    }
  }
  /// Steps that n copies at once make on one thread each, over those of one copy; ns: of that one.
  double speed_of_copies(int n, double ns) const {
    std::vector<Case> copies;
    for (int k = 0; k < n; ++k) copies.push_back({cases[0].overrides, setup.folder / fmt::format("copy_{}", k)});
    double speed = 0.0;
    const auto add = [&](std::size_t, const CaseResult& r) {
      require_result(r);
      speed += ns / ns_of(r);
    };
    if (!run_cases(setup.scene, copies, {setup.program, 1, 0.0, true}, n, add))
      throw SceneError(setup.scene + " was interrupted");
    return speed;
  }
  void require_result(const CaseResult& r) const {
    if (!r.completed() && r.summary.numbers.empty())
      throw SceneError(fmt::format("{} [{}] ended as '{}': {}", setup.scene, label, r.status, r.trouble));
    if (const auto& first = results[0].front(); r.summary.text("state_hash") != first.summary.text("state_hash"))
      throw SceneError(
          fmt::format("{} [{}]: the state hash at {} threads differs", setup.scene, label, r.number("threads", 1.0)));
  }
  /// Of median time, by numbers of threads; sorts the rounds.
  std::vector<const CaseResult*> medians() {
    std::vector<const CaseResult*> out;
    for (auto& all : results) {
      std::ranges::sort(all, {}, ns_of);
      out.push_back(&all[all.size() / 2]);
    }
    return out;
  }
};

/// Speed of the machine, measured after every round: the load of a shared one changes by the minute.
class Machine {
 public:
  /// Nothing where there is no one thread to compare with.
  explicit Machine(const std::vector<int>& threads) {
    one_ = std::ranges::find(threads, 1) - threads.begin();
    if (one_ == std::ssize(threads)) return;
    for (const int n : threads)
      if (n != 1) seen_.push_back({n, {}, {}});
  }
  void look(const Size& size) {
    for (Seen& s : seen_) {
      s.machine.push_back(machine_speedup(s.threads));
      if (size.setup.copies)
        s.copies.push_back(size.speed_of_copies(s.threads, ns_of(size.results[static_cast<std::size_t>(one_)].back())));
    }
  }
  /// Of medians, for every number of threads beside 1.
  std::string lines() {
    std::string lines;
    for (Seen& s : seen_) {
      const auto median = [&](double MachineSpeedup::*of) {
        std::ranges::sort(s.machine, {}, of);
        return s.machine[s.machine.size() / 2].*of;
      };
      lines += fmt::format(
          "# machine, {} threads: arithmetic {:.2f}x, triad {:.2f}x, round trip of a cache line {:.0f} ns\n", s.threads,
          median(&MachineSpeedup::arithmetic), median(&MachineSpeedup::triad),
          1e9 * median(&MachineSpeedup::round_trip));
      if (s.copies.empty()) continue;
      std::ranges::sort(s.copies);
      lines += fmt::format("# machine, {} copies of the scene at once, one thread each: together {:.2f}x\n", s.threads,
                           s.copies[s.copies.size() / 2]);
    }
    return lines;
  }

 private:
  struct Seen {
    int threads;
    std::vector<MachineSpeedup> machine;
    std::vector<double> copies;
  };
  std::ptrdiff_t one_;  ///< place of the one thread
  std::vector<Seen> seen_;
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

std::string bench_csv(const BenchRow& row) {
  std::string line = fmt::format("{},\"{}\",{},{:.6g}", row.scene, row.size, row.threads, row.ns_per_body_step);
  for (const double seconds : row.stage_seconds) line += fmt::format(",{:.6g}", seconds);
  return line + fmt::format(",{},{},{},{:.6g},{}\n", row.error_measure,
                            row.error ? fmt::format("{:.6g}", *row.error) : "", row.state_hash, row.bytes_per_body,
                            row.status);
}

std::string bench_json(const std::vector<BenchRow>& rows) {
  JsonWriter json;
  json.begin_array();
  for (const BenchRow& row : rows) {
    json.begin_object().member("scene", row.scene).member("size", row.size).member("threads", row.threads);
    json.member("ns_per_body_step", row.ns_per_body_step);
    for (std::size_t k = 0; k < row.stage_seconds.size(); ++k)
      json.member(std::string(stage_names[k]) + "_seconds", row.stage_seconds[k]);
    json.member("error_measure", row.error_measure).member("error", row.error).member("state_hash", row.state_hash);
    json.member("bytes_per_body", row.bytes_per_body).member("status", row.status).end_object();
  }
  json.end_array();
  return json.text() + "\n";
}

void run_bench(const BenchSetup& setup, const std::function<void(const BenchRow&)>& print,
               const std::function<void(const std::string&)>& remark) {
  const ReadResult read = read_scene(setup.scene, setup.overrides, full_registry());
  if (!read.scene) throw SceneError(read.problems);
  ErrorSpec error;
  error.name = read.scene->benchmark && !read.scene->benchmark->error.empty() ? read.scene->benchmark->error : "energy";
  for (const auto& overrides : sizes_of(*read.scene)) {
    Size size(setup, overrides);
    Machine machine(setup.threads);
    for (int round = 0; round < setup.repeats; ++round) {
      size.run_round();
      machine.look(size);
    }
    const std::vector<const CaseResult*> medians = size.medians();
    for (std::size_t k = 0; k < medians.size(); ++k)
      print(row_of(setup.scene, size.label, setup.threads[k], error, *medians[k], size.cases[k].folder));
    if (const std::string table = amdahl_table(medians, setup.threads); !table.empty()) remark(table + machine.lines());
  }
}

}  // namespace epafi
