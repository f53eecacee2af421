/// @file parallel_wavefront.h  Two passes over parts with dependences between them, the second while data are in cache.
#pragma once
#include <cstdint>
#include <numeric>
#include <span>

#include "engine/threads/parallel_stages.h"

namespace epafi {

namespace parallel_detail {
/// Parts that one thread has found but not finished, each with the number of its accumulator.
class Waiting {
 public:
  Waiting(std::size_t first, std::size_t accumulators) : free_(kept_free()), parts_(kept_parts()) {
    free_.resize(accumulators);
    parts_.clear();
    std::iota(free_.rbegin(), free_.rend(), first);  // the lowest first: those it had in the last call
  }
  std::size_t size() const { return parts_.size(); }
  std::size_t accumulator() const { return free_.back(); }
  void add(std::size_t part) {
    parts_.push_back({part, accumulator(), 0});
    free_.pop_back();
  }

  /// Calls finish(part, accumulator) for the parts that are ready(part, seen); returns whether there were any. `seen`
  /// keeps the number of sources that are known to be found.
  template <class Ready, class Finish>
  bool finish_ready(const Ready& ready, const Finish& finish) {
    const std::size_t before = size();
    std::erase_if(parts_, [&](Part& p) {
      if (!ready(p.part, p.seen)) return false;
      finish(p.part, p.accumulator);
      free_.push_back(p.accumulator);
      return true;
    });
    return size() < before;
  }

 private:
  struct Part {
    std::size_t part, accumulator, seen;
  };
  static std::vector<std::size_t>& kept_free() {
    thread_local std::vector<std::size_t> kept;
    return kept;
  }
  static std::vector<Part>& kept_parts() {
    thread_local std::vector<Part> kept;
    return kept;
  }
  std::vector<std::size_t>& free_;
  std::vector<Part>& parts_;
};

/// Which of n parts, shared out in runs, are found. Each thread writes flags and a count in cache lines of its own, and
/// a waiting thread reads those of all. (One common count and adjacent flags would move a cache line between cores with
/// every part.)
class Finds {
 public:
  Finds(std::size_t n, std::size_t runs)
      : n_(n),
        runs_(runs),
        flags_(block_results<unsigned char>(n + line * runs, 0)),
        counts_(block_results<Counter>(runs, Counter{})) {}

  void add(std::size_t thread, std::size_t i) {
    std::atomic_ref(flags_[place(i)]).store(1, std::memory_order_release);
    std::atomic_ref(counts_[thread % runs_].value).fetch_add(1);
    event_.wake();
  }
  bool has(std::size_t i) const { return std::atomic_ref(flags_[place(i)]).load(std::memory_order_acquire) != 0; }
  std::size_t count() const {
    std::size_t sum = 0;
    for (Counter& c : counts_) sum += std::atomic_ref(c.value).load();
    return sum;
  }
  /// Until there are more than `seen`; false where a thread gave up.
  bool wait_beyond(std::size_t seen) {
    return event_.wait_until([&] { return count() > seen; }, polls_for_piece);
  }
  EventCount& event() { return event_; }

 private:
  static constexpr std::size_t line = 64;
  std::size_t place(std::size_t i) const {
    return i + line * (((i + 1) * runs_ - 1) / n_);
  }  // as WorkRanges share them out

  std::size_t n_, runs_;
  std::vector<unsigned char>& flags_;
  std::vector<Counter>& counts_;
  EventCount event_;
};
}  // namespace parallel_detail

/// Best order in which `threads` threads find the parts of their runs: first the parts that other runs depend on, last
/// the parts that depend on other runs. sources: as below.
template <class Sources>
void order_wavefront(std::size_t n, std::size_t threads, const Sources& sources, std::vector<std::uint32_t>& order) {
  enum : unsigned char { waited_for, neither, waits };
  std::vector<unsigned char> rank(n, neither);
  order.resize(n);
  std::iota(order.begin(), order.end(), 0u);
  const auto each_run = [&](const auto& f) {
    for (std::size_t run = 0; run < threads; ++run) f(n * run / threads, n * (run + 1) / threads);
  };
  each_run([&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const std::size_t k : sources(i)) {
        if (k >= begin) continue;
        rank[k] = waited_for;
        if (rank[i] == neither) rank[i] = waits;
      }
  });
  each_run([&](std::size_t begin, std::size_t end) {
    std::ranges::stable_sort(std::span(order).subspan(begin, end - begin), {},
                             [&](std::uint32_t i) { return rank[i]; });
  });
}

/// Calls find(i, accumulator) for i in [0, n), and on the same thread finish(i, accumulator, next) once find(k) is done
/// for all k in sources(i), which are below i. next: the part that the thread finds next, for prefetching; i where none
/// is left. Parts are shared out in runs. A part that waits for its sources keeps its accumulator while the thread goes
/// on; thread t has `accumulators` of them, from t * accumulators on. order: of the parts of each run; ascending if it
/// is empty or a run has more parts than `accumulators` (a thread with all accumulators in use could wait for a part
/// that no thread takes). (Dealing parts to whichever thread is free sends most of their output to the other one:
/// contacts of a bed of 100 000 gained 1.53x on two threads, in runs 1.92x.)
template <class Sources, class Find, class Finish>
void parallel_wavefront(std::size_t n, std::size_t accumulators, std::span<const std::uint32_t> order,
                        const Sources& sources, const Find& find, const Finish& finish) {
  const SharedOut meter(n > 1);
  const std::size_t threads = n < 2 ? 1 : team_size();
  if (threads == 1) {
    for (std::size_t i = 0; i < n; ++i) {
      find(i, std::size_t{0});
      finish(i, std::size_t{0}, i + 1 < n ? i + 1 : i);
    }
    return;
  }
  parallel_detail::Finds finds(n, std::min(n, threads));
  const LoopRuns runs(n, threads);
  const bool is_for_all = threads == static_cast<std::size_t>(thread_count());
  const bool in_order = is_for_all && order.size() == n && n <= accumulators * threads;
  const auto go_through = [&](std::size_t thread) {
    parallel_detail::Waiting waiting(thread * accumulators, accumulators);
    const auto part_at = [&](std::size_t place) -> std::size_t { return in_order ? order[place] : place; };
    const auto finish_one = [&](std::size_t i, std::size_t accumulator) {
      const std::size_t place = runs.next_own(thread);
      finish(i, accumulator, place < n ? part_at(place) : i);
    };
    const auto ready = [&](std::size_t i, std::size_t& seen) {
      const auto& all = sources(i);
      while (seen < all.size() && finds.has(all[seen])) ++seen;
      return seen == all.size();
    };
    const auto finish_until = [&](std::size_t most) {  // no more than these wait; false where a thread gave up
      while (waiting.finish_ready(ready, finish_one), waiting.size() > most) {
        const std::size_t seen = finds.count();  // no sooner: what others count lies in their caches
        if (!waiting.finish_ready(ready, finish_one) && !finds.wait_beyond(seen)) return false;
      }
      return true;
    };
    bool goes_on = true;
    runs.each(thread, [&](std::size_t place) {
      if (!goes_on) return;
      const std::size_t i = part_at(place);
      find(i, waiting.accumulator());
      waiting.add(i);
      finds.add(thread, i);
      goes_on = finish_until(accumulators - 1);
    });
    if (goes_on) finish_until(0);
  };
  parallel_team(
      [&](std::size_t thread) { parallel_detail::wait_together(finds.event(), [&] { go_through(thread); }); });
}

}  // namespace epafi
