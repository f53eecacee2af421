#include "detection/broad/spatial_hash.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "engine/lanes/lane_bits.h"
#include "engine/threads/parallel_order.h"

namespace epafi {

namespace {
constexpr double cell_per_size = 1.5;    // cell edge over largest body of the class
constexpr double level_ratio = 2.0;      // sizes in one class
constexpr std::size_t block_size = 512;  // bodies per parallel block
constexpr std::uint32_t most_lanes = 16;
constexpr float above = 1.0f + 0x1p-20f, below = 1.0f - 0x1p-20f;  // sums and differences of floats are rounded
constexpr double most_cells = 1e15;                                // along an axis

/// Removes those of [first, last) whose balls do not overlap this one; returns their number.
std::size_t drop_apart(const Ball& ball, const FatBodies& bodies, Slot* first, Slot* last) {
  return static_cast<std::size_t>(last -
                                  std::remove_if(first, last, [&](Slot s) { return !ball.overlaps(bodies.ball[s]); }));
}
}  // namespace

void SpatialHash::set_levels(const FatBodies& bodies) {
  const auto& all = bodies.ordinary;
  level_of_.resize(all.size());
  double largest = block_max<double>(all.size(), 0.0, [&](std::size_t k) { return bodies.half_of(all[k]); });
  std::array<double, most_levels> below{};  // class l holds halves in (below[l], below[l - 1]]
  for (std::size_t l = 0; l < most_levels; ++l) below[l] = largest /= level_ratio;
  below[most_levels - 1] = -1.0;
  struct Part {
    std::array<Level, most_levels> level;
    std::array<Aabb, most_levels> centres;
  };
  constexpr std::size_t size = 8192;
  auto& parts = block_results<Part>((all.size() + size - 1) / size, Part{});
  parallel_blocks(all.size(), size, [&](std::size_t begin, std::size_t end, std::size_t b) {
    for (std::size_t k = begin; k < end; ++k) {
      const Slot s = all[k];
      std::size_t l = 0;
      while (bodies.half_of(s) <= below[l]) ++l;
      level_of_[k] = static_cast<std::uint8_t>(l);
      Level& level = parts[b].level[l];
      ++level.count;
      level.half = std::max(level.half, bodies.half_of(s));
      parts[b].centres[l].include(bodies.position(s));
    }
  });
  level_.fill(Level{});
  levels_ = 0;
  std::array<Aabb, most_levels> centres;
  for (const Part& part : parts)
    for (std::size_t l = 0; l < most_levels; ++l) {
      if (part.level[l].count == 0) continue;
      levels_ = std::max(levels_, l + 1);
      level_[l].count += part.level[l].count;
      level_[l].half = std::max(level_[l].half, part.level[l].half);
      centres[l].include(part.centres[l]);
    }
  std::uint32_t first = 0;
  std::size_t table = 0;
  for (std::size_t l = 0; l < levels_; ++l) {
    level_[l].first = first;
    level_[l].table = table;
    first += level_[l].count;
    if (level_[l].count > 0) set_grid(level_[l], centres[l].min, centres[l].max);
    std::size_t cells = 1;
    for (const Axis& a : level_[l].axis) cells *= static_cast<std::size_t>(a.mask + 1);
    table += cells + 1;  // one behind them: where the last cell ends
  }
  cells_ = table;
}

void SpatialHash::set_grid(Level& level, const Vec3& low, const Vec3& high) {
  // positions are rounded to an ulp of their size: the search must reach a little further
  level.half += 0x1p-48 * std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  const double cell = std::max(cell_per_size * 2.0 * level.half, 1e-300);
  std::array<double, 3> cells{};
  double most = 0.0;
  for (int k = 0; k < 3; ++k) {
    Axis& a = level.axis[static_cast<std::size_t>(k)];
    a.origin = low[k];
    a.inverse_cell = 1.0 / cell;
    most = std::max(most, (high[k] - low[k]) / cell);
    a.last = std::min(std::floor((high[k] - low[k]) / cell), most_cells);
    cells[static_cast<std::size_t>(k)] = a.last + 1.0;
  }
  // two places rounded to floats, three axes: sqrt(3) 2^-23 of the largest; too far for floats: all is in doubt
  level.doubt = most < most_cells ? static_cast<float>(0x1p-22 * most) : std::numeric_limits<float>::infinity();
  // fold the longest axis until the table has at most some four entries per body
  std::array<std::uint64_t, 3> size{};
  for (std::size_t k = 0; k < 3; ++k) size[k] = std::bit_ceil(static_cast<std::uint64_t>(cells[k]));
  const double entries = 4.0 * level.count + 64.0;
  while (static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]) > entries)
    *std::max_element(size.begin(), size.end()) /= 2;
  for (std::size_t k = 0; k < 3; ++k) level.axis[k].mask = static_cast<std::int64_t>(size[k]) - 1;
}

