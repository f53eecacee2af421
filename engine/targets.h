/// @file targets.h  One loop compiled for several instruction sets, the widest that this processor runs chosen at run
/// time. `Task::run() const`, or `Task::run<lanes>() const` for 2, 4 or 8 numbers a register, and all below it must be
/// inlined (EPAFI_LANES): functions of their own keep the baseline.
/// Contraction is off everywhere, so the bits are the same; tests/laws/test_pgs.cpp holds that. A product and sum in
/// one instruction stands only where the product is exact. Include it in a .cpp that is compiled with -fno-math-errno:
/// sqrt must be one instruction for four lanes.
#pragma once
#include "engine/lanes.h"

namespace epafi {

enum class Target { baseline, avx2, avx512 };

/// The widest one of this processor, or the narrower one that the environment names: EPAFI_TARGET = baseline, avx2,
/// avx512. SceneError where it names something else; the program asks before it does anything.
Target target();
/// Takes at most this one from now on; for tests and measurements.
void limit_target(Target most);

namespace target_detail {
template <int lanes, class Task>
[[gnu::always_inline]] inline void run(const Task& task) {
  if constexpr (requires { task.template run<lanes>(); })
    task.template run<lanes>();
  else
    task.run();
}
template <class Task>
void run_baseline(const Task& task) {
  run<2>(task);
}
// EPAFI_ONE_TARGET: for builds with sanitizers, which take minutes for each copy of the loop over spheres
#if defined(__x86_64__) && !defined(EPAFI_ONE_TARGET)
template <class Task>
[[gnu::target("avx2,fma")]] void run_avx2(const Task& task) {
  run<4>(task);
}
template <class Task>
[[gnu::target("avx512f,avx512vl,avx512dq,fma")]] void run_avx512(const Task& task) {
  run<8>(task);
}
#endif
}  // namespace target_detail

/// task.run<lanes>() as a function of its own, from within a loop of so many lanes.
template <int lanes, class Task>
EPAFI_LANES void run_apart(const Task& task) {
#if defined(__x86_64__) && !defined(EPAFI_ONE_TARGET)
  if constexpr (lanes == 8)
    target_detail::run_avx512(task);
  else if constexpr (lanes == 4)
    target_detail::run_avx2(task);
  else
#endif
    target_detail::run_baseline(task);
}

template <class Task>
auto best_loop() -> void (*)(const Task&) {
#if defined(__x86_64__) && !defined(EPAFI_ONE_TARGET)
  if (target() == Target::avx512) return target_detail::run_avx512<Task>;
  if (target() == Target::avx2) return target_detail::run_avx2<Task>;
#endif
  return target_detail::run_baseline<Task>;
}

}  // namespace epafi
