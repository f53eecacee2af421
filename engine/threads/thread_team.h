/// @file thread_team.h  Threads that stay together from loop to loop within one parallel region. One atomic word starts
/// a loop, and it ends when its work is done: it does not wait for threads that have not arrived. A thread that other
/// programs preempt pauses for a while (engine/threads/preemption.h). An empty parallel region of libgomp takes 4 us, a
/// loop of a team 2.
/// @code
///   with_team([&] {                                  // engine/threads/parallel.h: starts the threads once
///     for (int k = 0; k < steps; ++k)
///       parallel_for(n, [&](std::size_t i) { y[i] += x[i]; });   // each loop is handed to the team
///   });
/// @endcode
#pragma once
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <utility>
#include <vector>

#include "engine/threads/event_count.h"
#include "engine/threads/preemption.h"

namespace epafi {

/// One thread leads, number 0; the others follow. f(member) of a loop gets numbers 0 .. size() - 1 without gaps.
class ThreadTeam {
 public:
  /// threads: leader included. polls: of a thread that waits for a loop, before it sleeps.
  ThreadTeam(std::size_t threads, int polls) : polls_(polls), members_(threads) {}

  /// The team that the calling thread leads and that is in no loop now; null where there is none.
  static ThreadTeam* idle() { return idle_; }

  /// Threads that the next loop is handed to: 1 while all others rest.
  std::size_t size() {
    if (resting_ > 0) call_rested();
    return threads_ - resting_;
  }
  /// Called by the leader: runs body(), whose loops call run(), then releases the other threads. threads: number
  /// started. An exception of body is kept for rethrow().
  template <class F>
  void lead(std::size_t threads, const F& body) {
    threads_ = threads;
    set_numbers();
    idle_ = this;
    attempt(body);
    idle_ = nullptr;
    for (Member& m : members_) m.number = 1;
    hand_out(nullptr, nullptr);
    returns_.wake();
  }
  /// By every other thread: its part of all loops, until the leader is through.
  void follow(std::size_t thread) {
    Member& me = members_[thread];
    long switches = involuntary_switches();
    for (std::uint32_t seen = 0;;) {
      order_.event.wait_until([&] { return order_.loop_count.load() != seen; }, polls_);
      seen = order_.loop_count.load();
      if (!join(me, seen)) {
        if (me.number.load() == 0) returns_.wait_until([&] { return me.number.load() != 0; }, 0);
        continue;
      }
      const Loop loop = order_.loop;
      if (loop == nullptr) return;
      const double begin = now();
      attempt([&] { loop(order_.what, me.number.load(std::memory_order_relaxed)); });
      if (now() - begin > long_loop) {
        const long before = std::exchange(switches, involuntary_switches());
        me.was_preempted = switches > before;
      }
      me.state.store(2 * seen);
      me.done.wake();
    }
  }
  /// f(member) by all of the team that come before the work is done; f must leave no work to a member that has not
  /// begun. Throws what the first of them threw, once all are through.
  template <class F>
  void run(const F& f) {
    idle_ = nullptr;  // a loop inside is one thread's own
    hand_out([](const void* what, std::size_t member) { (*static_cast<const F*>(what))(member); }, &f);
    attempt([&] { f(std::size_t{0}); });
    const std::uint32_t count = order_.loop_count.load(std::memory_order_relaxed);
    bool too_often = false;
    for (std::size_t thread = 1; thread < threads_; ++thread) too_often |= wait_for(members_[thread], count);
    if (too_often) set_numbers();
    idle_ = this;
    rethrow();
  }
  void rethrow() {
    if (!has_failed_.exchange(false)) return;
    std::rethrow_exception(trouble_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Loop = void (*)(const void*, std::size_t);
  static double now() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }
  static constexpr double long_loop = 3e-4;  ///< after which preemption is queried, a call of 0.3 us [s]

  struct Member {
    alignas(64) std::atomic<std::uint32_t> state{0};  ///< 2 k: through with loop k, or came too late; 2 k + 1: in it
    std::atomic<std::size_t> number{0};               ///< in the team; 0: rests, or the team has not begun
    bool was_preempted = false;                       ///< in its last loop
    Preemptions preemptions;
    EventCount done;
  };
  struct Order {
    alignas(64) std::atomic<std::uint32_t> loop_count{0};
    Loop loop = nullptr;         ///< null: there are no more loops
    const void* what = nullptr;  ///< in the same cache line, which goes to the others
    EventCount event;
  };

  void hand_out(Loop loop, const void* what) {
    order_.loop = loop;
    order_.what = what;
    order_.loop_count.store(order_.loop_count.load(std::memory_order_relaxed) + 1);
    order_.event.wake();
  }
  /// False where the leader has ended the loop, or the thread rests.
  static bool join(Member& m, std::uint32_t count) {
    std::uint32_t before = m.state.load();
    return before < 2 * count && m.number.load() != 0 && m.state.compare_exchange_strong(before, 2 * count + 1);
  }
  /// By the leader, whose part of the loop leaves nothing to those that have not begun; whether the thread is to rest.
  bool wait_for(Member& m, std::uint32_t count) {
    std::uint32_t before = m.state.load();
    if (before < 2 * count - 1 && m.state.compare_exchange_strong(before, 2 * count)) return false;
    const double begin = now();
    m.done.wait_until([&] { return m.state.load() == 2 * count; }, polls_);
    if (!std::exchange(m.was_preempted, false)) return false;
    const double time = now();
    m.preemptions.count(time, time - begin);
    return m.preemptions.rests(time);
  }
  void call_rested() {
    const double time = now();
    for (std::size_t thread = 1; thread < threads_; ++thread) {
      const Member& m = members_[thread];
      if (m.number.load(std::memory_order_relaxed) == 0 && !m.preemptions.rests(time)) return set_numbers();
    }
  }
  /// Between loops: numbers without gaps for those that do not rest.
  void set_numbers() {
    const double time = now();
    std::size_t next = 1;
    for (std::size_t thread = 1; thread < threads_; ++thread) {
      Member& m = members_[thread];
      m.number = m.preemptions.rests(time) ? 0 : next++;
    }
    resting_ = threads_ - next;
    returns_.wake();
  }
  template <class F>
  void attempt(const F& f) {
    try {
      f();
    } catch (...) {
      if (!has_failed_.exchange(true)) trouble_ = std::current_exception();
    }
  }

  static constinit inline thread_local ThreadTeam* idle_ = nullptr;
  int polls_;
  std::size_t threads_ = 1, resting_ = 0;
  std::vector<Member> members_;  ///< by thread
  Order order_;
  EventCount returns_;  ///< of threads that rest
  std::atomic<bool> has_failed_{false};
  std::exception_ptr trouble_;
};

}  // namespace epafi
