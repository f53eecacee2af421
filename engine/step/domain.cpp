#include "engine/step/domain.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/lanes/lanes.h"
#include "engine/threads/parallel.h"

namespace epafi {

bool is_finite(const World& world, Slot s) {
  // A sum is finite where all are; if only the sum overflows, bodies are tested one by one.
  double sum = world.position[s].sum() + world.velocity[s].sum();
  if (world.rotates()) sum += world.angular_velocity[s].sum();
  if (world.has_orientation()) sum += world.orientation[s].coeffs().sum();
  if (std::isfinite(sum)) return true;
  const bool turns = !world.rotates() || world.angular_velocity[s].allFinite();
  const bool stands = !world.has_orientation() || world.orientation[s].coeffs().allFinite();
  return world.position[s].allFinite() && world.velocity[s].allFinite() && turns && stands;
}

namespace {

/// x*0 is 0 for finite numbers and NaN for all others, so one sum tests all.
bool all_finite(const StateColumn<Vec3>& column) {
  const auto strange = [&](std::size_t s) { return static_cast<char>(!column[s].allFinite()); };
  if (column.in_records()) return block_max<char>(column.size(), 0, strange) == 0;
  constexpr std::size_t rows = 512;
  return block_max<char>((column.size() + rows - 1) / rows, 0, [&](std::size_t block) {
           const std::size_t begin = block * rows, end = std::min(column.size(), begin + rows);
           const double* x = column[begin].data();
           const std::size_t n = 3 * (end - begin);
           Lanes sum{}, other{};
           std::size_t k = 0;
           for (; k + 2 * lane_count <= n; k += 2 * lane_count) {
             Lanes a, b;
             std::memcpy(&a, x + k, sizeof a);
             std::memcpy(&b, x + k + lane_count, sizeof b);
             sum += 0.0 * a;
             other += 0.0 * b;
           }
           double rest = 0.0;
           for (; k < n; ++k) rest += 0.0 * x[k];
           sum += other;
           return static_cast<char>(!((sum[0] + sum[1]) + (sum[2] + sum[3]) + rest == 0.0));
         }) == 0;
}

bool all_finite(const World& world) {
  return all_finite(world.position) && all_finite(world.velocity) &&
         (!world.rotates() || all_finite(world.angular_velocity)) && !world.has_orientation();
}

}  // namespace

std::vector<Slot> find_strays(const World& world, const std::optional<Domain>& domain) {
  if (!domain && all_finite(world)) return {};
  const auto astray = [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    if (!world.is_movable(s)) return false;
    return !is_finite(world, s) || (domain && !domain->contains(world.position[s]));
  };
  const int any = block_max<int>(world.size(), 0, [&](std::size_t i) { return astray(i) ? 1 : 0; });
  std::vector<Slot> strays;
  if (any == 0) return strays;
  for (std::size_t i = 0; i < world.size(); ++i)
    if (astray(i)) strays.push_back(static_cast<Slot>(i));
  std::sort(strays.begin(), strays.end(), [&](Slot p, Slot q) { return world.id[p] < world.id[q]; });
  return strays;
}

}  // namespace epafi
