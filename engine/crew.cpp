#include "engine/crew.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>

#if defined(__linux__)
#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

namespace epafi {

namespace {
std::optional<int> wanted_looks() {
  constexpr int always = std::numeric_limits<int>::max() - 1;
  const auto text = [](const char* name) { return std::string(std::getenv(name) ? std::getenv(name) : ""); };
  const std::string count = text("GOMP_SPINCOUNT");
  std::string policy = text("OMP_WAIT_POLICY");
  std::ranges::transform(policy, policy.begin(), [](unsigned char c) { return std::tolower(c); });
  if (!count.empty() && std::ranges::all_of(count, [](unsigned char c) { return std::isdigit(c) != 0; }))
    return count.size() > 9 ? always : std::atoi(count.c_str());
  if (count.starts_with("inf") || policy == "active") return always;
  return policy == "passive" ? std::optional(0) : std::nullopt;
}
}  // namespace

int looks_before_sleep(bool more_than_processors) {
  static const std::optional<int> wanted = wanted_looks();
  return wanted.value_or(more_than_processors ? 100 : 10'000);
}

#if defined(__linux__)
// Not by std::atomic: libstdc++ yields before it sleeps, and beside busy programs a yield is a time slice of theirs.
// (scenes/library/stacking/pyramid.toml, two threads beside two busy loops: 2.5 to 6.7 s, so 0.9 to 1.3; alone 0.3.)
void Crew::sleep(const std::atomic<std::uint32_t>& word, std::uint32_t while_it_is) {
  syscall(SYS_futex, &word, FUTEX_WAIT_PRIVATE, while_it_is, nullptr, nullptr, 0);
}
void Crew::wake(std::atomic<std::uint32_t>& word) {
  syscall(SYS_futex, &word, FUTEX_WAKE_PRIVATE, std::numeric_limits<int>::max(), nullptr, nullptr, 0);
}
#else
void Crew::sleep(const std::atomic<std::uint32_t>& word, std::uint32_t while_it_is) { word.wait(while_it_is); }
void Crew::wake(std::atomic<std::uint32_t>& word) { word.notify_all(); }
#endif

}  // namespace epafi
