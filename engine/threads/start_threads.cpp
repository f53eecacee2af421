#include "engine/threads/start_threads.h"

#include <atomic>
#include <system_error>
#include <thread>
#include <vector>

#include "engine/threads/parallel.h"

namespace epafi {

bool start_threads() {
  const int wanted = thread_count() - 1;
  std::atomic<bool> go{false};
  std::vector<std::thread> tried;
  try {
    for (int k = 0; k < wanted; ++k) tried.emplace_back([&go] { go.wait(false); });
  } catch (const std::system_error&) {
  }
  const bool enough = static_cast<int>(tried.size()) == wanted;
  go = true;
  go.notify_all();
  for (auto& thread : tried) thread.join();
  if (enough) parallel_blocks(static_cast<std::size_t>(wanted) + 1, 1, [](std::size_t, std::size_t, std::size_t) {});
  return enough;
}

}  // namespace epafi
