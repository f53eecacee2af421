/// @file event_count.h  Event count: threads that wait for a condition poll some times, then sleep on a futex until
/// they are woken.
#pragma once
#include <atomic>
#include <cstdint>

namespace epafi {

/// Polls before a thread that waits for the next loop sleeps: about half a millisecond; few with more threads than
/// processors, since a polling thread then keeps the awaited one from running.
inline constexpr int spin_limit(bool more_threads_than_processors) {
  return more_threads_than_processors ? 100 : 10'000;
}

/// Lets threads wait for a condition. It must outlive every wait.
class EventCount {
 public:
  /// Returns true once ready(), which reads what others have written by sequentially consistent atomics; false where
  /// one of them gives up first.
  template <class Ready>
  bool wait_until(const Ready& ready, int polls) {
    for (int k = 0; k < polls; ++k) {
      if (ready()) return true;
      pause();
    }
    waiting_.fetch_add(1);  // seen by every thread that writes after the next call of ready()
    bool is_ready = false;
    for (;;) {
      const std::uint32_t calls = calls_.load();
      is_ready = ready();
      if (is_ready || given_up_) break;
      sleep(calls);
    }
    waiting_.fetch_sub(1);
    return is_ready;
  }
  /// Called by the thread that has written what ready() reads.
  void wake() {
    if (waiting_.load() > 0) wake_all();
  }
  /// Called by a thread that cannot make the condition true.
  void give_up() {
    given_up_ = true;
    wake_all();
  }

 private:
  void wake_all();
  void sleep(std::uint32_t calls);
  static void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }

  alignas(64) std::atomic<int> waiting_{0};
  std::atomic<bool> given_up_{false};
  std::atomic<std::uint32_t> calls_{0};
};

}  // namespace epafi
