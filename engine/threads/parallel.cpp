#include "engine/threads/parallel.h"

namespace epafi {

void run_blocks(std::size_t n, std::size_t size, const BlockBody& f) {
  const std::size_t blocks = (n + size - 1) / size;
  const auto one = [&](std::size_t b) { f(b * size, std::min(n, (b + 1) * size), b); };
  const SharedOut meter(blocks > 1);
  const std::size_t threads = blocks < 2 ? 1 : team_size();
  if (threads == 1) {
    for (std::size_t b = 0; b < blocks; ++b) one(b);
    return;
  }
  const LoopRuns runs(blocks, threads);
  parallel_team([&](std::size_t thread) { runs.each(thread, one); });
}

}  // namespace epafi
