/// @file run_mark.h  Distinguishes a running run from a killed one. While a run writes it keeps `.running` in its
/// folder: host, process and its start, machine (boot and process namespace), folder, warnings so far. The file's time
/// of change moves on every second. Readers on the same machine test the process, which is exact on any file system. On
/// other machines the file must have changed within two minutes; a longer single step looks dead there until it ends.
/// Without a mark (older versions) changing files count.
#pragma once
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace epafi {

enum class RunLife {
  running,  ///< a program writes into the folder
  over,     ///< it ended and wrote summary.json
  cut       ///< no process writes, and no end was recorded
};

struct RunState {
  RunLife life = RunLife::over;
  std::string cause{};                  ///< of a cut: "process 123 on host a is gone"
  std::vector<std::string> warnings{};  ///< that the mark holds
};

/// State of the run in a folder.
[[nodiscard]] RunState run_state(const std::filesystem::path& folder);

/// Held by the writing program. A folder without write permission is not marked.
class RunMark {
 public:
  explicit RunMark(std::filesystem::path folder);
  ~RunMark();  ///< the mark goes
  RunMark(const RunMark&) = delete;
  RunMark& operator=(const RunMark&) = delete;

  /// Call it often: once a second it updates the time of change and returns true.
  bool beat();
  /// Stores warnings for a report of the run if it is killed.
  void tell(std::vector<std::string> warnings);

 private:
  void write() const;
  std::filesystem::path path_;
  std::string head_;
  std::vector<std::string> warnings_;
  std::chrono::steady_clock::time_point beaten_ = std::chrono::steady_clock::now();
};

}  // namespace epafi
