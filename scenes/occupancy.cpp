#include "scenes/occupancy.h"

#include <array>
#include <cmath>

namespace epafi {

namespace {

using GridPlace = std::array<long, 3>;

GridPlace grid_place(const Vec3& x, double cell) {
  const auto along = [&](int k) { return static_cast<long>(std::floor(x[k] / cell)); };
  return {along(0), along(1), along(2)};
}

std::uint64_t grid_key(long i, long j, long k) {
  const auto part = [](long v) { return static_cast<std::uint64_t>(v + (1 << 20)) & 0x1fffff; };
  return part(i) | part(j) << 21 | part(k) << 42;
}

bool balls_overlap(const Vec3& x, double radius, const std::pair<Vec3, double>& ball) {
  const double reach = radius + ball.second;
  return (x - ball.first).squaredNorm() < reach * reach;
}

}  // namespace

bool Occupancy::is_free_of(const Level& level, const Vec3& x, double radius) {
  const Vec3 reach = Vec3::Constant(radius + 0.5 * level.cell);
  const GridPlace low = grid_place(x - reach, level.cell), high = grid_place(x + reach, level.cell);
  const double cells = double(high[0] - low[0] + 1) * double(high[1] - low[1] + 1) * double(high[2] - low[2] + 1);
  if (cells > static_cast<double>(level.all.size())) {  // few balls, or small ones beside a large one
    for (const Ball& ball : level.all)
      if (balls_overlap(x, radius, ball)) return false;
    return true;
  }
  for (long i = low[0]; i <= high[0]; ++i)
    for (long j = low[1]; j <= high[1]; ++j)
      for (long k = low[2]; k <= high[2]; ++k) {
        const auto found = level.in.find(grid_key(i, j, k));
        if (found == level.in.end()) continue;
        for (const std::uint32_t ball : found->second)
          if (balls_overlap(x, radius, level.all[ball])) return false;
      }
  return true;
}

bool Occupancy::is_free(const Vec3& x, double radius) const {
  const Vec3 at = cell_ ? cell_->inside(x) : x;
  for (const auto& [size, level] : levels_)
    if (!is_free_of(level, at, radius)) return false;
  // images of the body itself: only in a cell smaller than its diameter
  for (int k = 0; cell_ && k < 3; ++k)
    if (cell_->repeats[static_cast<std::size_t>(k)] && cell_->size[k] < 2 * radius) return false;
  return true;
}

void Occupancy::put(const Vec3& x, double radius) {
  const int size = std::ilogb(radius);
  Level& level = levels_[size];
  level.cell = 2 * std::ldexp(2.0, size);
  const GridPlace at = grid_place(x, level.cell);
  level.in[grid_key(at[0], at[1], at[2])].push_back(static_cast<std::uint32_t>(level.all.size()));
  level.all.emplace_back(x, radius);
}

void Occupancy::add(const Vec3& x, double radius) {
  if (!cell_) return put(x, radius);
  const Vec3 at = cell_->inside(x);
  // an image matters where a ball inside the cell can meet it: at most half a cell beyond the face
  const auto span = [&](int k) { return cell_->repeats[static_cast<std::size_t>(k)] ? 1 : 0; };
  for (int i = -span(0); i <= span(0); ++i)
    for (int j = -span(1); j <= span(1); ++j)
      for (int k = -span(2); k <= span(2); ++k) {
        const Vec3 image = at + cell_->shift(image_code(i, j, k));
        bool near = true;
        for (int axis = 0; axis < 3; ++axis) {
          if (!span(axis)) continue;
          const double reach = radius + 0.5 * cell_->size[axis], middle = cell_->low[axis] + 0.5 * cell_->size[axis];
          near = near && std::abs(image[axis] - middle) < reach + 0.5 * cell_->size[axis];
        }
        if (near) put(image, radius);
      }
}

}  // namespace epafi
