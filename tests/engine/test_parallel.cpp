#include "engine/threads/parallel_stages.h"
#include "engine/threads/parallel_wavefront.h"

#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <thread>

#include "engine/step/report.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"

using namespace epafi;

namespace {
const auto counts = {1, 2, 3, 4, 7, 8};
}  // namespace

TEST_CASE("every index is visited once, for every length and thread count", "[engine][parallel]") {
  const support::KeepThreads keep;
  for (int threads : counts) {
    set_thread_count(threads);
    for (std::size_t n : {0u, 1u, 2u, 511u, 512u, 1023u, 1024u, 1025u, 5000u}) {
      std::vector<int> visits(n, 0);
      parallel_for(n, [&](std::size_t i) { ++visits[i]; });
      CHECK(std::count(visits.begin(), visits.end(), 1) == static_cast<std::ptrdiff_t>(n));
      for (std::size_t size : {1u, 7u, 512u, 10000u}) {
        std::vector<int> covered(n, 0);
        std::vector<std::size_t> begins((n + size - 1) / size, n);
        parallel_blocks(n, size, [&](std::size_t begin, std::size_t end, std::size_t block) {
          begins[block] = begin;
          for (std::size_t i = begin; i < end; ++i) ++covered[i];
        });
        CHECK(std::count(covered.begin(), covered.end(), 1) == static_cast<std::ptrdiff_t>(n));
        for (std::size_t b = 0; b < begins.size(); ++b) CHECK(begins[b] == b * size);
      }
    }
  }
}

TEST_CASE("a run is gone through from its front, helped from its back, and from its front where nobody has come",
          "[engine][parallel]") {
  std::vector<Counter> left(3);
  const WorkRanges runs(13, left);  // pieces 0 to 3, 4 to 7 and 8 to 12
  runs.start();
  std::vector<std::size_t> seen;
  SECTION("one thread alone") {
    runs.each(1, [&](std::size_t i) { seen.push_back(i); });
    CHECK(seen == std::vector<std::size_t>{4, 5, 6, 7, 8, 9, 10, 11, 12, 0, 1, 2, 3});
  }
  SECTION("another comes when the first is at its second piece") {
    runs.each(2, [&](std::size_t i) {
      seen.push_back(i);
      if (i == 9) runs.each(1, [&](std::size_t k) { seen.push_back(k); });
    });
    CHECK(seen == std::vector<std::size_t>{8, 9, 4, 5, 6, 7, 12, 11, 10, 0, 1, 2, 3});
  }
  SECTION("the owner comes when others have begun") {
    runs.each(1, [&](std::size_t i) {
      seen.push_back(i);
      if (i == 8) runs.each(2, [&](std::size_t k) { seen.push_back(k); });
    });
    CHECK(seen == std::vector<std::size_t>{4, 5, 6, 7, 8, 9, 10, 11, 12, 0, 1, 2, 3});
  }
}

