#include "detection/broad/spatial_hash.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/parallel_order.h"

namespace epafi {

namespace {
constexpr double cell_per_size = 1.0;    // cell edge over largest body of the class
constexpr double level_ratio = 2.0;      // sizes in one class
constexpr std::size_t block_size = 512;  // bodies per parallel block
constexpr std::uint32_t together = 4;
}  // namespace

std::int64_t SpatialHash::Axis::cell(double x) const {
  // not negative after the clamp, so truncation is floor; NaN never comes here
  return static_cast<std::int64_t>(std::clamp((x - origin) * inverse_cell, 0.0, last));
}

void SpatialHash::set_levels(const FatBodies& bodies) {
  const auto& all = bodies.ordinary;
  level_of_.resize(all.size());
  double largest = block_max<double>(all.size(), 0.0, [&](std::size_t k) { return bodies.half[all[k]]; });
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
      while (bodies.half[s] <= below[l]) ++l;
      level_of_[k] = static_cast<std::uint8_t>(l);
      Level& level = parts[b].level[l];
      ++level.count, level.half = std::max(level.half, bodies.half[s]);
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
      level_[l].count += part.level[l].count, level_[l].half = std::max(level_[l].half, part.level[l].half);
      centres[l].include(part.centres[l]);
    }
  std::uint32_t first = 0;
  std::size_t table = 0;
  for (std::size_t l = 0; l < levels_; ++l) {
    level_[l].first = first, level_[l].table = table;
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
  for (int k = 0; k < 3; ++k) {
    Axis& a = level.axis[static_cast<std::size_t>(k)];
    a.origin = low[k], a.inverse_cell = 1.0 / cell;
    a.last = std::min(std::floor((high[k] - low[k]) / cell), 1e15);
    cells[static_cast<std::size_t>(k)] = a.last + 1.0;
  }
  // fold the longest axis until the table has at most some four entries per body
  std::array<std::uint64_t, 3> size{};
  for (std::size_t k = 0; k < 3; ++k) size[k] = std::bit_ceil(static_cast<std::uint64_t>(cells[k]));
  const double most = 4.0 * level.count + 64.0;
  while (static_cast<double>(size[0]) * static_cast<double>(size[1]) * static_cast<double>(size[2]) > most)
    *std::max_element(size.begin(), size.end()) /= 2;
  for (std::size_t k = 0; k < 3; ++k) level.axis[k].mask = static_cast<std::int64_t>(size[k]) - 1;
}

void SpatialHash::sort_bodies(const FatBodies& bodies) {
  const auto& all = bodies.ordinary;
  cell_of_.resize(all.size()), ball_.resize(all.size() + together), slot_.resize(all.size() + together);
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
      [&](std::uint32_t place, Slot s) { ball_[place] = bodies.ball[s], slot_[place] = s; });
}

std::size_t SpatialHash::search(const FatBodies& bodies, const Level& level, std::uint32_t body, bool own_level,
                                std::vector<Slot>& found, std::size_t n) const {
  const Aabb box = bodies.box(slot_[body]);
  const Ball ball = ball_[body];
  std::array<std::int64_t, 3> from{}, to{};
  for (int d = 0; d < 3; ++d) {
    const Axis& a = level.axis[static_cast<std::size_t>(d)];
    auto &lo = from[static_cast<std::size_t>(d)], &hi = to[static_cast<std::size_t>(d)];
    lo = a.cell(box.min[d] - level.half), hi = a.cell(box.max[d] + level.half);
    if (hi - lo >= a.mask) lo = 0, hi = a.mask;  // the whole folded axis, each cell once
  }
  const std::uint32_t first = own_level ? body + 1 : 0;  // of its own level those behind it: each pair once
  const auto scan = [&](std::uint32_t begin, std::uint32_t end) {
    begin = std::max(begin, first);
    if (begin >= end) return;
    if (found.size() < n + (end - begin) + together) found.resize(2 * (n + (end - begin)) + together);
    Slot* out = found.data() + n;
    for (std::uint32_t k = begin; k < end; k += together)
      for (std::uint32_t l = 0; l < together; ++l) {  // no branch: half of the candidates hit
        *out = slot_[k + l];
        out += static_cast<int>(ball.overlaps(ball_[k + l])) & static_cast<int>(k + l < end);
      }
    n = static_cast<std::size_t>(out - found.data());
  };
  const auto [mx, my, mz] = std::array{level.axis[0].mask, level.axis[1].mask, level.axis[2].mask};
  const std::int64_t x0 = from[0] & mx, x1 = to[0] & mx;
  for (std::int64_t z = from[2]; z <= to[2]; ++z)
    for (std::int64_t y = from[1]; y <= to[1]; ++y) {
      const std::uint32_t* row = start_.data() + level.table + ((z & mz) * (my + 1) + (y & my)) * (mx + 1);
      if (x0 <= x1)
        scan(row[x0], row[x1 + 1]);
      else
        scan(row[0], row[x1 + 1]), scan(row[x0], row[mx + 1]);
    }
  return n;
}

void SpatialHash::collect(const FatBodies& bodies, PairCollector& collector) {
  const std::size_t n = bodies.ordinary.size(), blocks = (n + block_size - 1) / block_size;
  set_levels(bodies);
  sort_bodies(bodies);
  collector.begin(blocks);
  if (found_.size() < blocks) found_.resize(blocks);
  parallel_blocks(n, block_size, [&](std::size_t begin, std::size_t end, std::size_t block) {
    std::vector<Slot>& found = found_[block];
    for (std::size_t k = begin; k < end; ++k) {
      std::size_t own = 0, count = 0;
      while (own + 1 < levels_ && k >= level_[own + 1].first) ++own;
      for (std::size_t l = 0; l <= own; ++l)
        if (level_[l].count > 0)
          count = search(bodies, level_[l], static_cast<std::uint32_t>(k), l == own, found, count);
      collector.add(block, slot_[k], std::span(found).first(count));
    }
  });
}

}  // namespace epafi
