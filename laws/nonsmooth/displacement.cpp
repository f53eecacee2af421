#include "laws/nonsmooth/displacement.h"

#include "engine/state/rotation.h"
#include "engine/threads/parallel.h"

namespace epafi {

double displace(World& world, const ContactProblem& problem, const BodyVelocities& by) {
  const bool turns = world.has_orientation() && !by.angular.empty();
  parallel_for(world.size(), [&](std::size_t k) {
    const auto s = static_cast<Slot>(k);
    if (!world.is_movable(s)) return;
    world.position[s] += by.linear[k];
    if (turns && !by.angular[k].isZero(0.0)) world.orientation[s] = turned(world.orientation[s], by.angular[k]);
  });
  for (const Guide& g : problem.guides) world.position[g.slot] += g.speed(by) * g.direction;
  return -block_sum<double>(world.size(), [&](std::size_t k) {
    const auto s = static_cast<Slot>(k);
    return world.is_movable(s) ? world.steady_acceleration(s).dot(by.linear[k]) / world.inverse_mass[s] : 0.0;
  });
}

}  // namespace epafi
