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

#include "engine/shared_out.h"

namespace epafi {

inline constexpr std::size_t sum_block = 1024;  // summed in order inside, then block by block: independent of threads

inline int thread_count() { return omp_get_max_threads(); }
inline void set_thread_count(int n) { omp_set_num_threads(n); }

/// f(i) for i in [0, n); f writes to its own index only. Short loops stay on one thread: a fork costs about 2 us.
template <class F>
void parallel_for(std::size_t n, const F& f, std::size_t grain = 512) {
  const bool pays = n >= 2 * grain;
  const SharedOut meter(pays);
  if (!pays || thread_count() == 1) {
    for (std::size_t i = 0; i < n; ++i) f(i);
    return;
  }
#pragma omp parallel for schedule(static)
  for (std::size_t i = 0; i < n; ++i) f(i);
}

/// Of the calling thread, below thread_count(); 0 outside loops.
inline std::size_t thread_number() { return static_cast<std::size_t>(omp_get_thread_num()); }

/// f(thread) by every thread at once.
template <class F>
void parallel_team(const F& f) {
#pragma omp parallel
  f(thread_number());
}

/// One value per block, kept by the calling thread from call to call: no allocation inside a step. Not to be nested for
/// one T.
template <class T>
std::vector<T>& block_results(std::size_t blocks, T start) {
  thread_local std::vector<T> kept;
  kept.assign(blocks, start);
  return kept;
}

/// In a cache line of its own. No first value: 256 of them stand before every short loop.
struct alignas(64) Counter {
  std::size_t value;
};

/// Pieces [0, n) shared out over threads: each has a run of neighbours, the same in every loop over as many, so that
/// what it wrote is near it, and helps the others when it is through.
class Runs {
 public:
  /// next: one for each run, of whoever calls; they outlive this.
  Runs(std::size_t n, std::span<Counter> next) : n_(n), next_(next) {}
  void start() const {
    for (std::size_t p = 0; p < next_.size(); ++p) next_[p].value = n_ * p / next_.size();
  }
  /// f(piece) for those the calling thread takes, each run from its beginning on.
  template <class F>
  void each(std::size_t thread, const F& f) const {
    for (std::size_t k = 0; k < next_.size(); ++k) {
      const std::size_t p = (thread + k) % next_.size(), end = n_ * (p + 1) / next_.size();
      const std::atomic_ref place(next_[p].value);
      for (std::size_t i; (i = place.fetch_add(1, std::memory_order_relaxed)) < end;) f(i);
    }
  }

 private:
  std::size_t n_;
  std::span<Counter> next_;
};

/// Runs of one loop, with their own counters.
class LoopRuns {
 public:
  explicit LoopRuns(std::size_t n)
      : runs_(n, std::span(next_).first(std::min(next_.size(), static_cast<std::size_t>(thread_count())))) {
    runs_.start();
  }
  LoopRuns(const LoopRuns&) = delete;
  LoopRuns& operator=(const LoopRuns&) = delete;
  template <class F>
  void each(std::size_t thread, const F& f) const {
    runs_.each(thread, f);
  }

 private:
  std::array<Counter, 256> next_;
  Runs runs_;
};

/// f(begin, end, block) for consecutive blocks of `size` indices covering [0, n), shared out in runs.
template <class F>
void parallel_blocks(std::size_t n, std::size_t size, const F& f) {
  const std::size_t blocks = (n + size - 1) / size;
  const auto one = [&](std::size_t b) { f(b * size, std::min(n, (b + 1) * size), b); };
  const SharedOut meter(blocks > 1);
  if (blocks < 2 || thread_count() == 1) {
    for (std::size_t b = 0; b < blocks; ++b) one(b);
    return;
  }
  const LoopRuns runs(blocks);
  parallel_team([&](std::size_t thread) { runs.each(thread, one); });
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

/// Sum of six-vectors and the like: an aggregate of doubles with a zero and +=.
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
