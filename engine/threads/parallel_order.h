/// @file parallel_order.h  Parallel selection, prefix sum and grouping with the results of one thread.
#pragma once
#include <numeric>
#include <span>
#include <utility>

#include "engine/state/large_column.h"
#include "engine/threads/parallel.h"

namespace epafi {

/// Least number of elements for several threads: 16 kB of them.
template <class Column>
inline constexpr std::size_t fill_grain = std::max<std::size_t>(64, 16384 / sizeof(typename Column::value_type));

/// Sets the size; every element must be written before it is read, since a column that grows does not copy the old
/// ones. It reserves a quarter more, which takes no memory before it is written.
template <class T>
void renew(std::vector<T>& column, std::size_t size) {
  if (size > column.capacity()) {
    column.clear();
    column.reserve(size + size / 4);
  }
  column.resize(size);
}

/// column[0 .. n) = value.
template <class Column>
void parallel_fill(Column& column, std::size_t n, const typename Column::value_type& value) {
  renew(column, n);
  parallel_for(
      n, [&](std::size_t i) { column[i] = value; }, fill_grain<Column>);
}

template <class From, class To>
void parallel_copy(const From& from, To& to) {
  if constexpr (requires { renew(to, from.size()); })
    renew(to, from.size());
  else
    to.resize(from.size());
  parallel_for(
      from.size(), [&](std::size_t i) { to[i] = from[i]; }, fill_grain<To>);
}

/// v[k] becomes v[0] + ... + v[k].
inline void running_sums(std::span<std::uint32_t> v) {
  constexpr std::size_t size = 16384;
  const std::size_t blocks = (v.size() + size - 1) / size;
  const SharedOut meter(blocks > 1);
  if (blocks < 2 || thread_count() == 1) {
    std::partial_sum(v.begin(), v.end(), v.begin());
    return;
  }
  std::vector<std::uint32_t>& before = block_results<std::uint32_t>(blocks, 0);
  parallel_blocks(v.size(), size, [&](std::size_t begin, std::size_t end, std::size_t b) {
    before[b] = std::accumulate(v.begin() + static_cast<std::ptrdiff_t>(begin),
                                v.begin() + static_cast<std::ptrdiff_t>(end), std::uint32_t{0});
  });
  std::exclusive_scan(before.begin(), before.end(), before.begin(), std::uint32_t{0});
  parallel_blocks(v.size(), size, [&](std::size_t begin, std::size_t end, std::size_t b) {
    std::uint32_t sum = before[b];
    for (std::size_t k = begin; k < end; ++k) v[k] = sum += v[k];
  });
}

/// make(i) of all i in [0, n) with is(i), ascending; is(i) is called twice.
template <class Is, class Make, class Column>
void parallel_select(std::size_t n, const Is& is, const Make& make, Column& out) {
  constexpr std::size_t size = 4096;
  std::vector<std::size_t>& place = block_results<std::size_t>((n + size - 1) / size, 0);
  parallel_blocks(n, size, [&](std::size_t begin, std::size_t end, std::size_t b) {
    for (std::size_t i = begin; i < end; ++i) place[b] += static_cast<std::size_t>(is(i));
  });
  std::size_t total = 0;
  for (std::size_t& p : place) total += std::exchange(p, total);
  out.resize(total);
  parallel_blocks(n, size, [&](std::size_t begin, std::size_t end, std::size_t b) {
    std::size_t at = place[b];
    for (std::size_t i = begin; i < end; ++i)
      if (is(i)) out[at++] = make(i);
  });
}

/// Counting sort. each(begin, end, f) calls f(key, value) for what items [begin, end) hold, the same every time;
/// `begin` gets where the values of each key begin, one entry more than keys at least; room(count) makes room for all,
/// put(place, value) writes them, those of a key in the order of the items. Every thread counts for itself (4 bytes a
/// key), eight at most, `grain` items at least.
template <class Begin, class Each, class Room, class Put>
void parallel_group(std::size_t n, std::size_t keys, Begin& begin, const Each& each, const Room& room, const Put& put,
                    std::size_t grain = 4096) {
  const std::size_t parts = std::min({static_cast<std::size_t>(thread_count()), std::size_t{8}, n / grain});
  const SharedOut meter(n >= 2 * grain);
  parallel_fill(begin, keys + 2, 0);
  if (parts < 2) {
    each(std::size_t{0}, n, [&](std::size_t key, const auto&) { ++begin[key + 2]; });
    running_sums(begin);
    room(begin.back());
    each(std::size_t{0}, n, [&](std::size_t key, const auto& value) { put(begin[key + 1]++, value); });
    return;
  }
  thread_local std::vector<std::uint32_t> kept;
  std::vector<std::uint32_t>& count = kept;  // of the caller
  parallel_fill(count, parts * keys, 0);
  const auto over_parts = [&](const auto& f) {
    parallel_blocks(parts, 1, [&](std::size_t p, std::size_t, std::size_t) {
      each(n * p / parts, n * (p + 1) / parts,
           [&, mine = count.data() + p * keys](std::size_t key, const auto& value) { f(mine[key], value); });
    });
  };
  over_parts([](std::uint32_t& c, const auto&) { ++c; });
  parallel_for(keys, [&](std::size_t k) {
    for (std::size_t p = 0; p < parts; ++p) begin[k + 1] += count[p * keys + k];
  });
  begin[keys + 1] = 0;
  running_sums(begin);
  parallel_for(keys, [&](std::size_t k) {
    std::uint32_t at = begin[k];
    for (std::size_t p = 0; p < parts; ++p) at += std::exchange(count[p * keys + k], at);
  });
  room(begin.back());
  over_parts([&](std::uint32_t& c, const auto& value) { put(c++, value); });
}

}  // namespace epafi
