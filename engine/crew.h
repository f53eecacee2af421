/// @file crew.h  Threads that stay together from loop to loop: a loop is handed out by one word and given back by one.
/// An empty parallel region of libgomp takes 4 us where a word takes half a microsecond from one processor to the other
/// and back; a loop here takes 2. (Two threads, ns a sphere and step, means in turns: hopper that fills 6.6, so 6.1; in
/// full flow, nine loops a step, 53.1 and 50.6.)
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <vector>

#include "engine/sleepers.h"

namespace epafi {

/// Of one thread that leads, number 0, and others that follow.
class Crew {
 public:
  /// most: threads, the leader among them; looks: of who waits for a loop, before it sleeps.
  Crew(std::size_t most, int looks) : looks_(looks), done_(most) {}

  /// The crew that the calling thread leads and that is in no loop now; null where there is none.
  static Crew* idle() { return idle_; }

  /// By the leader: body(), whose loops call run(); the others go home then. members: threads that came. What body
  /// throws is kept for rethrow().
  template <class F>
  void lead(std::size_t members, const F& body) {
    members_ = members, idle_ = this;
    attempt(body);
    idle_ = nullptr;
    hand_out(nullptr, nullptr);
  }
  /// By every other: its part of all loops, until the leader is through.
  void follow(std::size_t thread) {
    for (std::uint32_t k = 1;; ++k) {
      order_.wait_for(k, looks_);
      if (order_.loop == nullptr) return;
      attempt([&] { order_.loop(order_.what, thread); });
      done_[thread].tell(k);
    }
  }
  /// f(thread) by all at once. Throws what the first of them threw, once all are through.
  template <class F>
  void run(const F& f) {
    idle_ = nullptr;  // a loop inside is one thread's own
    hand_out([](const void* what, std::size_t thread) { (*static_cast<const F*>(what))(thread); }, &f);
    attempt([&] { f(std::size_t{0}); });
    const std::uint32_t k = order_.number.load(std::memory_order_relaxed);
    for (std::size_t thread = 1; thread < members_; ++thread) done_[thread].wait_for(k, looks_);
    idle_ = this;
    rethrow();
  }
  void rethrow() {
    if (!has_failed_.exchange(false)) return;
    std::rethrow_exception(trouble_);
  }

 private:
  using Loop = void (*)(const void*, std::size_t);
  /// Loops handed out, or gone through by one thread.
  struct Count {
    alignas(64) std::atomic<std::uint32_t> number{0};
    Loop loop = nullptr;         ///< of the order, the last of them; null: there are no more
    const void* what = nullptr;  ///< in the same cache line, which goes to the others
    Sleepers sleepers;

    void tell(std::uint32_t now) { number.store(now), sleepers.wake(); }
    void wait_for(std::uint32_t wanted, int looks) {
      sleepers.wait_until([&] { return number.load() == wanted; }, looks);
    }
  };

  void hand_out(Loop loop, const void* what) {
    order_.loop = loop, order_.what = what;
    order_.tell(order_.number.load(std::memory_order_relaxed) + 1);
  }
  template <class F>
  void attempt(const F& f) {
    try {
      f();
    } catch (...) {
      if (!has_failed_.exchange(true)) trouble_ = std::current_exception();
    }
  }

  static constinit inline thread_local Crew* idle_ = nullptr;
  int looks_;
  std::size_t members_ = 1;
  std::vector<Count> done_;  ///< by thread
  Count order_;
  std::atomic<bool> has_failed_{false};
  std::exception_ptr trouble_;
};

}  // namespace epafi
