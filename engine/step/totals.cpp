#include "engine/step/totals.h"

#include "engine/step/energy.h"

namespace epafi {

BodyTotals& BodyTotals::operator+=(const BodyTotals& other) {
  kinetic += other.kinetic;
  potential += other.potential;
  mass += other.mass;
  for (std::size_t k = 0; k < 3; ++k) momentum[k] += other.momentum[k];
  momenta += other.momenta;
  farthest = std::max(farthest, other.farthest);
  return *this;
}

BodyTotals body_totals(const World& world) {
  const auto is_counted = [&](Slot s) {
    return world.is_movable(s) && (world.owner.empty() || world.owner[s] == World::here);
  };
  const auto sums = order_free_totals<7>(world.size(), [&](std::size_t i) -> std::array<double, 7> {
    const auto s = static_cast<Slot>(i);
    if (!is_counted(s)) return {};
    const double mass = 1.0 / world.inverse_mass[s];
    const Vec3 p = mass * world.velocity[s];
    return {kinetic_energy(world, s), potential_energy(world, s), mass, p.x(), p.y(), p.z(), p.norm()};
  });
  BodyTotals out{sums[0], sums[1], sums[2], {sums[3], sums[4], sums[5]}, sums[6], 0.0};
  out.farthest = block_max<double>(world.size(), 0.0, [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    return is_counted(s) ? world.position[s].norm() : 0.0;
  });
  return out;
}

}  // namespace epafi
