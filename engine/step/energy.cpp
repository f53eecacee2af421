#include "engine/step/energy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/threads/parallel.h"

namespace epafi {

double kinetic_energy(const World& world, Slot s) {
  if (!world.is_movable(s)) return 0.0;
  double twice = world.velocity[s].squaredNorm() / world.inverse_mass[s];
  if (world.rotates()) {
    const bool even = world.is_isotropic(s);  // the axes do not matter
    const Vec3 &spin = world.angular_velocity[s], w = even ? spin : Vec3(world.orientation[s].conjugate() * spin);
    twice += w.cwiseProduct(w).cwiseQuotient(world.inverse_inertia_of(s)).sum();
  }
  return 0.5 * twice;
}

double kinetic_energy(const World& world) {
  return order_free_sum(world.size(), [&](std::size_t i) { return kinetic_energy(world, static_cast<Slot>(i)); });
}

double potential_energy(const World& world, Slot s) {
  if (!world.is_movable(s)) return 0.0;
  return -world.steady_acceleration(s).dot(world.unwrapped(s)) / world.inverse_mass[s];
}

double potential_energy(const World& world) {
  return order_free_sum(world.size(), [&](std::size_t i) { return potential_energy(world, static_cast<Slot>(i)); });
}

Vec3 linear_momentum(const World& world) {
  const BodyTotals all = body_totals(world);
  return {all.momentum[0].value(), all.momentum[1].value(), all.momentum[2].value()};
}

void EnergyLedger::start(const World& world, const StepReport& report, const Losses& met) {
  now_ = {};
  early_ = 0.0;
  now_.elastic = report.elastic;
  now_.losses.adhesive = now_.taken = now_.dissipated = settled_ = met.adhesive;
  measure(world);
  start_ = now_.stored() + met.adhesive;
  largest_inner_ = now_.kinetic + std::abs(now_.elastic);
  lowest_potential_ = highest_potential_ = now_.potential;
}

void EnergyLedger::add(const StepReport& report, double fall) {
  fall_ = report.has_solver ? fall : 0.0;
  now_.elastic = report.elastic;
  now_.taken += report.dissipated;
  early_ = std::max(2.0 * report.losses.viscous, 0.5 * early_);
  settled_ = std::max(settled_, now_.taken - early_);
  now_.dissipated = std::max(now_.taken, settled_);
  now_.gained = std::max(now_.gained, now_.dissipated - now_.taken);
  now_.losses += report.losses;
  now_.work += report.work;
  now_.correction += report.correction;
  // heights are known to rounding: bodies at rest far from the origin are at rest
  highest_potential_ += 100.0 * std::numeric_limits<double>::epsilon() * std::abs(now_.potential);
}

void EnergyLedger::accept_jump(const World& world, double stored_before) {
  const double jump = stored(world) - stored_before;
  now_.work += jump;
  // removed bodies do not widen the spread of the potential energy
  const double potential = potential_energy(world);
  const double change = potential - now_.potential;
  lowest_potential_ += change;
  highest_potential_ += change;
  now_.potential = potential;
}

void EnergyLedger::accept_bodies(double kinetic, double potential) {
  now_.work += kinetic + potential;
  lowest_potential_ += potential;
  highest_potential_ += potential;
  now_.kinetic += kinetic;
  now_.potential += potential;
}

Energy EnergyLedger::measure(const BodyTotals& bodies) {
  if (fall_ > 0.0) mass_ = bodies.mass.value();
  now_.kinetic = bodies.kinetic.value();
  now_.potential = bodies.potential.value();
  largest_inner_ = std::max(largest_inner_, now_.kinetic + std::abs(now_.elastic));
  lowest_potential_ = std::min(lowest_potential_, now_.potential);
  highest_potential_ = std::max(highest_potential_, now_.potential);
  return now_;
}

double EnergyLedger::error() const {
  // residual velocities of bodies at rest oscillate: below a thousandth of the energy of one step of free fall they are
  // no gain
  const double gain = now_.dissipated - now_.taken, noise = 1e-3 * 0.5 * mass_ * fall_ * fall_;
  return now_.stored() - start_ + now_.dissipated - now_.work - std::min(gain, noise);
}

double EnergyLedger::beside_stored() const {
  // passed through: given by driven bodies and sources, taken by contacts; what contacts alone take they could have
  // made
  const double passed = std::min(std::abs(now_.work), now_.dissipated);
  return passed + 0.5 * mass_ * fall_ * fall_;
}

double EnergyLedger::relative(double error) const {
  const double reference = largest_inner_ + (highest_potential_ - lowest_potential_) + beside_stored();
  // differences of large terms contain rounding: a body at rest at a large height has no energy error
  const double rounding =
      1e-14 * (std::abs(now_.potential) + std::abs(start_) + now_.kinetic + std::abs(now_.elastic) + now_.dissipated);
  if (!std::isfinite(error)) return error;
  return std::abs(error) > rounding && reference > 0 ? error / reference : 0.0;
}

void EnergyLedger::visit(StateVisitor& v) {
  v.value("energy/now", now_);
  v.value("energy/start", start_);
  v.value("energy/settled", settled_);
  v.value("energy/early", early_);
  v.value("energy/largest_inner", largest_inner_);
  v.value("energy/mass", mass_);
  v.value("energy/fall", fall_);
  v.value("energy/lowest_potential", lowest_potential_);
  v.value("energy/highest_potential", highest_potential_);
}

}  // namespace epafi
