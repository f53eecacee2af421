/// @file parallel_stages.h  Loops one after the other over the same things, where each thread keeps its part near.
#pragma once
#include <atomic>
#include <span>

#include "engine/parallel.h"

namespace epafi {

namespace parallel_detail {
/// Looks for some microseconds, then sleeps: beside other programs the thread that is waited for may want this core.
inline void wait_for(Counter& done, std::size_t count) {
  const std::atomic_ref value(done.value);
  int looks = 0;
  for (std::size_t now; (now = value.load(std::memory_order_acquire)) < count;)
    if (++looks > 20000) value.wait(now, std::memory_order_acquire);
}
}  // namespace parallel_detail

/// f(stage, begin, end) for pieces of [0, size(stage)), of piece(stage) >= 1 items each; none of a stage before all of
/// the one before are done. Shared out in runs (engine/parallel.h): a thread that comes late keeps nobody waiting. One
/// fork for all stages; `pays`: worth it.
template <class Size, class Piece, class F>
void parallel_stages(std::size_t stages, bool pays, const Size& size, const Piece& piece, const F& f) {
  const auto pieces = [&](std::size_t s) { return (size(s) + piece(s) - 1) / piece(s); };
  const auto threads = static_cast<std::size_t>(thread_count());
  if (!pays || threads == 1) {
    for (std::size_t s = 0; s < stages; ++s) {
      const SharedOut meter(pays && pieces(s) > 1);
      f(s, std::size_t{0}, size(s));
    }
    return;
  }
  const SharedOut meter(true);
  std::vector<Counter>& counters = block_results<Counter>(stages * (threads + 1), Counter{});
  const std::span left(counters.data(), stages * threads), done(counters.data() + stages * threads, stages);
  const auto runs = [&](std::size_t s) { return Runs(pieces(s), left.subspan(s * threads, threads)); };
  for (std::size_t s = 0; s < stages; ++s) runs(s).start();
  parallel_team([&](std::size_t thread) {
    for (std::size_t s = 0; s < stages; ++s) {
      if (s > 0) parallel_detail::wait_for(done[s - 1], pieces(s - 1));
      std::size_t mine = 0;  // counted once: each count of a piece would fetch the line from the other cores
      runs(s).each(thread, [&](std::size_t i) { f(s, i * piece(s), std::min(size(s), (i + 1) * piece(s))), ++mine; });
      const std::atomic_ref finished(done[s].value);
      if (mine > 0 && finished.fetch_add(mine, std::memory_order_release) + mine == pieces(s)) finished.notify_all();
    }
  });
}

}  // namespace epafi
