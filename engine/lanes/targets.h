/// @file targets.h  One loop compiled for several instruction sets, the widest that this processor runs chosen at run
/// time. `Task::run() const`, or `Task::run<lanes>() const` for 2, 4 or 8 numbers a register, and all below it must be
/// inlined (EPAFI_LANES): functions of their own keep the baseline. The loop takes the task, or a Call that the task is
/// made from: then loops of several tasks are of one type.
/// Contraction is off everywhere, so the bits are the same; tests/laws/test_pgs.cpp holds that. A product and sum in
/// one instruction stands only where the product is exact. Include it in a .cpp that is compiled with -fno-math-errno:
/// sqrt must be one instruction for four lanes.
#pragma once
#include "engine/lanes/lanes.h"

namespace epafi {

enum class Target { baseline, avx2, avx512 };

/// The widest one of this processor, or the narrower one that the environment names: EPAFI_TARGET = baseline, avx2,
/// avx512. SceneError where it names something else; the program asks before it does anything.
Target target();
/// Takes at most this one from now on; for tests and measurements.
void limit_target(Target most);

namespace target_detail {
template <int lanes, class Task, class Call>
[[gnu::always_inline]] inline void run(const Call& call) {
  if constexpr (!std::same_as<Task, Call>)
    Task{call}.template run<lanes>();
  else if constexpr (requires { call.template run<lanes>(); })
    call.template run<lanes>();
  else
    call.run();
}
template <class Task, class Call = Task>
void run_baseline(const Call& call) {
  run<2, Task>(call);
}
// EPAFI_ONE_TARGET: for builds with sanitizers, which take minutes for each copy of the loop over spheres
#if defined(__x86_64__) && !defined(EPAFI_ONE_TARGET)
template <class Task, class Call = Task>
[[gnu::target("avx2,fma")]] void run_avx2(const Call& call) {
  run<4, Task>(call);
}
template <class Task, class Call = Task>
[[gnu::target("avx512f,avx512vl,avx512dq,fma")]] void run_avx512(const Call& call) {
  run<8, Task>(call);
}
#endif
}  // namespace target_detail

/// task.run<lanes>() as a function of its own, from within a loop of so many lanes.
template <int lanes, class Task>
EPAFI_LANES void run_apart(const Task& task) {
#if defined(__x86_64__) && !defined(EPAFI_ONE_TARGET)
  if constexpr (lanes == 8)
    target_detail::run_avx512<Task>(task);
  else if constexpr (lanes == 4)
    target_detail::run_avx2<Task>(task);
  else
#endif
    target_detail::run_baseline<Task>(task);
}

template <class Task, class Call = Task>
auto best_loop() -> void (*)(const Call&) {
#if defined(__x86_64__) && !defined(EPAFI_ONE_TARGET)
  if (target() == Target::avx512) return target_detail::run_avx512<Task, Call>;
  if (target() == Target::avx2) return target_detail::run_avx2<Task, Call>;
#endif
  return target_detail::run_baseline<Task, Call>;
}

}  // namespace epafi
