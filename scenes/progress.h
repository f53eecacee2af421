/// @file progress.h  Progress of a run on stderr: a bar on a terminal, else a line every 10 s.
#pragma once
#include <chrono>
#include <string>

#include "scenes/assemble.h"
#include "scenes/monitor.h"

namespace epafi {

class Progress {
 public:
  /// steps: of the whole run; first: those done before (a resumed run).
  Progress(std::uint64_t steps, std::uint64_t first, bool quiet);
  /// A stage begins: progress is counted from here.
  void enter(const std::string& stage, std::uint64_t first_step, std::uint64_t last_step);
  /// Cheap to call every step: prints at most every 0.5 s (bar) or 10 s (lines).
  void update(Simulation& sim, const RunMonitor& monitor);
  void finish(Simulation& sim, const RunMonitor& monitor);

 private:
  using Clock = std::chrono::steady_clock;
  std::string line(Simulation& sim, const RunMonitor& monitor) const;
  void print(Simulation& sim, const RunMonitor& monitor);

  std::uint64_t steps_, first_, begin_ = 0;
  std::string stage_;
  bool quiet_, terminal_;
  Clock::time_point start_, last_;
  std::size_t warned_ = 0;  ///< kinds of warnings that a printed line has shown
};

/// "3:07" or "2:15:30".
std::string clock_text(double seconds);

/// Warns of each source that is behind its rate by more than 2 %.
void report_late_sources(const Assembly& assembly);

}  // namespace epafi
