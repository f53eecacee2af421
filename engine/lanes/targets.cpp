#include "engine/lanes/targets.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "engine/units/error.h"
#include "engine/units/nearest.h"

namespace epafi {

namespace {

Target widest() {
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return Target::baseline;
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
    return Target::avx512;
  return Target::avx2;
#endif
  return Target::baseline;
}

/// The target named by the environment. An unknown name is refused, so that timings never use an unintended one.
Target named() {
  const char* text = std::getenv("EPAFI_TARGET");
  if (text == nullptr || *text == '\0') return Target::avx512;
  static const std::vector<std::string> names{"baseline", "avx2", "avx512"};
  const auto at = std::find(names.begin(), names.end(), text);
  if (at != names.end()) return static_cast<Target>(at - names.begin());
  throw SceneError("EPAFI_TARGET in the environment is '" + std::string(text) + "', no instruction set" +
                   suggestion(text, names, "there are") +
                   " (baseline is SSE2; none given: the widest of the processor)");
}

Target& chosen() {
  static Target choice = std::min(widest(), named());
  return choice;
}

}  // namespace

Target target() { return chosen(); }
void limit_target(Target most) { chosen() = std::min(widest(), most); }

}  // namespace epafi
