#include "detection/broad/pair_collector.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "engine/lanes/lane_bits.h"
#include "engine/threads/parallel_order.h"

namespace epafi {

namespace {
/// Sorts distinct slots by a bit set if this is faster than sorting them: a mesh with all bodies near it (10 000 of 20
/// 000: 0.7 ms by sorting). Windows of slots have their bits on the stack, so nothing is allocated.
void sort_many(Slot* first, Slot* last, std::size_t words) {
  constexpr std::size_t most_words = 4096;  // 32 kB, 262 144 slots
  std::array<std::uint64_t, most_words> is_there;
  for (std::size_t base = 0; first < last; base += most_words) {
    const std::size_t n = std::min(most_words, words - base);
    const Slot* const behind = std::partition(first, last, [&](Slot s) { return s / 64 < base + n; });
    std::fill_n(is_there.begin(), n, 0);
    for (const Slot* s = first; s < behind; ++s) is_there[*s / 64 - base] |= std::uint64_t{1} << (*s % 64);
    for (std::size_t k = 0; k < n; ++k)
      for (std::uint64_t bits = is_there[k]; bits != 0; bits &= bits - 1)
        *first++ = static_cast<Slot>(64 * (base + k) + static_cast<std::size_t>(std::countr_zero(bits)));
  }
}

/// Different slots: runs are a handful of entries, mostly sorted.
void sort_run(Slot* first, Slot* last) {
  if (last - first < 2) return;  // of none, first may be null
  if (last - first > 32) {
    if (std::is_sorted(first, last)) return;
    const std::size_t words = *std::max_element(first, last) / 64 + 1;
    return words <= 8 * static_cast<std::size_t>(last - first) ? sort_many(first, last, words) : std::sort(first, last);
  }
  for (Slot* p = first + 1; p < last; ++p) {
    const Slot v = *p;
    Slot* q = p;
    for (; q > first && *(q - 1) > v; --q) *q = *(q - 1);
    *q = v;
  }
}
}  // namespace

void PairCollector::begin(std::size_t blocks, bool in_order) {
  in_order_ = in_order;
  sort_apart();
  if (blocks_.size() < blocks + 1) blocks_.resize(blocks + 1);
  for (Block& b : blocks_) {
    b.own.clear();
    b.rest.clear();
    b.spheres.clear();
    b.begin = no_slot;
  }
  run_.clear();
  if (in_order_) parallel_fill(first_, bodies_.size() + 1, 0);
  if (bodies_.only_spheres) return;  // those apart are half-spaces that stay
  parallel_fill(run_, bodies_.size(), Run{});
  // pairs of two apart bodies, in a block of their own
  Block& last = blocks_.back();
  for (std::size_t k = 0; k < bodies_.apart.size(); ++k)
    for (std::size_t l = k + 1; l < bodies_.apart.size(); ++l) {
      const Slot i = bodies_.apart[k], j = bodies_.apart[l];
      if (!bodies_.may_touch(i, j, filter_) || !bodies_.near(i, j)) continue;
      const bool first = bodies_.is_sphere_apart(i), second = bodies_.is_sphere_apart(j);
      if (first && (second || bodies_.plane[l].place != no_slot))
        last.spheres.insert(last.spheres.end(), {i, 1, second ? j : bodies_.plane[l].place});
      else if (second && bodies_.plane[k].place != no_slot)
        last.spheres.insert(last.spheres.end(), {j, 1, bodies_.plane[k].place});
      else
        bodies_.id[i] < bodies_.id[j] ? last.rest.push_back({i, j}) : last.rest.push_back({j, i});
    }
}

void PairCollector::place(Block& block, Slot i, Slot j) const {
  if (bodies_.id[i] < bodies_.id[j])
    block.own.push_back(j);
  else
    block.rest.push_back({j, i});
}

void PairCollector::sort_apart() {
  planes_.clear();
  plane_at_.clear();
  other_.clear();
  for (std::size_t k = 0; k < bodies_.apart.size(); ++k) {
    const ApartPlane& p = bodies_.plane[k];
    if (!p.is_plane()) {
      other_.push_back(bodies_.apart[k]);
      continue;
    }
    const std::size_t l = plane_at_.size() % 8;
    plane_at_.push_back(static_cast<std::uint32_t>(k));
    if (l == 0) std::ranges::fill(planes_.emplace_back().reach, -infinity);
    EightPlanes& eight = planes_.back();
    for (int axis = 0; axis < 3; ++axis) {
      eight.normal[axis][l] = p.normal[axis];
      eight.point[axis][l] = p.point[axis];
    }
    eight.reach[l] = p.reach;
    if (p.loose) eight.loose |= 1u << l;
  }
}

namespace {
/// Which planes a ball is near.
struct PlaneSieve {
  const std::vector<EightPlanes>& planes;
  const Ball& ball;
  std::uint8_t* near;  ///< a bit for each of eight

