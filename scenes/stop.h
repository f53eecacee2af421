/// @file stop.h  Reasons to stop a run early: signals, wall time, simulated time, steps.
#pragma once
#include <chrono>
#include <optional>
#include <string>

namespace epafi {

/// Catches SIGINT and SIGTERM while it lives: the step is finished, a checkpoint written. A second signal, half
/// a second later or more, ends at once. One watch within another adds nothing.
class SignalWatch {
 public:
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;
  /// The signal received, 0 for none.
  static int received();
};

/// "90s", "3h50m", "1.5h", "45" (seconds) -> seconds; empty where it is none of these.
std::optional<double> parse_duration(const std::string& text);

}  // namespace epafi
