#include <algorithm>
#include <cmath>
#include <limits>

#include "detection/broad/fat_bodies.h"
#include "engine/threads/parallel_order.h"

namespace epafi {
namespace {

constexpr std::size_t most_giants = 16;

}  // namespace

double median_radius(const World& world, const ShapeStore& shapes) {
  constexpr std::size_t most_asked = 4096;
  const std::size_t stride = world.size() / most_asked + 1;
  std::vector<double> sample;
  const auto take = [&](std::size_t i) {
    const double r = shapes.bounding_radius({world.shape[i]});
    if (std::isfinite(r)) sample.push_back(r);
  };
  for (std::size_t i = 0; i < world.size(); i += stride)
    if (world.is_movable(static_cast<Slot>(i))) take(i);
  if (sample.empty())
    for (std::size_t i = 0; i < world.size(); ++i) take(i);
  if (sample.empty()) return 0.0;
  const auto middle = sample.begin() + static_cast<std::ptrdiff_t>(sample.size() / 2);
  std::nth_element(sample.begin(), middle, sample.end());
  return *middle;
}

double largest_ordinary(std::size_t count, double median, const std::function<double(std::size_t)>& radius) {
  const double giant = giant_ratio * median;
  const auto giants = block_sum<std::size_t>(count, [&](std::size_t i) {
    const double r = radius(i);
    return static_cast<std::size_t>(std::isfinite(r) && r > giant);
  });
  return giants <= most_giants ? giant : std::numeric_limits<double>::max();
}

}  // namespace epafi