void SpatialHash::sort_bodies(const FatBodies& bodies) {
  const auto& all = bodies.ordinary;
  cell_of_.resize(all.size());
  stride_ = all.size() + most_lanes;
  sorted_.resize(4 * stride_);
  slot_.resize(stride_);
  parallel_for(all.size(), [&](std::size_t k) {
    const Level& level = level_[level_of_[k]];
    const Vec3 x = bodies.position(all[k]);
    std::uint64_t cell = 0;
    for (int d = 2; d >= 0; --d) {
      const Axis& a = level.axis[static_cast<std::size_t>(d)];
      cell = cell * static_cast<std::uint64_t>(a.mask + 1) + static_cast<std::uint64_t>(a.cell(x[d]) & a.mask);
    }
    cell_of_[k] = static_cast<std::uint32_t>(level.table + cell);
  });
  // order in a cell is by slot
  const auto each = [&](std::size_t begin, std::size_t end, const auto& f) {
    for (std::size_t k = begin; k < end; ++k) f(cell_of_[k], all[k]);
  };
  parallel_group(
      all.size(), cells_, start_, each, [](std::size_t) {},
      [&](std::uint32_t place, Slot s) {
        const Ball& b = bodies.ball[s];
        const auto& axis = level_[level_at(place)].axis;
        float* const x = sorted_.data() + place;
        x[0] = axis[0].place(b.x);
        x[stride_] = axis[1].place(b.y);
        x[2 * stride_] = axis[2].place(b.z);
        x[3 * stride_] = static_cast<float>(b.r * axis[0].inverse_cell);
        slot_[place] = s;
      });
}

