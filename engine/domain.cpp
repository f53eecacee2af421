#include "engine/domain.h"

#include <algorithm>
#include <cmath>

#include "engine/parallel.h"

namespace epafi {

bool is_finite(const World& world, Slot s) {
  // A sum is finite where all are; an overflow of the sum alone is looked at one by one.
  double sum = world.position[s].sum() + world.velocity[s].sum();
  if (world.rotates()) sum += world.angular_velocity[s].sum();
  if (world.has_orientation()) sum += world.orientation[s].coeffs().sum();
  if (std::isfinite(sum)) return true;
  const bool turns = !world.rotates() || world.angular_velocity[s].allFinite();
  const bool stands = !world.has_orientation() || world.orientation[s].coeffs().allFinite();
  return world.position[s].allFinite() && world.velocity[s].allFinite() && turns && stands;
}

std::vector<Slot> find_strays(const World& world, const std::optional<Domain>& domain) {
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
