/// @file parallel_stages.h  Successive loops over the same items, in which each thread keeps its part in cache.
#pragma once
#include <atomic>
#include <span>

#include "engine/threads/parallel.h"

namespace epafi {

namespace parallel_detail {
/// Polls of a thread that waits for another one's piece, before it sleeps: tens of microseconds. On a loaded machine
/// the awaited thread may need this core.
inline constexpr int polls_for_piece = 800;

/// Runs part() on one of several threads that wait for each other; if it throws, the others stop waiting.
template <class F>
void wait_together(EventCount& event, const F& part) {
  try {
    part();
  } catch (...) {
    event.give_up();
    throw;
  }
}
}  // namespace parallel_detail

/// Calls f(stage, begin, end) for pieces of [0, size(stage)), of piece(stage) >= 1 items each. A stage begins when the
/// one before is complete. Pieces are shared out in runs (engine/threads/parallel.h), so a late thread delays no other.
/// One fork serves all stages. pays: whether a fork is worth its cost.
template <class Size, class Piece, class F>
void parallel_stages(std::size_t stages, bool pays, const Size& size, const Piece& piece, const F& f) {
  const auto pieces = [&](std::size_t s) { return (size(s) + piece(s) - 1) / piece(s); };
  const std::size_t threads = pays ? team_size() : 1;
  if (threads == 1) {
    for (std::size_t s = 0; s < stages; ++s) {
      const SharedOut meter(pays && pieces(s) > 1);
      f(s, std::size_t{0}, size(s));
    }
    return;
  }
  const SharedOut meter(true);
  std::vector<Counter>& counters = block_results<Counter>(stages * (threads + 1), Counter{});
  const std::span left(counters.data(), stages * threads), done(counters.data() + stages * threads, stages);
  const auto runs = [&](std::size_t s) { return WorkRanges(pieces(s), left.subspan(s * threads, threads)); };
  for (std::size_t s = 0; s < stages; ++s) runs(s).start();
  EventCount event;
  const auto all_done = [&](std::size_t s) { return std::atomic_ref(done[s].value).load() == pieces(s); };
  const auto go_through = [&](std::size_t thread) {
    for (std::size_t s = 0; s < stages; ++s) {
      if (s > 0 && !event.wait_until([&] { return all_done(s - 1); }, parallel_detail::polls_for_piece)) return;
      std::size_t mine = 0;  // counted once: each count of a piece would fetch the line from the other cores
      runs(s).each(thread, [&](std::size_t i) {
        f(s, i * piece(s), std::min(size(s), (i + 1) * piece(s)));
        ++mine;
      });
      if (mine > 0 && std::atomic_ref(done[s].value).fetch_add(mine) + mine == pieces(s)) event.wake();
    }
  };
  parallel_team([&](std::size_t thread) { parallel_detail::wait_together(event, [&] { go_through(thread); }); });
}

}  // namespace epafi