template <int n>
EPAFI_LANES std::size_t SpatialHash::search(const Level& level, const Ball& ball, double half, std::uint32_t first,
                                            const FatBodies& bodies, std::vector<Slot>& found,
                                            std::size_t count) const {
  constexpr int m = 2 * n;
  using V = typename FloatsOf<m>::Real;
  const double centre[] = {ball.x, ball.y, ball.z}, reach = half + level.half;
  std::int64_t from[3], to[3];
  V x[3];
  for (std::size_t d = 0; d < 3; ++d) {
    const Axis& a = level.axis[d];
    x[d] = V{} + a.place(centre[d]);
    from[d] = a.cell(centre[d] - reach);
    to[d] = a.cell(centre[d] + reach);
    if (to[d] - from[d] >= a.mask) {  // the whole folded axis, each cell once
      from[d] = 0;
      to[d] = a.mask;
    }
  }
  const V r = V{} + static_cast<float>(ball.r * level.axis[0].inverse_cell), none{};
  const auto at = [](const float* column, std::uint32_t k) EPAFI_INLINED {
    V out;
    std::memcpy(&out, column + k, sizeof out);
    return out;
  };
  const float *const xs = sorted_.data(), *const ys = xs + stride_, *const zs = ys + stride_, *const rs = zs + stride_;
  const Slot* const slots = slot_.data();
  const auto scan = [&](std::uint32_t begin, std::uint32_t end) EPAFI_INLINED {
    if ((begin = std::max(begin, first)) >= end) return;
    if (found.size() < count + (end - begin) + m) found.resize(2 * (count + (end - begin)) + most_lanes);
    for (std::uint32_t k = begin; k < end; k += m) {  // as Ball::overlaps, but for what floats cannot tell
      const V dx = x[0] - at(xs, k), dy = x[1] - at(ys, k), dz = x[2] - at(zs, k), sum = r + at(rs, k);
      const V square = dx * dx + dy * dy + dz * dz, far = sum * above + level.doubt, close = sum * below - level.doubt;
      const unsigned valid = end - k < m ? (1u << (end - k)) - 1u : (1u << m) - 1u;
      const unsigned maybe = ~less_float_bits<m>(far * far, square) & valid;
      const V sure = close < none ? none : close * close;
      Slot* const behind = found.data() + count;
      count += write_chosen<m>(maybe, slots + k, behind);
      if ((maybe & ~less_float_bits<m>(square, sure)) != 0) [[unlikely]]
        count -= drop_apart(ball, bodies, behind, found.data() + count);
    }
  };
  const std::int64_t mx = level.axis[0].mask, my = level.axis[1].mask, mz = level.axis[2].mask;
  const std::int64_t x0 = from[0] & mx, x1 = to[0] & mx;
  for (std::int64_t k = from[2]; k <= to[2]; ++k)
    for (std::int64_t j = from[1]; j <= to[1]; ++j) {
      const std::uint32_t* row = start_.data() + level.table + ((k & mz) * (my + 1) + (j & my)) * (mx + 1);
      if (x0 <= x1)
        scan(row[x0], row[x1 + 1]);
      else {
        scan(row[0], row[x1 + 1]);
        scan(row[x0], row[mx + 1]);
      }
    }
  return count;
}

/// The search of some bodies, compiled for each instruction set.
struct SpatialHash::Block {
  const SpatialHash& hash;
  const FatBodies& bodies;
  PairCollector& collector;
  std::vector<Slot>& found;
  std::size_t begin, end, block;
  bool in_order;

  template <int n>
  EPAFI_LANES void run() const {
    if (in_order)
      in_slots<n>();
    else
      in_cells<n>();
  }

 private:
  /// Bodies in the order of the cells, each with those behind it and with larger ones: every pair once.
  template <int n>
  EPAFI_LANES void in_cells() const {
    for (std::size_t k = begin; k < end; ++k) {
      const Slot s = hash.slot_[k];
      const std::size_t own = hash.level_at(k);
      std::size_t count = 0;
      for (std::size_t l = 0; l <= own; ++l)
        if (hash.level_[l].count > 0)
          count = hash.search<n>(hash.level_[l], bodies.ball[s], bodies.half_of(s),
                                 l == own ? static_cast<std::uint32_t>(k) + 1 : 0, bodies, found, count);
      collector.add(block, s, std::span(found).first(count), true);
    }
  }
  /// Of one class, in the order of the slots, each with all it is near: twice the cells, but nothing is to be sorted.
  template <int n>
  EPAFI_LANES void in_slots() const {
    for (std::size_t k = begin; k < end; ++k) {
      const Slot s = bodies.ordinary[k];
      const std::size_t count = hash.search<n>(hash.level_[0], bodies.ball[s], bodies.half_of(s), 0, bodies, found, 0);
      collector.add(block, s, std::span(found).first(count), true);
    }
  }
};

void SpatialHash::collect(const FatBodies& bodies, PairCollector& collector) {
  const std::size_t n = bodies.ordinary.size(), blocks = (n + block_size - 1) / block_size;
  set_levels(bodies);
  sort_bodies(bodies);
  // among several classes large bodies would search the cells of small ones (1:10 lognormal: 514 ns a body for 285)
  const bool in_order = bodies.ordered_spheres && levels_ == 1;
  collector.begin(blocks, in_order);
  if (found_.size() < blocks) found_.resize(blocks);
  const auto search_block = best_loop<Block>();
  parallel_blocks(n, block_size, [&](std::size_t begin, std::size_t end, std::size_t block) {
    search_block({*this, bodies, collector, found_[block], begin, end, block, in_order});
  });
}

}  // namespace epafi
