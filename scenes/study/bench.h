/// @file bench.h  `epafi bench`: how a scene scales with its size and with threads. Every row holds time, error and
/// state hash.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace epafi {

struct BenchSetup {
  std::string scene;
  std::vector<std::string> overrides;
  std::vector<int> threads;
  int repeats = 3;  ///< the row with the median time is printed
  std::filesystem::path folder;
  bool copies = false;  ///< also n copies of the scene at once, each on one thread: what n threads may bring at most
  std::string program = "/proc/self/exe";  ///< that runs the cases
};

/// Median run of one size at one number of threads.
struct BenchRow {
  std::string scene, size;
  int threads = 1;
  double ns_per_body_step = 0.0;
  std::vector<double> stage_seconds;  ///< by stage_names
  std::string error_measure;
  std::optional<double> error;
  std::string state_hash;
  double bytes_per_body = 0.0;
  std::string status;
};

std::string bench_header();
std::string bench_csv(const BenchRow& row);
/// A list of objects with the names of the header.
std::string bench_json(const std::vector<BenchRow>& rows);

/// Runs every size of [benchmark] (the scene as it is where it has none) at every number of threads; repeats take
/// turns. After the rows of a size come the serial part of each stage, Amdahl's fractions, and what the machine gives
/// (machine_speedup.h; with `copies` also to this very scene), `remark`: lines that begin with "#". Throws SceneError
/// where the state hash depends on the threads.
void run_bench(const BenchSetup& setup, const std::function<void(const BenchRow&)>& print,
               const std::function<void(const std::string&)>& remark);

}  // namespace epafi
