#include "engine/sleepers.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <limits>
#include <string>

#if defined(__linux__)
#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace epafi {

int looks_before_sleep(const std::string& spin_count, std::string policy, bool more_than_processors) {
  constexpr int always = std::numeric_limits<int>::max();
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  std::ranges::transform(policy, policy.begin(), [](unsigned char c) { return std::tolower(c); });
  if (!spin_count.empty() && std::ranges::all_of(spin_count, is_digit))
    return spin_count.size() > 9 ? always : std::atoi(spin_count.c_str());
  if (spin_count.starts_with("inf") || policy == "active") return always;
  if (policy == "passive") return 0;
  return more_than_processors ? 100 : 10'000;
}

int looks_before_sleep(bool more_than_processors) {
  const auto text = [](const char* name) { return std::string(std::getenv(name) ? std::getenv(name) : ""); };
  return looks_before_sleep(text("GOMP_SPINCOUNT"), text("OMP_WAIT_POLICY"), more_than_processors);
}

#if defined(__linux__)
// Not by std::atomic: libstdc++ yields before it sleeps, and beside busy programs a yield is a time slice of theirs.
// (scenes/library/stacking/pyramid.toml, two threads beside two busy loops: 2.5 to 6.7 s, so 0.9 to 1.3; alone 0.3.)
void Sleepers::sleep(std::uint32_t calls) {
  syscall(SYS_futex, &calls_, FUTEX_WAIT_PRIVATE, calls, nullptr, nullptr, 0);
}
void Sleepers::call() {
  ++calls_;
  syscall(SYS_futex, &calls_, FUTEX_WAKE_PRIVATE, std::numeric_limits<int>::max(), nullptr, nullptr, 0);
}
#else
void Sleepers::sleep(std::uint32_t calls) { calls_.wait(calls); }
void Sleepers::call() { ++calls_, calls_.notify_all(); }
#endif

}  // namespace epafi