  template <int n>
  EPAFI_LANES void run() const {
    using V = typename LanesOf<n>::Real;
    const V x = V{} + ball.x, y = V{} + ball.y, z = V{} + ball.z;
    std::uint8_t* out = near;
    for (const EightPlanes& eight : planes) {
      unsigned beyond = 0;
      for (int l = 0; l < 8; l += n) {
        const auto of = [l](const double* column) EPAFI_INLINED {
          V some;
          std::memcpy(&some, column + l, sizeof some);
          return some;
        };
        const V height = of(eight.normal[0]) * (x - of(eight.point[0])) +
                         of(eight.normal[1]) * (y - of(eight.point[1])) +
                         of(eight.normal[2]) * (z - of(eight.point[2]));
        beyond |= less_bits<n>(of(eight.reach), height - ball.r) << l;
      }
      *out++ = static_cast<std::uint8_t>(~beyond);
    }
  }
};
}  // namespace

/// Tests balls: where these are not near a plane, boxes are not either.
void PairCollector::add_planes(Block& block, Slot i) const {
  block.near_planes.resize(planes_.size());
  if (planes_.empty()) return;
  best_loop<PlaneSieve>()({planes_, bodies_.ball[i], block.near_planes.data()});
  const Vec3 centre = bodies_.position(i);
  const bool is_stray = !bodies_.around.contains({centre, centre});
  for (std::size_t g = 0; g < planes_.size(); ++g)
    for (unsigned bits = block.near_planes[g] | (is_stray ? planes_[g].loose : 0u); bits != 0; bits &= bits - 1)
      add_plane(block, i, plane_at_[8 * g + static_cast<std::size_t>(std::countr_zero(bits))]);
}

void PairCollector::add_plane(Block& block, Slot i, std::size_t k) const {
  const ApartPlane& plane = bodies_.plane[k];
  if (bodies_.is_sphere_apart(i) && plane.place != no_slot) {
    if (!bodies_.is_elsewhere(i)) block.spheres.push_back(plane.place);
    return;
  }
  if (!bodies_.may_touch(i, bodies_.apart[k], filter_)) return;
  if (bodies_.boxes.empty() || bodies_.near_plane(i, plane)) place(block, i, bodies_.apart[k]);
}

void PairCollector::add_apart(Block& block, Slot i) const {
  add_planes(block, i);
  for (const Slot w : other_) {
    if (!bodies_.may_touch(i, w, filter_) || !bodies_.near(i, w)) continue;
    if (bodies_.is_sphere_apart(i) && bodies_.is_sphere_apart(w))
      block.spheres.push_back(w);
    else
      place(block, i, w);
  }
}

/// Of bodies that are near, without a branch: half of them count.
void PairCollector::add_higher(Block& block, Slot i, std::span<const Slot> candidates) const {
  const std::size_t begin = block.spheres.size();
  block.spheres.resize(begin + candidates.size());
  Slot *const first = block.spheres.data() + begin, *out = first;
  for (Slot j : candidates) {
    *out = j;
    out += static_cast<int>(j > i);
  }
  if (bodies_.is_elsewhere(i)) out = std::remove_if(first, out, [&](Slot j) { return bodies_.elsewhere[j] != 0; });
  sort_run(first, out);
  block.spheres.resize(begin + static_cast<std::size_t>(out - first));
}

void PairCollector::add(std::size_t block, Slot i, std::span<const Slot> candidates, bool met) {
  Block& mine = blocks_[block];
  const std::size_t begin = mine.own.size(), head = mine.spheres.size();
  const bool sphere = bodies_.is_sphere_apart(i), sure = met && bodies_.boxes.empty();
  if (in_order_) {
    add_higher(mine, i, candidates);
  } else {
    if (sphere) mine.spheres.insert(mine.spheres.end(), {i, 0});
    for (Slot j : candidates) {
      if (!sure && !bodies_.near(i, j)) continue;
      if (sphere && bodies_.is_sphere_apart(j)) {
        if (!(bodies_.is_elsewhere(i) && bodies_.is_elsewhere(j))) mine.spheres.push_back(j);
      } else if (bodies_.may_touch(i, j, filter_))
        place(mine, i, j);
    }
  }
  add_apart(mine, i);
  if (in_order_) {
    mine.begin = std::min(mine.begin, i);
    first_[i + 1] = static_cast<std::uint32_t>(mine.spheres.size() - head);
  } else if (sphere)
    mine.spheres[head + 1] = static_cast<Slot>(mine.spheres.size() - head - 2);
  if (bodies_.only_spheres) return;
  sort_run(mine.own.data() + begin, mine.own.data() + mine.own.size());
  run_[i] = {static_cast<std::uint32_t>(block), static_cast<std::uint32_t>(begin),
             static_cast<std::uint32_t>(mine.own.size() - begin)};
}

namespace {
/// f(sphere, its partners) of what Block::spheres holds.
template <class F>
void each_sphere(const std::vector<Slot>& spheres, const F& f) {
  for (const Slot *p = spheres.data(), *last = p + spheres.size(); p != last; p += 2 + p[1])
    f(p[0], std::span(p + 2, p[1]));
}
}  // namespace

void PairCollector::finish(SpherePairs& pairs) {
  pairs.planes = bodies_.sphere_planes;
  if (in_order_) return join_in_order(pairs);
  const auto each = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t b = begin; b < end; ++b)
      each_sphere(blocks_[b].spheres, [&](Slot i, std::span<const Slot> partners) {
        for (Slot j : partners) (j & SpherePairs::plane) != 0 ? f(i, j) : f(std::min(i, j), std::max(i, j));
      });
  };
  parallel_group(
      blocks_.size(), bodies_.size(), pairs.first, each, [&](std::size_t count) { renew(pairs.partner, count); },
      [&](std::uint32_t place, Slot b) { pairs.partner[place] = b; }, 4);
  parallel_for(bodies_.size(), [&](std::size_t s) {
    sort_run(pairs.partner.data() + pairs.first[s], pairs.partner.data() + pairs.first[s + 1]);
  });
}

