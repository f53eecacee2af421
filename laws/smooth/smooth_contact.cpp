#include "laws/smooth/smooth_contact.h"

#include "engine/state/virial.h"
#include "engine/threads/parallel.h"
#include "engine/units/error.h"
#include "laws/smooth/passes/tile_passes.h"

namespace epafi {

namespace {

RecordParts parts_of(const SmoothLaw& law) {
  return {law.state, law.friction.memory, law.rolls ? sizeof(TileSpring) / sizeof(double) : 0,
          std::size_t{law.needs.push}};
}

}  // namespace

SmoothSums& SmoothSums::operator+=(const SmoothSums& o) {
  touching += o.touching;
  elastic += o.elastic;
  spring_energy += o.spring_energy;
  spring_energy_before += o.spring_energy_before;
  slipped += o.slipped;
  viscous_power += o.viscous_power;
  late += o.late;
  driven_power += o.driven_power;
  lost += o.lost;
  return *this;
}

void VelocityChange::of(const World& world, Slot body, double time) {
  linear[body] = time * world.acceleration(body);
  if (!world.rotates()) return;
  angular[body] =
      world.is_movable(body) ? Vec3(time * world.apply_inverse_inertia(body, world.torque[body])) : Vec3(0, 0, 0);
}

void VelocityChange::predict(const World& world, double time) {
  if (!(time > 0.0)) return;
  resize(world);
  parallel_for(world.size(), [&](std::size_t s) { of(world, static_cast<Slot>(s), time); });
}

void VelocityChange::predict(const World& world, const ContactSet& contacts, TouchedBodies& touched, double time) {
  if (time > 0.0) resize(world);
  touched.build(contacts, world, [&](Slot s) {
    if (time > 0.0) of(world, s, time);
  });
}

Vec3 contact_virial(const World& world, const ContactSet& contacts) {
  const auto sums = order_free_sums<3>(contacts.size(), [&](std::size_t i) { return virial_term(world, contacts, i); });
  return {sums[0].sum, sums[1].sum, sums[2].sum};
}

SmoothContact::SmoothContact(SmoothLaw law) : law_(std::move(law)), memory_(parts_of(law_)) {}

void SmoothContact::act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) {
  contacts.force.resize(contacts.size());
  contacts.with_moment = law_.rolls;
  if (law_.rolls) contacts.moment.resize(contacts.size());
  const double lag = law_.damped ? clock.velocity_lag * clock.dt : 0.0;
  if (!clock.touched) incidence_.build(contacts, world.size());
  if (clock.touched || (lag > 0.0 && 4 * contacts.size() < world.size()))
    change_.predict(world, contacts, touched_, lag);
  else
    change_.predict(world, lag);
  if (law_.remembers())
    memory_.advance(world, contacts, [this](double* record) {
      if (law_.needs.friction) law_.friction.exchange(record + law_.state);
      if (law_.rolls) exchange(*reinterpret_cast<Spring*>(record + law_.state + law_.friction.memory));
    });
  EPAFI_REQUIRE(world.rotates() || !law_.needs.friction, "friction and rolling need a world with rotation");
  const SmoothSums sums = run(world, contacts, clock.dt, lag);
  if (law_.remembers() && clock.dt == 0.0) memory_.keep();
  if (clock.touched)
    gather_forces(contacts, touched_, world, *clock.touched);
  else
    gather_forces(contacts, incidence_, world);
  record(sums, contacts, clock.dt, report);
  if (world.cell) {                          // the forces before and after the strain act along it
    const Vec3 before = world.cell->virial;  // of all contacts, those of spheres in their own loop too
    world.cell->virial = contact_virial(world, contacts);
    report.work += 0.5 * clock.dt * (before + world.cell->virial).dot(world.cell->strain_rate);
  }
}

void SmoothContact::reorder(const Reordering& change) {
  if (law_.remembers()) memory_.reorder(change);
}

void SmoothContact::visit(StateVisitor& visitor) {
  visitor.share("smooth/viscous_power", before_.viscous_power);
  visitor.share("smooth/driven_power", before_.driven_power);
  visitor.value("smooth/step", ratio_.last);
  if (law_.needs.friction) visitor.share("smooth/spring_energy", before_.spring_energy);
  if (law_.remembers()) memory_.visit(visitor);
}

SmoothSums SmoothContact::run(const World& world, ContactSet& contacts, double dt, double lag) {
  const Passes passes = law_.passes();
  const auto loop = contact_tiles();
  const double ratio = lag > 0.0 ? ratio_.next(dt) : 1.0;
  blocks_.resize((contacts.size() + sum_block - 1) / sum_block);
  parallel_blocks(contacts.size(), sum_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
    loop({world, contacts, law_, passes, change_, memory_, dt, lag, ratio, begin, end, blocks_[block]});
  });
  SmoothSums total;
  for (const SmoothSums& s : blocks_) total += s;
  return total;
}

void SmoothContact::record(const SmoothSums& now, const ContactSet& contacts, double dt, StepReport& report) {
  report.contacts = contacts.size();
  report.touching = now.touching;
  report.elastic = now.elastic + now.spring_energy;
  report.work = 0.5 * dt * (before_.driven_power + now.driven_power);
  Losses& lost = report.losses = {};
  if (dt > 0.0) {
    lost.viscous = 0.5 * dt * (before_.viscous_power + now.viscous_power) + now.late;
    lost.frictional = now.slipped + (before_.spring_energy - now.spring_energy_before);
    if (!law_.holds) lost.plastic = now.lost;
  }
  if (law_.holds) lost.adhesive = now.lost;  // bodies in contact at the start begin to adhere there
  report.dissipated = lost.viscous + lost.frictional + lost.plastic + lost.adhesive;
  report.has_solver = false;
  before_ = now;
}

}  // namespace epafi
