/// @file crew.h  Threads that stay together from loop to loop: a loop is handed out by one word and given back by one.
/// An empty parallel region of libgomp takes 4 us where a word takes half a microsecond from one processor to the other
/// and back; a loop here takes 2. (Two threads, ns a sphere and step, means in turns: hopper that fills 6.6, so 6.1; in
/// full flow, nine loops a step, 53.1 and 50.6.)
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <string>
#include <vector>

namespace epafi {

/// How often a thread that waits looks before it sleeps: GOMP_SPINCOUNT (a number or infinity), else OMP_WAIT_POLICY
/// (active or passive), else half a millisecond's looks, few where there are more threads than processors. (Two threads
/// on two processors beside two other programs: 65 to 79 ns a sphere and step in a bed of 10 000, with the 300 000
/// looks of libgomp 81 to 822; alone 24, with 200 looks 31.)
int looks_before_sleep(bool more_than_processors);
/// The same from what the two say; empty: nothing.
int looks_before_sleep(const std::string& spin_count, std::string policy, bool more_than_processors);

/// Of one thread that leads, number 0, and others that follow.
class Crew {
 public:
  /// most: threads, the leader among them.
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
      wait_for(order_, k);
      if (order_.loop == nullptr) return;
      attempt([&] { order_.loop(order_.what, thread); });
      tell(done_[thread], k);
    }
  }
  /// f(thread) by all at once. Throws what the first of them threw, once all are through.
  template <class F>
  void run(const F& f) {
    idle_ = nullptr;  // a loop inside is one thread's own
    hand_out([](const void* what, std::size_t thread) { (*static_cast<const F*>(what))(thread); }, &f);
    attempt([&] { f(std::size_t{0}); });
    const std::uint32_t k = order_.number.load(std::memory_order_relaxed);
    for (std::size_t thread = 1; thread < members_; ++thread) wait_for(done_[thread], k);
    idle_ = this;
    rethrow();
  }
  void rethrow() {
    if (!has_failed_.exchange(false)) return;
    std::rethrow_exception(trouble_);
  }

 private:
  using Loop = void (*)(const void*, std::size_t);
  struct Order {
    alignas(64) std::atomic<std::uint32_t> number{0};  ///< loops handed out
    Loop loop = nullptr;                               ///< the last of them; null: there are no more
    const void* what = nullptr;                        ///< in the same cache line, which goes to the others
    alignas(64) std::atomic<int> sleepers{0};
  };
  struct Done {
    alignas(64) std::atomic<std::uint32_t> number{0};  ///< loops gone through
    alignas(64) std::atomic<int> sleepers{0};
  };

  void hand_out(Loop loop, const void* what) {
    order_.loop = loop, order_.what = what;
    tell(order_, order_.number.load(std::memory_order_relaxed) + 1);
  }
  template <class Word>
  static void tell(Word& word, std::uint32_t number) {
    word.number.store(number);  // seen by who counts himself among the sleepers after the next look
    if (word.sleepers.load() > 0) wake(word.number);
  }
  template <class Word>
  void wait_for(Word& word, std::uint32_t number) const {
    int looks = 0;
    for (std::uint32_t now; (now = word.number.load(std::memory_order_acquire)) != number;)
      if (looks < looks_) {
        ++looks, rest();
      } else {
        ++word.sleepers;
        sleep(word.number, now);
        --word.sleepers;
      }
  }
  static void sleep(const std::atomic<std::uint32_t>& word, std::uint32_t while_it_is);
  static void wake(std::atomic<std::uint32_t>& word);
  static void rest() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
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
  std::vector<Done> done_;  ///< by thread
  Order order_;
  std::atomic<bool> has_failed_{false};
  std::exception_ptr trouble_;
};

}  // namespace epafi