void PairCollector::join_in_order(SpherePairs& pairs) {
  running_sums(first_);
  parallel_copy(first_, pairs.first);
  renew(pairs.partner, pairs.first.back());
  parallel_blocks(blocks_.size(), 1, [&](std::size_t b, std::size_t, std::size_t) {
    const Block& block = blocks_[b];
    if (block.begin != no_slot) std::ranges::copy(block.spheres, pairs.partner.begin() + pairs.first[block.begin]);
  });
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
  if (bodies_.only_spheres) return pairs.clear();
  group_rest();
  const std::size_t n = bodies_.size();
  begin_.resize(n + 1);
  parallel_for(n, [&](std::size_t s) { begin_[s + 1] = run_[s].size + (rest_begin_[s + 1] - rest_begin_[s]); });
  begin_[0] = 0;
  running_sums(begin_);
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

// --- bodies that come while a list lasts

void insert_pairs(const std::vector<std::pair<Slot, Slot>>& entries, std::size_t rows, SpherePairs& list) {
  std::vector<std::uint32_t>& first = list.first;
  const std::uint32_t end = first.back();
  first.resize(rows + 1, end);
  list.partner.resize(end + entries.size());
  std::size_t more = entries.size(), row = rows;
  std::uint32_t behind = end;  // of the row, before
  while (more > 0) {
    --row;
    const std::uint32_t begin = first[row];
    first[row + 1] += static_cast<std::uint32_t>(more);
    std::uint32_t from = behind, to = first[row + 1];
    while (more > 0 && entries[more - 1].first == row) {
      const Slot partner = entries[more - 1].second;
      while (from > begin && list.partner[from - 1] > partner) list.partner[--to] = list.partner[--from];
      list.partner[--to] = partner;
      --more;
    }
    while (from > begin && more > 0) list.partner[--to] = list.partner[--from];
    behind = begin;
  }
}

void PairCollector::add_behind(std::size_t old, std::size_t balls, PairList& pairs) const {
  std::vector<std::pair<Slot, Slot>> spheres;
  const auto place = [before = static_cast<Slot>(balls)](Slot s) { return before + s; };
  const auto before = static_cast<std::ptrdiff_t>(pairs.pairs.size());
  const auto meet = [&](Slot i, Slot j, Slot plane) {
    const bool sphere = bodies_.is_sphere_apart(i);
    if (sphere && plane != no_slot)
      spheres.emplace_back(place(i), plane);
    else if (sphere && bodies_.is_sphere_apart(j))
      spheres.emplace_back(place(std::min(i, j)), place(std::max(i, j)));
    else
      pairs.pairs.push_back(bodies_.id[i] < bodies_.id[j] ? Pair{i, j} : Pair{j, i});
  };
  for (auto i = static_cast<Slot>(old); i < bodies_.size(); ++i) {
    for (Slot j : bodies_.ordinary)
      if (j < i && bodies_.near(i, j) && bodies_.may_touch(i, j, filter_)) meet(i, j, no_slot);
    for (std::size_t k = 0; k < bodies_.apart.size(); ++k) {
      const Slot w = bodies_.apart[k];
      const ApartPlane& plane = bodies_.plane[k];
      if (!bodies_.may_touch(i, w, filter_)) continue;
      if (plane.is_plane() ? bodies_.near_plane(i, plane) : bodies_.near(i, w)) meet(i, w, plane.place);
    }
  }
  std::sort(pairs.pairs.begin() + before, pairs.pairs.end());
  std::inplace_merge(pairs.pairs.begin(), pairs.pairs.begin() + before, pairs.pairs.end());
  if (pairs.spheres.first.empty()) return;
  std::ranges::sort(spheres);
  insert_pairs(spheres, balls + bodies_.size(), pairs.spheres);
}

}  // namespace epafi
