#include "detection/broad/sweep_and_prune.h"

#include <algorithm>
#include <cmath>

#include "engine/parallel.h"

namespace epafi {

namespace {
constexpr std::size_t sweep_block = 256;
constexpr std::size_t exchanges_per_body = 32;  // beyond, the old order is no help

/// Axis along which the centres are spread most.
int widest_axis(const FatBodies& bodies) {
  const auto& all = bodies.ordinary;
  const double n = static_cast<double>(std::max<std::size_t>(all.size(), 1));
  const auto mean_of = [&](auto&& f) {
    const Sum3 s = block_sum<Sum3>(all.size(), [&](std::size_t k) {
      const Vec3 v = f(bodies.position[all[k]]);
      return Sum3{v.x(), v.y(), v.z()};
    });
    return Vec3(s.a / n, s.b / n, s.c / n);
  };
  const Vec3 mean = mean_of([](const Vec3& x) { return x; });
  const Vec3 spread = mean_of([&](const Vec3& x) { return Vec3((x - mean).cwiseAbs()); });
  int axis = 0;
  spread.maxCoeff(&axis);
  return axis;
}
}  // namespace

void SweepAndPrune::sort_intervals(const FatBodies& bodies) {
  const auto before = [](const Interval& p, const Interval& q) { return p.min != q.min ? p.min < q.min : p.slot < q.slot; };
  bool known = !slots_changed() && axis_ >= 0 && interval_.size() == bodies.ordinary.size();
  if (!known) {
    axis_ = widest_axis(bodies);
    interval_.resize(bodies.ordinary.size());
    for (std::size_t k = 0; k < interval_.size(); ++k) interval_[k].slot = bodies.ordinary[k];
  }
  parallel_for(interval_.size(), [&](std::size_t k) {
    Interval& i = interval_[k];
    i.min = bodies.box[i.slot].min[axis_], i.max = bodies.box[i.slot].max[axis_];
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

void SweepAndPrune::collect(const FatBodies& bodies, PairCollector& collector) {
  sort_intervals(bodies);
  const std::size_t n = interval_.size(), blocks = (n + sweep_block - 1) / sweep_block;
  ball_.resize(n);
  parallel_for(n, [&](std::size_t k) { ball_[k] = bodies.ball[interval_[k].slot]; });
  collector.begin(blocks);
  if (found_.size() < blocks) found_.resize(blocks);
  parallel_blocks(n, sweep_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
    std::vector<Slot>& found = found_[block];
    for (std::size_t k = begin; k < end; ++k) {
      found.clear();
      for (std::size_t m = k + 1; m < n && interval_[m].min <= interval_[k].max; ++m)
        if (ball_[k].overlaps(ball_[m])) found.push_back(interval_[m].slot);
      collector.add(block, interval_[k].slot, found);
    }
  });
}

}  // namespace epafi
