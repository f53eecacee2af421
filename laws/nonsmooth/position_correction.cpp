#include "laws/nonsmooth/position_correction.h"

#include <cmath>

#include "engine/registry.h"
#include "engine/rotation.h"

namespace epafi {

/// Fills demand_ with minus the demanded normal displacements; false when none is demanded.
bool PositionCorrection::demand(const ContactSet& contacts, const std::vector<double>& gaps, const World& world) {
  demand_.resize(contacts.size());
  const auto arm = [&](std::size_t i) {
    const double free_a = world.is_movable(contacts.a[i]) ? contacts.arm[i].norm() : infinity;
    const double free_b = world.is_movable(contacts.b[i]) ? contacts.arm_b(i, world).norm() : infinity;
    return std::min(free_a, free_b);
  };
  const double deepest = block_max(contacts.size(), 0.0, [&](std::size_t i) {
    // spheres in one place touch at their centres: then the overlap alone tells how large they are
    const double size = std::max(arm(i), -0.5 * gaps[i]);
    demand_[i] = std::max(gaps[i], 0.0);
    if (!std::isfinite(size)) return 0.0;  // two bodies that cannot move
    const double excess = -gaps[i] - settings_.slop * size;
    if (excess > 0.0) demand_[i] = -std::min(settings_.share * excess, settings_.largest * size);
    return excess;
  });
  return deepest > 0.0;
}

template <class S>
double PositionCorrection::move(S& sweep, const ContactProblem& problem, World& world) {
  nothing_.assign(problem.size(), Vec3::Zero());
  still_.linear.assign(world.size(), Vec3::Zero());
  still_.angular.assign(problem.free.angular.size(), Vec3::Zero());
  coloring_.update(problem);
  sweep.load(problem, demand_, {}, coloring_, nothing_, still_);
  double total = 0.0;  // sum of squared impulses so far: the last change is measured against it
  for (int k = 0; k < settings_.sweeps; ++k) {
    const double change = sweep.run(NormalRule{});
    total += change;
    if (change <= settings_.tolerance * settings_.tolerance * total) break;
  }
  const bool rotates = problem.rotates && world.has_orientation();
  parallel_for(world.size(), [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    if (!world.is_movable(s)) return;
    world.position[s] += sweep.linear(s);
    if constexpr (requires { sweep.angular(s); }) {
      if (rotates) world.orientation[s] = turned(world.orientation[s], sweep.angular(s));
    }
  });
  return -block_sum<double>(world.size(), [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    return world.is_movable(s) ? world.free_acceleration(s).dot(sweep.linear(s)) / world.inverse_mass[s] : 0.0;
  });
}

double PositionCorrection::apply(const ContactProblem& problem, const ContactSet& contacts,
                                 const std::vector<double>& gaps, World& world) {
  if (settings_.share <= 0.0 || contacts.size() == 0 || !demand(contacts, gaps, world)) return 0.0;
  return problem.rotates ? move(with_rotation_, problem, world) : move(without_rotation_, problem, world);
}

}  // namespace epafi
