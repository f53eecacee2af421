/// @file parallel_wavefront.h  Parts that leave something to later ones and are finished while they are near.
#pragma once
#include <cstdint>
#include <numeric>
#include <span>

#include "engine/parallel_stages.h"

namespace epafi {

namespace parallel_detail {
/// Parts that one thread has found and not finished, each with its tray.
class Waiting {
 public:
  Waiting(std::size_t first, std::size_t trays) : free_(kept_free()), parts_(kept_parts()) {
    free_.resize(trays), parts_.clear();
    std::iota(free_.rbegin(), free_.rend(), first);  // the lowest first: those it had in the last call
  }
  std::size_t size() const { return parts_.size(); }
  std::size_t tray() const { return free_.back(); }
  void add(std::size_t part) { parts_.push_back({part, tray()}), free_.pop_back(); }

  /// finish(part, tray) for those that are ready(part); whether there were any.
  template <class Ready, class Finish>
  bool finish_ready(const Ready& ready, const Finish& finish) {
    const std::size_t before = size();
    std::erase_if(parts_, [&](const Part& p) {
      if (!ready(p.part)) return false;
      finish(p.part, p.tray), free_.push_back(p.tray);
      return true;
    });
    return size() < before;
  }

 private:
  struct Part {
    std::size_t part, tray;
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
}  // namespace parallel_detail

/// The order in which the parts of each run are best found by so many threads: first those that parts of other runs wait
/// for, last those that wait for parts of other runs. sources: as below.
template <class Sources>
void order_wavefront(std::size_t n, std::size_t threads, const Sources& sources, std::vector<std::uint32_t>& order) {
  enum : unsigned char { waited_for, neither, waits };
  std::vector<unsigned char> rank(n, neither);
  order.resize(n), std::iota(order.begin(), order.end(), 0u);
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
    std::ranges::stable_sort(std::span(order).subspan(begin, end - begin), {}, [&](std::uint32_t i) { return rank[i]; });
  });
}

/// find(i, tray) for i in [0, n), and finish(i, tray) by the same thread once find(k) is done for all k in sources(i),
/// which are below i. Shared out in runs; a part whose sources are not found yet keeps its tray while the thread goes
/// on: it has `trays` of them, those of thread t from t * trays on. order: of the parts of each run; ascending where it
/// is empty, or a run has more parts than `trays` (a thread with all of them in use would wait for what nobody takes).
/// (Parts in turns, to whoever comes first, send most of what they leave to the other thread: contacts of a bed of
/// 100 000 had 1.53x of two threads, in runs 1.92x.)
template <class Sources, class Find, class Finish>
void parallel_wavefront(std::size_t n, std::size_t trays, std::span<const std::uint32_t> order, const Sources& sources,
                        const Find& find, const Finish& finish) {
  const SharedOut meter(n > 1);
  if (n < 2 || thread_count() == 1) {
    for (std::size_t i = 0; i < n; ++i) find(i, std::size_t{0}), finish(i, std::size_t{0});
    return;
  }
  std::vector<unsigned char>& found = block_results<unsigned char>(n, 0);
  Counter finds{};
  const LoopRuns runs(n);
  const bool in_order = order.size() == n && n <= trays * static_cast<std::size_t>(thread_count());
  parallel_team([&](std::size_t thread) {
    const std::atomic_ref all(finds.value);
    parallel_detail::Waiting waiting(thread * trays, trays);
    const auto ready = [&](std::size_t i) {
      const auto is_found = [&](std::size_t k) {
        return std::atomic_ref(found[k]).load(std::memory_order_acquire) != 0;
      };
      return std::ranges::all_of(sources(i), is_found);
    };
    const auto finish_until = [&](std::size_t most) {  // no more than these wait
      for (;;) {
        const std::size_t seen = all.load(std::memory_order_acquire);
        const bool some = waiting.finish_ready(ready, finish);
        if (waiting.size() <= most) return;
        if (!some) parallel_detail::wait_for(finds, seen + 1);
      }
    };
    runs.each(thread, [&](std::size_t place) {
      const std::size_t i = in_order ? order[place] : place;
      find(i, waiting.tray()), waiting.add(i);
      std::atomic_ref(found[i]).store(1, std::memory_order_release);
      all.fetch_add(1, std::memory_order_release), all.notify_all();
      finish_until(trays - 1);
    });
    finish_until(0);
  });
}

}  // namespace epafi
