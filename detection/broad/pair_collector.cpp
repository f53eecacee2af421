#include "detection/broad/pair_collector.h"

#include <algorithm>

#include "engine/parallel_order.h"

namespace epafi {

namespace {
/// Runs are a handful of entries, mostly sorted.
void sort_run(Slot* first, Slot* last) {
  if (last - first < 2) return;  // of none, first may be null
  if (last - first > 32) {
    if (!std::is_sorted(first, last)) std::sort(first, last);
    return;
  }
  for (Slot* p = first + 1; p < last; ++p) {
    const Slot v = *p;
    Slot* q = p;
    for (; q > first && *(q - 1) > v; --q) *q = *(q - 1);
    *q = v;
  }
}
}  // namespace

void PairCollector::begin(std::size_t blocks) {
  if (blocks_.size() < blocks + 1) blocks_.resize(blocks + 1);
  for (Block& b : blocks_) b.own.clear(), b.rest.clear();
  parallel_fill(run_, bodies_.size(), Run{});
  // pairs of two apart bodies, in a block of their own
  const auto& apart = bodies_.apart;
  for (std::size_t k = 0; k < apart.size(); ++k)
    for (std::size_t l = k + 1; l < apart.size(); ++l) {
      const Slot i = apart[k], j = apart[l];
      if (!bodies_.may_touch(i, j, filter_) || !bodies_.near(i, j)) continue;
      bodies_.id[i] < bodies_.id[j] ? blocks_.back().rest.push_back({i, j}) : blocks_.back().rest.push_back({j, i});
    }
}

void PairCollector::place(Block& block, Slot i, Slot j) {
  if (bodies_.id[i] < bodies_.id[j])
    block.own.push_back(j);
  else
    block.rest.push_back({j, i});
}

void PairCollector::add_apart(Block& block, Slot i) {
  for (std::size_t k = 0; k < bodies_.apart.size(); ++k) {
    const Slot w = bodies_.apart[k];
    if (!bodies_.may_touch(i, w, filter_)) continue;
    const bool plane = bodies_.plane_normal[k].squaredNorm() > 0.0;
    if (plane ? bodies_.near_plane(i, k) : bodies_.near(i, w)) place(block, i, w);
  }
}

void PairCollector::add(std::size_t block, Slot i, std::span<const Slot> candidates) {
  Block& mine = blocks_[block];
  const std::size_t begin = mine.own.size();
  for (Slot j : candidates)
    if (bodies_.near(i, j) && bodies_.may_touch(i, j, filter_)) place(mine, i, j);
  add_apart(mine, i);
  sort_run(mine.own.data() + begin, mine.own.data() + mine.own.size());
  run_[i] = {static_cast<std::uint32_t>(block), static_cast<std::uint32_t>(begin),
             static_cast<std::uint32_t>(mine.own.size() - begin)};
}

void PairCollector::group_rest() {
  const std::size_t n = bodies_.size();
  const auto each = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t b = begin; b < end; ++b)
      for (const Pair& p : blocks_[b].rest) f(p.a, p.b);
  };
  parallel_group(
      blocks_.size(), n, rest_begin_, each, [&](std::size_t count) { rest_.resize(count); },
      [&](std::uint32_t place, Slot b) { rest_[place] = b; }, 4);
  if (rest_.empty()) return;
  parallel_for(n, [&](std::size_t s) { sort_run(rest_.data() + rest_begin_[s], rest_.data() + rest_begin_[s + 1]); });
}

void PairCollector::finish(PairColumn& pairs) {
  group_rest();
  const std::size_t n = bodies_.size();
  begin_.resize(n + 1);
  parallel_for(n, [&](std::size_t s) { begin_[s + 1] = run_[s].size + (rest_begin_[s + 1] - rest_begin_[s]); });
  begin_[0] = 0, running_sums(begin_);
  const std::size_t total = begin_[n];
  renew(pairs, total);
  parallel_for(n, [&](std::size_t s) {
    const Run run = run_[s];
    const Slot* own = blocks_[run.block].own.data() + run.begin;
    const Slot* const own_end = own + run.size;
    const Slot* rest = rest_.data() + rest_begin_[s];
    const Slot* const rest_end = rest_.data() + rest_begin_[s + 1];
    Pair* out = pairs.data() + begin_[s];
    const auto a = static_cast<Slot>(s);
    while (own != own_end || rest != rest_end)
      *out++ = {a, rest == rest_end || (own != own_end && *own < *rest) ? *own++ : *rest++};
  });
}

}  // namespace epafi
