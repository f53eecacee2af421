#include "engine/threads/parallel_order.h"

#include <algorithm>
#include <numeric>

#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"

using namespace epafi;

namespace {
const auto thread_counts = {1, 2, 3, 8, 16};
const auto lengths = {0u, 1u, 2u, 4095u, 4096u, 8192u, 16385u, 70001u};
}  // namespace

TEST_CASE("running sums are those of one thread", "[engine][parallel]") {
  const support::KeepThreads keep;
  for (const int threads : thread_counts) {
    set_thread_count(threads);
    for (const std::size_t n : lengths) {
      std::vector<std::uint32_t> v(n), wanted(n);
      for (std::size_t i = 0; i < n; ++i) v[i] = static_cast<std::uint32_t>(i * 2654435761u % 13);
      std::partial_sum(v.begin(), v.end(), wanted.begin());
      running_sums(v);
      CHECK(v == wanted);
    }
  }
}

TEST_CASE("selecting keeps the order and takes exactly those asked for", "[engine][parallel]") {
  const support::KeepThreads keep;
  const auto is = [](std::size_t i) { return i * 2654435761u % 7 < 3; };
  for (const int threads : thread_counts) {
    set_thread_count(threads);
    for (const std::size_t n : lengths) {
      std::vector<std::uint64_t> wanted, found(5, 99);
      for (std::size_t i = 0; i < n; ++i)
        if (is(i)) wanted.push_back(3 * i);
      parallel_select(
          n, is, [](std::size_t i) { return std::uint64_t{3 * i}; }, found);
      CHECK(found == wanted);
    }
  }
}

TEST_CASE("grouping by key is a stable sort, for every number of threads", "[engine][parallel]") {
  const support::KeepThreads keep;
  struct Item {
    std::uint32_t key, value;
    bool operator==(const Item&) const = default;
  };
  for (const int threads : thread_counts) {
    set_thread_count(threads);
    for (const std::size_t n : lengths)
      for (const std::size_t keys : {1u, 7u, 5000u}) {
        std::vector<Item> items(n), sorted, grouped;
        for (std::size_t i = 0; i < n; ++i)
          items[i] = {static_cast<std::uint32_t>(i * 2654435761u % keys), static_cast<std::uint32_t>(i)};
        sorted = items;
        std::stable_sort(sorted.begin(), sorted.end(), [](const Item& a, const Item& b) { return a.key < b.key; });
        std::vector<std::uint32_t> begin;
        const auto each = [&](std::size_t from, std::size_t to, const auto& f) {
          for (std::size_t i = from; i < to; ++i) f(items[i].key, items[i]);
        };
        parallel_group(
            n, keys, begin, each, [&](std::size_t count) { grouped.resize(count); },
            [&](std::uint32_t place, const Item& item) { grouped[place] = item; }, 16);
        CHECK(grouped == sorted);
        std::size_t wrong = 0;
        for (std::size_t k = 0; k < keys; ++k) {
          for (std::uint32_t p = begin[k]; p < begin[k + 1]; ++p) wrong += grouped[p].key != k;
          wrong += begin[k] > begin[k + 1];
        }
        CHECK((wrong == 0 && begin[0] == 0 && begin[keys] == n));
      }
  }
}
