#include "engine/step/cell_events.h"

#include <algorithm>
#include <cmath>

#include "engine/threads/parallel.h"

namespace epafi {

namespace {

/// What stands still is where the scene has put it, whatever its own point.
bool is_outside(const World& world, Slot s, int axis, double slack) {
  const PeriodicCell& cell = *world.cell;
  if (!cell.repeats[static_cast<std::size_t>(axis)]) return false;
  if (!world.is_movable(s) && world.velocity[s] == Vec3::Zero()) return false;
  const double u = world.position[s][axis] - cell.low[axis];
  return u < -slack || u >= cell.size[axis] + slack;
}

}  // namespace

bool WrapBodies::asks(const World& world) const {
  const auto is_astray = [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    const auto outside = [&](int axis) { return is_outside(world, s, axis, slack_); };
    return static_cast<char>(outside(0) || outside(1) || outside(2));
  };
  return block_max<char>(world.size(), 0, is_astray) != 0;
}

void WrapBodies::answer(World& world) {
  const PeriodicCell& cell = *world.cell;
  parallel_for(world.size(), [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    for (int k = 0; k < 3; ++k) {
      if (!is_outside(world, s, k, world.is_movable(s) ? 0.0 : slack_)) continue;
      const double n = cell.cells_to(world.position[s], k);
      if (!(std::abs(n) < 1e9)) continue;  // no number: whoever watches the state reports it
      world.position[s][k] -= n * cell.size[k];
      world.wraps[s][k] += static_cast<int>(n);
    }
  });
}

namespace {

/// The next strain rate of an axis, `share` of the limit per relative excess of the stress over its target. A packing
/// near jamming is so stiff that a share fit for the gas before it overshoots within a step and shakes the packing for
/// ever; hence the share begins at 1, halves where the direction changes, down to a hundredth, and grows again slowly
/// where it stays. fall: of the target in this step; a packing's stiffness over its pressure rises by as much, and
/// where the share does not follow the packing falls apart.
double followed(double before, double excess, double limit, double fall, double& share) {
  constexpr double growth = 2e-5, least = 1e-2;  // per step; of the limit
  share = before * excess < 0.0 ? 0.5 * share : std::min(1.0, (1.0 + growth) * share);
  if (excess > -0.5) share *= fall;
  share = std::max(least, share);
  return share * limit * std::clamp(excess, -1.0, 1.0);
}

}  // namespace

double CellControl::pressure_at(double time) const {
  if (time >= pressure_time) return *pressure;
  return first_pressure * std::pow(*pressure / first_pressure, std::max(0.0, time) / pressure_time);
}

void DeformCell::before_step(World& world, double dt, std::vector<BodyId>&) {
  PeriodicCell& cell = *world.cell;
  if (control_.pressure) {
    const double time = world.clock + elapsed_;
    const double target = control_.pressure_at(time), fall = target / control_.pressure_at(time - dt);
    const Vec3 excess = cell.stress() / target - Vec3::Ones();
    for (int k = 0; k < 3; ++k)
      if (cell.repeats[static_cast<std::size_t>(k)])
        cell.strain_rate[k] = followed(cell.strain_rate[k], excess[k], control_.rate_limit, fall, share_[k]);
  } else {
    cell.strain_rate = control_.strain_rate;
  }
  const Vec3 stretch = Vec3::Ones() + dt * cell.strain_rate;
  cell.size = cell.size.cwiseProduct(stretch);
  parallel_for(world.size(), [&](std::size_t s) {
    if (world.is_movable(static_cast<Slot>(s)))
      world.position[s] = cell.low + (world.position[s] - cell.low).cwiseProduct(stretch);
  });
}

}  // namespace epafi
