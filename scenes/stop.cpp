#include "scenes/stop.h"

#include <time.h>

#include <csignal>
#include <cstdlib>

namespace epafi {

namespace {
volatile std::sig_atomic_t received_signal = 0;
volatile double received_at = 0.0;  // [s]
int watches = 0;                    // alive, one within the other

double seconds() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// `timeout` and terminals send one wish twice, to a process and to its group: what follows at once is no second wish.
void on_signal(int number) {
  constexpr double echo = 0.5;  // [s]
  if (received_signal == 0)
    received_at = seconds();
  else if (seconds() - received_at > echo)
    std::_Exit(128 + number);
  received_signal = number;
}
}  // namespace

SignalWatch::SignalWatch() {
  if (watches++ > 0) return;
  received_signal = 0;
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

SignalWatch::~SignalWatch() {
  if (--watches > 0) return;
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

int SignalWatch::received() { return received_signal; }

std::optional<double> parse_duration(const std::string& text) {
  double total = 0;
  const char* p = text.c_str();
  if (*p == '\0') return std::nullopt;
  while (*p != '\0') {
    char* end = nullptr;
    const double value = std::strtod(p, &end);
    if (end == p || !(value >= 0) || value > 1e12) return std::nullopt;
    const bool first = p == text.c_str();
    p = end;
    if (*p == 'h') {
      total += 3600 * value;
      ++p;
    } else if (*p == 'm') {
      total += 60 * value;
      ++p;
    } else if (*p == 's') {
      total += value;
      ++p;
    } else if (*p == '\0' && first) {
      total += value;  // seconds, unless other units stand before
    } else {
      return std::nullopt;
    }
  }
  return total;
}

}  // namespace epafi
