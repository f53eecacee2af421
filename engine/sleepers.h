/// @file sleepers.h  Threads that wait for others: they look some times, then sleep until they are woken.
#pragma once
#include <atomic>
#include <cstdint>
#include <string>

namespace epafi {

/// How often a thread that waits for the next loop looks before it sleeps: GOMP_SPINCOUNT (a number or infinity), else
/// OMP_WAIT_POLICY (active or passive), else half a millisecond's looks, few where there are more threads than
/// processors. (Two threads on two processors beside two other programs: 65 to 79 ns a sphere and step in a bed of
/// 10 000, with the 300 000 looks of libgomp 81 to 822; alone 24, with 200 looks 31.)
int looks_before_sleep(bool more_than_processors);
/// The same from what the two say; empty: nothing.
int looks_before_sleep(const std::string& spin_count, std::string policy, bool more_than_processors);

/// Of one thing that is waited for. It outlives the wait.
class Sleepers {
 public:
  /// Until ready(), which reads what others have written by sequentially consistent atomics; false where one of them
  /// gives up before.
  template <class Ready>
  bool wait_until(const Ready& ready, int looks) {
    for (int k = 0; k < looks; ++k, rest())
      if (ready()) return true;
    count_.fetch_add(1);  // whoever writes after the next look sees it
    bool is_ready = false;
    for (std::uint32_t calls; calls = calls_.load(), !(is_ready = ready()) && !given_up_;) sleep(calls);
    count_.fetch_sub(1);
    return is_ready;
  }
  /// By whoever has written what ready() reads.
  void wake() {
    if (count_.load() > 0) call();
  }
  /// By whoever can not do what others wait for.
  void give_up() { given_up_ = true, call(); }

 private:
  void call();
  void sleep(std::uint32_t calls);
  static void rest() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }

  alignas(64) std::atomic<int> count_{0};
  std::atomic<bool> given_up_{false};
  std::atomic<std::uint32_t> calls_{0};
};

}  // namespace epafi
