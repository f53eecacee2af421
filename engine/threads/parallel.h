/// @file parallel.h  The only door to OpenMP: loops whose bodies write to their own index, and sums in a fixed order.
/// Every result is the same bits for every thread count; tests/engine/test_parallel.cpp holds that.
#pragma once
#include <omp.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

#include "engine/threads/shared_out.h"
#include "engine/threads/thread_team.h"

namespace epafi {

inline constexpr std::size_t sum_block = 1024;  // summed in order inside, then block by block: independent of threads

inline int thread_count() { return omp_get_max_threads(); }
inline void set_thread_count(int n) { omp_set_num_threads(n); }

/// Processors that the threads are bound to (OMP_PROC_BIND, GOMP_CPU_AFFINITY); none where they are not.
inline std::vector<int> bound_processors() {
  std::vector<int> all;
  if (omp_get_proc_bind() == omp_proc_bind_false) return all;
  for (int place = 0; place < omp_get_num_places(); ++place) {
    const std::size_t before = all.size();
    all.resize(before + static_cast<std::size_t>(omp_get_place_num_procs(place)));
    omp_get_place_proc_ids(place, all.data() + before);
  }
  return all;
}

/// Number of the calling thread, below thread_count(); 0 outside loops.
inline std::size_t thread_number() { return static_cast<std::size_t>(omp_get_thread_num()); }

/// Calls body() with one team of threads for all its loops (engine/threads/thread_team.h); rethrows its exceptions.
template <class F>
void with_team(const F& body) {
  if (thread_count() == 1 || omp_in_parallel()) return body();
  ThreadTeam team(static_cast<std::size_t>(thread_count()), spin_limit(thread_count() > omp_get_num_procs()));
#pragma omp parallel
  if (thread_number() == 0)
    team.lead(static_cast<std::size_t>(omp_get_num_threads()), body);
  else
    team.follow(thread_number());
  team.rethrow();
}

/// Number of threads of the next loop: fewer than thread_count() while other programs need the processors. No result
/// may depend on it.
inline std::size_t team_size() {
  ThreadTeam* const team = ThreadTeam::idle();
  return team ? team->size() : static_cast<std::size_t>(thread_count());
}

/// Runs f(member) on team_size() threads at once. A thread that arrives after all work is done is skipped, so f must
/// distribute its work dynamically and leave none to a member that has not begun.
template <class F>
void parallel_team(const F& f) {
  if (ThreadTeam* const team = ThreadTeam::idle()) return team->run(f);
#pragma omp parallel
  f(thread_number());
}

/// One value per block, in thread-local memory that is reused from call to call: no allocation inside a step. Not
/// reentrant for one T.
template <class T>
std::vector<T>& block_results(std::size_t blocks, T start) {
  thread_local std::vector<T> kept;
  kept.assign(blocks, start);
  return kept;
}

/// In a cache line of its own. Uninitialised: zeroing 256 of them would dominate short loops.
struct alignas(64) Counter {
  std::size_t value;
};

/// Work stealing over pieces [0, n), n below 2^31. Each thread owns a run of neighbouring pieces, the same in all loops
/// of this length, so its data stay in its cache, and works from the front. An idle thread steals from the back of
/// other runs: a slow core then loses the same pieces in every loop, and they stay in the thief's cache. (Contacts of
/// 20 000 spheres in free fall, two threads, one core at two thirds of the other's speed: 0.135 s; 0.152 s if stolen
/// from the front.) If the owner of a run has not arrived, thieves take its front, so that no piece waits for earlier
/// ones that no thread works on.
class WorkRanges {
 public:
  /// left: one counter per run; they must outlive this.
  WorkRanges(std::size_t n, std::span<Counter> left) : n_(n), left_(left) {}
  void start() const {
    for (std::size_t p = 0; p < left_.size(); ++p)
      left_[p].value = n_ * p / left_.size() | n_ * (p + 1) / left_.size() << 32;
  }
  /// Calls f(piece) for the pieces that the calling thread takes.
  template <class F>
  void each(std::size_t thread, const F& f) const {
    const std::atomic_ref own(left_[thread % left_.size()].value);
    own.fetch_or(has_come, std::memory_order_relaxed);
    for (;;) {
      const std::size_t left = own.fetch_add(1, std::memory_order_relaxed);
      if (front(left) >= back(left)) break;
      f(front(left));
    }
    for (std::size_t k = 1; k < left_.size(); ++k) help(left_[(thread + k) % left_.size()], f);
  }
  /// Next piece of the calling thread's own run, unless a thief takes it first; n if none is left.
  std::size_t next_own(std::size_t thread) const {
    const std::size_t left = std::atomic_ref(left_[thread % left_.size()].value).load(std::memory_order_relaxed);
    return front(left) < back(left) ? front(left) : n_;
  }

