#include "scenes/study/machine_speedup.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <limits>
#include <numeric>
#include <system_error>
#include <thread>
#include <vector>

#include "engine/threads/all_places.h"
#include "engine/threads/parallel.h"

namespace epafi {
namespace {

template <class F>
double seconds(const F& f) {
  const auto begin = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// 64 pieces of work of some 0.3 ms, 24 independent chains in each: enough to keep the units of one core busy from one
/// thread.
void arithmetic(std::vector<double>& out) {
  parallel_blocks(out.size(), 1, [&](std::size_t i, std::size_t, std::size_t) {
    std::array<double, 24> x;
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = static_cast<double>(i + k + 1);
    for (int step = 0; step < 50000; ++step)
      for (double& value : x) value = 0.999999 * value + 1e-6;
    out[i] = std::accumulate(x.begin(), x.end(), 0.0);
  });
}

struct Triad {
  std::vector<double> a = std::vector<double>(std::size_t{8} << 20), b = a, c = a;
  void run() {
    parallel_for(a.size(), [&](std::size_t i) { a[i] = b[i] + 3.0 * c[i]; });
  }
};

double round_trip() try {
  constexpr int trips = 20000;
  const AllPlaces places;  // of the other thread
  alignas(64) std::atomic<int> word{0};
  const auto wait_for = [&word](int value) {
    for (int spins = 0; word.load(std::memory_order_acquire) != value; ++spins)
      if (spins > 10000) {  // both on one processor
        std::this_thread::yield();
        spins = 0;
      }
  };
  double best = std::numeric_limits<double>::infinity();
  for (int repeat = 0; repeat < 2; ++repeat) {
    word = 0;
    std::thread other([&] {
      for (int k = 0; k < trips; ++k) {
        wait_for(2 * k + 1);
        word.store(2 * k + 2, std::memory_order_release);
      }
    });
    const auto there_and_back = [&](int k) {
      word.store(2 * k + 1, std::memory_order_release);
      wait_for(2 * k + 2);
    };
    there_and_back(0);  // it has started then
    best = std::min(best, seconds([&] {
                      for (int k = 1; k < trips; ++k) there_and_back(k);
                    }));
    other.join();
  }
  return best / (trips - 1);
} catch (const std::system_error&) {
  return std::numeric_limits<double>::infinity();
}

}  // namespace

MachineSpeedup machine_speedup(int threads) {
  const int before = thread_count();
  std::vector<double> out(64);
  Triad triad;
  constexpr double never = std::numeric_limits<double>::infinity();
  std::array<double, 2> work{never, never}, way{never, never};
  for (int repeat = 0; repeat < 2; ++repeat)
    for (const std::size_t k : {0u, 1u}) {
      set_thread_count(k == 0 ? 1 : threads);
      work[k] = std::min(work[k], seconds([&] { arithmetic(out); }));
      way[k] = std::min(way[k], seconds([&] { triad.run(); }));
    }
  set_thread_count(before);
  return {work[0] / work[1], way[0] / way[1], round_trip()};
}

}  // namespace epafi
