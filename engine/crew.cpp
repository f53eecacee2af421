#include "engine/crew.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>

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

}  // namespace epafi
