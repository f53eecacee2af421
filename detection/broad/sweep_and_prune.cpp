#include "detection/broad/sweep_and_prune.h"

#include <algorithm>
#include <cmath>

#include "engine/threads/parallel.h"

namespace epafi {

namespace {
constexpr std::size_t sweep_block = 256;
constexpr std::size_t exchanges_per_body = 32;  // beyond, the old order is no help

}  // namespace

/// Axes along which the centres are spread most and second most.
void SweepAndPrune::choose_axes(const FatBodies& bodies) {
  const auto& all = bodies.ordinary;
  const double n = static_cast<double>(std::max<std::size_t>(all.size(), 1));
  const auto mean_of = [&](auto&& f) {
    const Sum3 s = block_sum<Sum3>(all.size(), [&](std::size_t k) {
      const Vec3 v = f(bodies.position(all[k]));
      return Sum3{v.x(), v.y(), v.z()};
    });
    return Vec3(s.a / n, s.b / n, s.c / n);
  };
  const Vec3 mean = mean_of([](const Vec3& x) { return x; });
  Vec3 spread = mean_of([&](const Vec3& x) { return Vec3((x - mean).cwiseAbs()); });
  spread.maxCoeff(&axis_);
  spread[axis_] = -1.0;
  spread.maxCoeff(&across_);
}

void SweepAndPrune::sort_intervals(const FatBodies& bodies) {
  const auto before = [](const Interval& p, const Interval& q) {
    return p.min != q.min ? p.min < q.min : p.slot < q.slot;
  };
  bool known = !slots_changed() && axis_ >= 0 && interval_.size() == bodies.ordinary.size();
  if (!known) {
    choose_axes(bodies);
    interval_.resize(bodies.ordinary.size());
    for (std::size_t k = 0; k < interval_.size(); ++k) interval_[k].slot = bodies.ordinary[k];
  }
  parallel_for(interval_.size(), [&](std::size_t k) {
    Interval& i = interval_[k];
    const Aabb box = bodies.box(i.slot);
    i.min = box.min[axis_];
    i.max = box.max[axis_];
  });
  std::size_t exchanges = 0;
  for (std::size_t k = 1; known && k < interval_.size(); ++k) {
    const Interval v = interval_[k];
    std::size_t q = k;
    for (; q > 0 && before(v, interval_[q - 1]); --q) interval_[q] = interval_[q - 1];
    interval_[q] = v;
    exchanges += k - q;
    known = exchanges <= exchanges_per_body * interval_.size();
  }
  if (!known) std::sort(interval_.begin(), interval_.end(), before);
}

void SweepAndPrune::make_rows(const FatBodies& bodies) {
  const std::size_t n = interval_.size();
  const auto low = [&](std::size_t k) { return bodies.box(interval_[k].slot).min[across_]; };
  longest_ = block_max<double>(n, 0.0, [&](std::size_t k) { return interval_[k].max - interval_[k].min; });
  const double widest =
      block_max<double>(n, 0.0, [&](std::size_t k) { return bodies.box(interval_[k].slot).max[across_] - low(k); });
  const double first = -block_max<double>(n, -infinity, [&](std::size_t k) { return -low(k); });
  const double last = block_max<double>(n, -infinity, low);
  // Rows are as wide as the widest body, so near bodies are in the same or a neighbouring row. More rows than n are
  // useless.
  double width = std::max(1.000001 * widest, (last - first) / static_cast<double>(n + 1));
  // Within a row candidates begin inside the body's interval; in a neighbouring row all that may reach it count, up to
  // the longest interval: a few boulders in dust make rows slower than none (530 instead of 55 ns a body and step).
  const double mean =
      block_sum<double>(n, [&](std::size_t k) { return interval_[k].max - interval_[k].min; }) / static_cast<double>(n);
  if (!((2.0 * mean + longest_) * width < mean * (last - first))) width = 0.0;
  const auto rows = static_cast<std::size_t>(width > 0.0 ? (last - first) / width : 0.0) + 1;
  row_.resize(n);  // the next list may have more rows
  swept_.resize(n);
  row_begin_.reserve(n + 4);
  row_begin_.assign(rows + 2, 0);
  for (std::size_t k = 0; k < n; ++k) {
    row_[k] = static_cast<std::uint32_t>(width > 0.0 ? (low(k) - first) / width : 0.0);
    ++row_begin_[row_[k] + 2];
  }
  for (std::size_t r = 2; r < rows + 2; ++r) row_begin_[r] += row_begin_[r - 1];
  for (std::size_t k = 0; k < n; ++k)
    swept_[row_begin_[row_[k] + 1]++] = interval_[k];  // afterwards row r is [r, r + 1)
}

void SweepAndPrune::sweep(std::size_t begin, std::size_t end, std::size_t block, PairCollector& collector) {
  std::vector<Slot>& found = found_[block];
  const auto row_of = [&](std::size_t k) {
    return static_cast<std::size_t>(std::upper_bound(row_begin_.begin(), row_begin_.end(), k) - row_begin_.begin()) - 1;
  };
  std::size_t row_end = begin, next = 0, next_end = 0;  // of the row beside: from the first that may reach the body
  for (std::size_t k = begin; k < end; ++k) {
    const Interval& own = swept_[k];
    if (k == row_end) {
      const std::size_t row = row_of(k);
      row_end = row_begin_[row + 1];
      next_end = row + 2 < row_begin_.size() ? row_begin_[row + 2] : row_end;
      const auto at = [&](std::size_t m) { return swept_.begin() + static_cast<std::ptrdiff_t>(m); };
      const auto before = [&](const Interval& i, double x) { return i.min < x; };
      next = static_cast<std::size_t>(std::lower_bound(at(row_end), at(next_end), own.min - longest_, before) -
                                      swept_.begin());
    }
    found.clear();
    const auto take = [&](std::size_t m, std::size_t last) {
      for (; m < last && swept_[m].min <= own.max; ++m)
        if (ball_[k].overlaps(ball_[m])) found.push_back(swept_[m].slot);
    };
    take(k + 1, row_end);
    while (next < next_end && swept_[next].min < own.min - longest_) ++next;
    take(next, next_end);
    collector.add(block, own.slot, found);
  }
}

void SweepAndPrune::collect(const FatBodies& bodies, PairCollector& collector) {
  sort_intervals(bodies);
  const std::size_t n = interval_.size(), blocks = (n + sweep_block - 1) / sweep_block;
  collector.begin(blocks);
  if (n == 0) return;
  make_rows(bodies);
  ball_.resize(n);
  parallel_for(n, [&](std::size_t k) { ball_[k] = bodies.ball[swept_[k].slot]; });
  if (found_.size() < blocks) found_.resize(blocks);
  parallel_blocks(n, sweep_block,
                  [&](std::size_t begin, std::size_t end, std::size_t block) { sweep(begin, end, block, collector); });
}

}  // namespace epafi