TEST_CASE("a team goes through loops, those inside others too, and sleeps while there is nothing to do",
          "[engine][parallel][threads]") {
  const support::KeepThreads keep;
  for (int threads : counts) {
    set_thread_count(threads);
    std::vector<int> visits(5000, 0), members(static_cast<std::size_t>(threads), 0), inner(64, 0);
    with_team([&] {
      for (int k = 0; k < 200; ++k) {
        parallel_for(visits.size(), [&](std::size_t i) { ++visits[i]; });
        parallel_team([&](std::size_t thread) { ++members[thread]; });
        if (k % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
      parallel_blocks(8, 1, [&](std::size_t b, std::size_t, std::size_t) {
        parallel_blocks(8, 1, [&](std::size_t i, std::size_t, std::size_t) { ++inner[8 * b + i]; });
      });
      with_team([&] { parallel_for(visits.size(), [&](std::size_t i) { ++visits[i]; }); });
    });
    CHECK(ThreadTeam::idle() == nullptr);
    CHECK(std::ranges::count(visits, 201) == std::ssize(visits));
    CHECK(members[0] == 200);
    CHECK(std::ranges::all_of(members, [](int loops) { return loops <= 200; }));  // who comes late is left out
    CHECK(std::ranges::count(inner, 1) == std::ssize(inner));
  }
}

TEST_CASE("a thread that others wait for rests, longer where its returns end the same way", "[engine][parallel]") {
  Preemptions thread;
  for (int k = 0; k < 200; ++k) {
    thread.count(0.02 * k, k % 20 == 0 ? 5e-3 : 1e-3);  // fifty a second, most of them short: a quiet machine
    CHECK_FALSE(thread.rests(0.02 * k + 0.01));
  }
  double time = 5.0;
  std::vector<double> rests;
  for (int round = 0; round < 7; ++round) {
    for (int k = 0; k < 3; ++k) thread.count(time += 0.004, 0.004);
    CHECK(thread.rests(time + 0.05));
    double rest = 0.0;
    while (thread.rests(time + rest)) rest += 0.01;
    rests.push_back(rest);
    time += rest;
  }
  CHECK(rests.front() == Approx(0.1).margin(0.011));
  CHECK(std::ranges::is_sorted(rests));
  CHECK(rests.back() == Approx(2.0).margin(0.011));
  time += 60.0;  // a quiet minute: forgiven
  for (int k = 0; k < 3; ++k) thread.count(time += 0.004, 0.004);
  CHECK_FALSE(thread.rests(time + 0.12));
}

TEST_CASE("what a thread of a team throws reaches whoever began the loop, and what its body throws whoever began it",
          "[engine][parallel][threads]") {
  const support::KeepThreads keep;
  set_thread_count(3);
  for (const std::size_t thrower : {0u, 2u}) {
    std::array<int, 3> through{};
    int caught = 0;
    const auto meet = [](std::atomic<int>& arrived) {  // nobody is left out
      for (++arrived; arrived < 3;) std::this_thread::yield();
    };
    std::atomic<int> first{0}, second{0};
    with_team([&] {
      try {
        parallel_team([&](std::size_t thread) {
          meet(first);
          if (thread == thrower) throw std::runtime_error("of a thread");
          ++through[thread];
        });
      } catch (const std::runtime_error&) {
        ++caught;
      }
      parallel_team([&](std::size_t thread) {
        meet(second);
        ++through[thread];
      });
    });
    CHECK(caught == 1);
    CHECK(std::accumulate(through.begin(), through.end(), 0) == 5);
  }
  CHECK_THROWS_WITH(with_team([] { throw std::runtime_error("of the body"); }), "of the body");
}

TEST_CASE("threads that wait for one that throws are let go", "[engine][parallel][threads]") {
  const support::KeepThreads keep;
  const std::vector<std::vector<std::size_t>> sources{{}, {0}, {0, 1}, {2}, {0}, {4}, {3, 5}, {6}};
  for (int threads : {2, 3, 8})
    for (std::size_t trays : {1u, 8u})
      for (std::size_t thrower = 0; thrower < sources.size(); ++thrower) {
        set_thread_count(threads);
        const auto throw_late = [&](std::size_t i) {
          if (i != thrower) return;
          std::this_thread::sleep_for(std::chrono::milliseconds(2));  // the others look, and sleep
          throw std::runtime_error("of a part");
        };
        const auto wavefront = [&] {
          parallel_wavefront(
              sources.size(), trays, {}, [&](std::size_t i) -> const auto& { return sources[i]; },
              [&](std::size_t i, std::size_t) { throw_late(i); }, [](std::size_t, std::size_t, std::size_t) {});
        };
        std::atomic<int> after{0};
        const auto stages = [&] {
          parallel_stages(
              3, true, [](std::size_t) { return std::size_t{8}; }, [](std::size_t) { return std::size_t{1}; },
              [&](std::size_t stage, std::size_t i, std::size_t) {
                if (stage == 1) throw_late(i);
                if (stage == 2) ++after;
              });
        };
        CHECK_THROWS_WITH(with_team(wavefront), "of a part");
        CHECK_THROWS_WITH(with_team(stages), "of a part");
        CHECK(after == 0);
      }
}

TEST_CASE("a wavefront finishes each part once, by its finder and after all its sources",
          "[engine][parallel][threads]") {
  const support::KeepThreads keep;
  for (int threads : counts) {
    set_thread_count(threads);
    for (std::size_t trays : {1u, 2u, 40u, 501u})
      for (std::size_t n : {0u, 1u, 2u, 3u, 64u, 500u}) {
        std::vector<int> found(n, 0), finished(n, 0), early(n, 0);
        std::vector<std::size_t> finder(n), finisher(n), tray_of(n), tray_then(n), next_of(n);
        std::vector<std::vector<std::size_t>> sources(n);
        for (std::size_t i = 0; i < n; ++i)
          for (std::size_t back : {200u, 40u, 7u, 1u})
            if (i >= back && (i + back) % 3 != 0) sources[i].push_back(i - back);
        std::vector<int> busy(trays * static_cast<std::size_t>(threads), 0), taken(n, 0);
        const auto sources_of = [&](std::size_t i) -> const auto& { return sources[i]; };
        std::vector<std::uint32_t> order;
        if (trays > n) order_wavefront(n, static_cast<std::size_t>(threads), sources_of, order);
        parallel_wavefront(
            n, trays, order, sources_of,
            [&](std::size_t i, std::size_t tray) {
              double work = 1.0;  // uneven, so that threads overtake each other
              for (std::size_t k = 0; k < 2000 * (i % 5); ++k) work = std::sqrt(work + 1.0);
              taken[i] = std::exchange(busy[tray], 1);
              tray_of[i] = tray;
              finder[i] = thread_number();
              found[i] = work > 0.0;
            },
            [&](std::size_t i, std::size_t tray, std::size_t next) {
              next_of[i] = next;
              for (std::size_t k : sources[i]) early[i] += found[k] != 1;
              busy[tray] = 0;
              tray_then[i] = tray;
              finisher[i] = thread_number();
              ++finished[i];
            });
        CHECK(std::count(finished.begin(), finished.end(), 1) == static_cast<std::ptrdiff_t>(n));
        CHECK(std::count(early.begin(), early.end(), 0) == static_cast<std::ptrdiff_t>(n));
        CHECK(std::count(taken.begin(), taken.end(), 0) == static_cast<std::ptrdiff_t>(n));
        CHECK(finder == finisher);
        CHECK(tray_of == tray_then);
        const std::size_t runs = std::min(n, static_cast<std::size_t>(threads));
        for (std::size_t i = 0; i < n; ++i) {
          const std::size_t run = finisher[i] % runs, begin = n * run / runs, end = n * (run + 1) / runs;
          INFO("threads " << threads << ", " << n << " parts, of " << i << " next " << next_of[i]);
          CHECK((next_of[i] == i || (next_of[i] >= begin && next_of[i] < end)));
          if (threads == 1) CHECK(next_of[i] == std::min(i + 1, n - 1));
        }
      }
  }
}

TEST_CASE("a stage begins when the one before is done, and none of its pieces is left out",
          "[engine][parallel][threads]") {
  const support::KeepThreads keep;
  const std::vector<std::size_t> sizes{100, 7, 0, 1000, 1, 64};
  for (int threads : counts) {
    set_thread_count(threads);
    for (const bool pays : {false, true}) {
      std::vector<std::vector<int>> visits;
      for (std::size_t n : sizes) visits.emplace_back(n, 0);
      std::vector<int> early(1000, 0);
      parallel_stages(
          sizes.size(), pays, [&](std::size_t s) { return sizes[s]; },
          [](std::size_t s) { return s == 3 ? std::size_t{1000} : std::size_t{16}; },
          [&](std::size_t s, std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
              ++visits[s][i];
              for (std::size_t k = 0; s > 0 && k < sizes[s - 1]; ++k) early[i] += visits[s - 1][k] != 1;
            }
          });
      for (const auto& stage : visits) CHECK(std::count(stage.begin(), stage.end(), 1) == std::ssize(stage));
      CHECK(std::count(early.begin(), early.end(), 0) == std::ssize(early));
    }
  }
}

TEST_CASE("sums and maxima are the same bits for every thread count", "[engine][parallel][threads]") {
  const support::KeepThreads keep;
  Random random(1, 1);
  std::vector<double> x(100001);
  for (double& v : x) v = std::exp(random.uniform(-30, 30)) * (random.uniform() < 0.5 ? -1 : 1);
  std::uint64_t sum = 0, most = 0, third = 0;
  for (int threads : counts) {
    set_thread_count(threads);
    const double s = block_sum<double>(x.size(), [&](std::size_t i) { return x[i]; });
    const double m = block_max<double>(x.size(), 0.0, [&](std::size_t i) { return x[i]; });
    const Sum3 t = block_sum<Sum3>(x.size(), [&](std::size_t i) { return Sum3{1.0, x[i], x[i] * x[i]}; });
    CHECK(t.a == 100001.0);
    CHECK(t.b == s);
    CHECK(m == *std::max_element(x.begin(), x.end()));
    if (threads == 1) {
      sum = std::bit_cast<std::uint64_t>(s);
      most = std::bit_cast<std::uint64_t>(m);
      third = std::bit_cast<std::uint64_t>(t.c);
    }
    CHECK(std::bit_cast<std::uint64_t>(s) == sum);
    CHECK(std::bit_cast<std::uint64_t>(m) == most);
    CHECK(std::bit_cast<std::uint64_t>(t.c) == third);
  }
}

TEST_CASE("a sum is exact where its terms are integers, a maximum starts from its least", "[engine][parallel]") {
  const double n = 5000;
  CHECK(block_sum<double>(5000, [](std::size_t i) { return static_cast<double>(i); }) == n * (n - 1) / 2);
  CHECK(block_sum<double>(0, [](std::size_t) { return 1.0; }) == 0.0);
  CHECK(block_max<double>(0, -3.0, [](std::size_t) { return 1.0; }) == -3.0);
  CHECK(block_max<double>(3000, 7.0, [](std::size_t) { return 1.0; }) == 7.0);
  // one sum inside the terms of another of a different type
  const double nested = block_sum<double>(10, [](std::size_t) {
    return static_cast<double>(block_sum<std::size_t>(3000, [](std::size_t i) { return i % 2; }));
  });
  CHECK(nested == 15000.0);
}

TEST_CASE("the serial part of a stage is what lies outside loops worth sharing out", "[engine][parallel]") {
  const support::KeepThreads keep;
  using namespace std::chrono_literals;
  const auto sleep = [](auto...) { std::this_thread::sleep_for(10ms); };
  for (int threads : {1, 2}) {
    set_thread_count(threads);
    StageSeconds seconds;
    StageTimer timer(seconds);
    sleep();
    timer.lap(Stage::integrate);
    parallel_blocks(4, 2, sleep);
    parallel_blocks(2, 1, [&](auto...) { parallel_blocks(2, 1, sleep); });  // counts once
    timer.lap(Stage::contact);
    parallel_blocks(1, 1, sleep);  // one block: nothing to share
    sleep();
    parallel_for(2, sleep, 1);
    timer.lap(Stage::output);
    const auto serial = [&](Stage s) { return seconds.serial[static_cast<std::size_t>(s)]; };
    const double shared = threads == 1 ? 0.020 : 0.010;
    CHECK(serial(Stage::integrate) == seconds[Stage::integrate]);
    CHECK((serial(Stage::contact) >= 0 && serial(Stage::contact) <= seconds[Stage::contact] - 3 * shared));
    CHECK((serial(Stage::output) >= 0.020 && serial(Stage::output) <= seconds[Stage::output] - shared));
  }
}
