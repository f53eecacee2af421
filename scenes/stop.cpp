#include "scenes/stop.h"

#include <csignal>
#include <cstdlib>

namespace epafi {

namespace {
volatile std::sig_atomic_t received_signal = 0;
int watches = 0;  // alive, one within the other

void on_signal(int number) {
  if (received_signal != 0) std::_Exit(128 + number);
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