 private:
  // Untaken pieces of a run: the first in the lower half, the end in the upper half below the last bit.
  static constexpr std::size_t has_come = std::size_t{1} << 63, one_at_the_back = std::size_t{1} << 32;
  static std::size_t front(std::size_t left) { return left & 0xffffffff; }
  static std::size_t back(std::size_t left) { return (left & ~has_come) >> 32; }

  template <class F>
  static void help(Counter& run, const F& f) {
    const std::atomic_ref other(run.value);
    for (std::size_t left = other.load(std::memory_order_relaxed); front(left) < back(left);) {
      const bool here = (left & has_come) != 0;
      const std::size_t rest = here ? left - one_at_the_back : left + 1;
      if (!other.compare_exchange_weak(left, rest, std::memory_order_relaxed)) continue;
      f(here ? back(rest) : front(left));
      left = other.load(std::memory_order_relaxed);
    }
  }

  std::size_t n_;
  std::span<Counter> left_;
};

/// Runs of one loop, with their own counters.
class LoopRuns {
 public:
  LoopRuns(std::size_t n, std::size_t threads) : runs_(n, std::span(left_).first(std::min(left_.size(), threads))) {
    runs_.start();
  }
  LoopRuns(const LoopRuns&) = delete;
  LoopRuns& operator=(const LoopRuns&) = delete;
  template <class F>
  void each(std::size_t thread, const F& f) const {
    runs_.each(thread, f);
  }
  std::size_t next_own(std::size_t thread) const { return runs_.next_own(thread); }

 private:
  std::array<Counter, 256> left_;
  WorkRanges runs_;
};

/// The body of a loop over blocks by its address: inlined into each way by which a thread comes to a block it was
/// compiled four times.
class BlockBody {
 public:
  template <class F>
  explicit BlockBody(const F& f)
      : f_(&f), call_([](const void* body, std::size_t begin, std::size_t end, std::size_t block) {
          (*static_cast<const F*>(body))(begin, end, block);
        }) {}
  void operator()(std::size_t begin, std::size_t end, std::size_t block) const { call_(f_, begin, end, block); }

 private:
  const void* f_;
  void (*call_)(const void*, std::size_t, std::size_t, std::size_t);
};

void run_blocks(std::size_t n, std::size_t size, const BlockBody& f);

/// f(begin, end, block) for consecutive blocks of `size` indices covering [0, n), shared out in runs.
template <class F>
void parallel_blocks(std::size_t n, std::size_t size, const F& f) {
  run_blocks(n, size, BlockBody(f));
}

/// f(i) for i in [0, n); f writes to its own index only. Short loops stay on one thread: a fork costs about 2 us.
template <class F>
void parallel_for(std::size_t n, const F& f, std::size_t grain = 512) {
  const std::size_t size = std::max<std::size_t>(1, n < 2 * grain ? n : grain / 4);
  parallel_blocks(n, size, [&](std::size_t begin, std::size_t end, std::size_t) {
    for (std::size_t i = begin; i < end; ++i) f(i);
  });
}

/// Sum of f(i) over [0, n), the same bits for every thread count. T needs T{} as zero and +=.
/// (`omp reduction` moved the energy in its 14th digit with the number of threads.)
template <class T, class F>
T block_sum(std::size_t n, const F& f) {
  const std::size_t blocks = (n + sum_block - 1) / sum_block;
  std::vector<T>& part = block_results<T>(blocks, T{});
  parallel_blocks(n, sum_block, [&](std::size_t begin, std::size_t end, std::size_t b) {
    T s{};
    for (std::size_t i = begin; i < end; ++i) s += f(i);
    part[b] = s;
  });
  T total{};
  for (const T& s : part) total += s;
  return total;
}

/// Largest f(i) over [0, n), at least `least`.
template <class T, class F>
T block_max(std::size_t n, T least, const F& f) {
  const std::size_t blocks = (n + sum_block - 1) / sum_block;
  std::vector<T>& part = block_results<T>(blocks, least);
  parallel_blocks(n, sum_block, [&](std::size_t begin, std::size_t end, std::size_t b) {
    T m = least;
    for (std::size_t i = begin; i < end; ++i) m = std::max(m, static_cast<T>(f(i)));
    part[b] = m;
  });
  for (const T& m : part) least = std::max(least, m);
  return least;
}

/// Sum of three terms: an aggregate of doubles with a zero and +=.
struct Sum3 {
  double a = 0, b = 0, c = 0;
  Sum3& operator+=(const Sum3& o) {
    a += o.a;
    b += o.b;
    c += o.c;
    return *this;
  }
};

}  // namespace epafi
