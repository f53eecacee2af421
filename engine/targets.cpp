#include "engine/targets.h"

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace epafi {

namespace {

Target widest() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
    return Target::avx512;
  if (__builtin_cpu_supports("avx2")) return Target::avx2;
#endif
  return Target::baseline;
}

/// Of the environment; names it does not know are no limit: the bits are the same whatever is taken.
Target named() {
  const char* text = std::getenv("EPAFI_TARGET");
  const std::string_view name = text != nullptr ? text : "";
  return name == "baseline" ? Target::baseline : name == "avx2" ? Target::avx2 : Target::avx512;
}

Target& chosen() {
  static Target choice = std::min(widest(), named());
  return choice;
}

}  // namespace

Target target() { return chosen(); }
void limit_target(Target most) { chosen() = std::min(widest(), most); }

}  // namespace epafi
