#include "laws/nonsmooth/position_correction.h"

#include <cmath>

#include "engine/threads/parallel_order.h"
#include "engine/units/registry.h"
#include "laws/nonsmooth/displacement.h"

namespace epafi {

namespace {
/// Square of the smaller lever arm of a body that moves [m^2].
double arm_square(const ContactSet& contacts, std::size_t i, const World& world) {
  const double free_a = world.is_movable(contacts.a[i]) ? contacts.arm[i].squaredNorm() : infinity;
  const double free_b = world.is_movable(contacts.b[i]) ? contacts.arm_b(i, world).squaredNorm() : infinity;
  return std::min(free_a, free_b);
}
}  // namespace

/// Fills demand_ with minus the demanded normal displacements. Returns false if all are negligible: at rest, overlaps
/// approach the slop from above without reaching it (sweeps for that would take a tenth of the time of a settled pile
/// of 1000 stones).
bool PositionCorrection::demand(const ContactSet& contacts, std::span<const double> gaps, const World& world) {
  // concentric spheres touch at their centres: then only the overlap gives their size
  const auto square = [&](std::size_t i) { return std::max(arm_square(contacts, i, world), 0.25 * gaps[i] * gaps[i]); };
  const double worth = (1.0 + settings_.band) * settings_.slop;
  const bool any = block_max<char>(contacts.size(), 0, [&](std::size_t i) {  // squares: no root for those at rest
                     return static_cast<char>(gaps[i] < 0.0 && gaps[i] * gaps[i] > worth * worth * square(i));
                   }) != 0;
  if (!any) return false;
  renew(demand_, contacts.size());
  parallel_for(contacts.size(), [&](std::size_t i) {
    demand_[i] = std::max(gaps[i], 0.0);
    const double size = std::sqrt(square(i)), excess = -gaps[i] - settings_.slop * size;  // size: infinite, none moves
    if (excess > 0.0) demand_[i] = -std::min(settings_.share * excess, settings_.largest * size);
  });
  return true;
}

template <class S>
double PositionCorrection::move(S& sweep, const ContactProblem& problem, World& world) {
  const Vec3 zero = Vec3::Zero();
  parallel_fill(nothing_, problem.size(), zero);
  parallel_fill(moved_.linear, world.size(), zero);
  parallel_fill(moved_.angular, problem.free.angular.size(), zero);
  sweep.load(problem, demand_, {}, nothing_, moved_);
  double total = 0.0;  // sum of squared impulses so far: the last change is measured against it
  for (int k = 0; k < settings_.sweeps; ++k) {
    const double change = sweep.run(NormalRule{});
    total += change;
    if (change <= settings_.tolerance * settings_.tolerance * total) break;
  }
  parallel_for(world.size(), [&](std::size_t i) {
    moved_.linear[i] = sweep.linear(static_cast<Slot>(i));
    if constexpr (requires { sweep.angular(0); }) moved_.angular[i] = sweep.angular(static_cast<Slot>(i));
  });
  return displace(world, problem, moved_);
}

double PositionCorrection::apply(const ContactProblem& problem, const ContactSet& contacts,
                                 std::span<const double> gaps, World& world) {
  if (settings_.share <= 0.0 || contacts.size() == 0 || !demand(contacts, gaps, world)) return 0.0;
  return problem.rotates ? move(with_rotation_, problem, world) : move(without_rotation_, problem, world);
}

}  // namespace epafi
