#include "laws/smooth/smooth_contact.h"

#include "engine/state/virial.h"
#include "engine/threads/parallel.h"
#include "engine/units/error.h"

namespace epafi {

namespace {

constexpr std::size_t numbers_of_spring = sizeof(Spring) / sizeof(double);

RecordParts parts_of(const SmoothLaw& law) {
  return {law.state, law.friction.memory, law.rolls ? numbers_of_spring : 0};
}

/// 1/m + r^2/I of a body pushed sideways at its contact point, I the harmonic mean of its moments; 0 when not free.
double slip_mobility(const World& world, Slot s, const Vec3& arm) {
  if (!world.is_movable(s)) return 0.0;
  return world.inverse_mass[s] + arm.squaredNorm() * world.inverse_inertia_of(s).sum() / 3.0;
}

/// 1/(I + m r^2) of a body that rolls about its contact point, I the harmonic mean of its moments; 0 when not free.
double rolling_mobility(const World& world, Slot s, const Vec3& arm) {
  if (!world.is_movable(s)) return 0.0;
  return 1.0 / (3.0 / world.inverse_inertia_of(s).sum() + arm.squaredNorm() / world.inverse_mass[s]);
}

/// 1/(1/I_a + 1/I_b), I as above.
double spin_inertia(const World& world, Slot a, Slot b) {
  double inverse = 0.0;
  for (const Slot s : {a, b})
    if (world.is_movable(s)) inverse += world.inverse_inertia_of(s).sum() / 3.0;
  return 1.0 / inverse;
}

/// Mean spin of the pair about the normal over the step [rad].
double twist(const World& world, Slot a, Slot b, const Vec3& n, double dt) {
  return 0.5 * dt * n.dot(world.angular_velocity[a] + world.angular_velocity[b]);
}

}  // namespace

SmoothSums& SmoothSums::operator+=(const SmoothSums& o) {
  touching += o.touching;
  elastic += o.elastic;
  spring_energy += o.spring_energy;
  spring_work += o.spring_work;
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

SmoothContact::SmoothContact(SmoothLaw law)
    : law_(std::move(law)),
      normal_(law_.normal()),
      rolling_at_(law_.state + law_.friction.memory),
      memory_(parts_of(law_)) {}

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
    memory_.advance(contacts, [this](double* record) {
      if (law_.needs.friction) law_.friction.exchange(record + law_.state);
      if (law_.rolls) exchange(*reinterpret_cast<Spring*>(record + rolling_at_));
    });
  EPAFI_REQUIRE(world.rotates() || !law_.needs.friction, "friction and rolling need a world with rotation");
  const SmoothSums sums =
      run({world, contacts, clock.dt, lag, world.rotates(), lag > 0.0 ? ratio_.next(clock.dt) : 1.0});
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
  visitor.share("smooth/step", ratio_.last);
  if (law_.needs.friction) visitor.share("smooth/spring_energy", before_.spring_energy);
  if (law_.remembers()) memory_.visit(visitor);
}

SmoothSums SmoothContact::run(const Call& call) {
  const std::size_t count = call.contacts.size();
  blocks_.resize((count + sum_block - 1) / sum_block);
  parallel_blocks(count, sum_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
    blocks_[block] = evaluate_block(call, begin, end);
  });
  SmoothSums total;
  for (const SmoothSums& s : blocks_) total += s;
  return total;
}

/// Flattened: GCC leaves vector helpers uninlined in a body of this size, which costs twice the time (perf/laws.cpp).
[[gnu::flatten]] SmoothSums SmoothContact::evaluate_block(const Call& call, std::size_t begin, std::size_t end) {
  SmoothSums sums;
  for (std::size_t i = begin; i < end; ++i)
    if (call.world.counts(call.contacts.a[i], call.contacts.b[i]))
      evaluate(call, i, sums);
    else
      evaluate_uncounted(call, i);
  return sums;
}

/// True if another process counts the contact.
[[gnu::noinline]] void SmoothContact::evaluate_uncounted(const Call& call, std::size_t i) {
  SmoothSums sums;
  evaluate(call, i, sums);
}

/// A contact that does not touch.
inline void SmoothContact::leave(const Call& call, std::size_t i) {
  call.contacts.force[i].setZero();
  if (law_.rolls) call.contacts.moment[i].setZero();
  if (law_.remembers()) memory_.forget(i);
}

inline void SmoothContact::evaluate(const Call& call, std::size_t i, SmoothSums& sums) {
  const World& world = call.world;
  ContactSet& contacts = call.contacts;
  const bool remembers = law_.remembers();
  Touch t;
  t.i = i;
  t.a = contacts.a[i];
  t.b = contacts.b[i];
  t.before = remembers ? memory_.before(i) : nullptr;
  t.now = remembers ? memory_.now(i) : nullptr;
  const double mobility = world.inverse_mass[t.a] + world.inverse_mass[t.b];  // 1/m*
  const bool touches = contacts.gap[i] < 0.0 || (law_.holds && law_.holds(t.before));
  if (!touches || mobility == 0.0) return leave(call, i);
  ++sums.touching;
  t.pair = world.material[t.a] * law_.materials + world.material[t.b];
  ContactKinematics at = move(call, t);
  at.overlap = -contacts.gap[i];
  at.effective_mass = 1.0 / mobility;
  at.effective_radius = t.radius =
      law_.contact.curvature ? contacts.effective_radius[i] : std::numeric_limits<double>::quiet_NaN();
  if (law_.contact.area) at.area = contacts.area[i];
  if (call.lag > 0.0) at.step = {call.dt, call.lag / at.effective_mass, call.before};

  const double* numbers = law_.numbers.data() + law_.per_pair * t.pair;
  const NormalResponse normal = normal_.one(numbers, at, t.before, t.now, law_.locates ? &call.dt : nullptr);
  sums.lost += normal.lost;
  sums.elastic += normal.energy;
  const DashpotLoss<double> loss = viscous_loss(at, normal, law_.state > 0);
  sums.viscous_power += loss.power;
  sums.late += loss.late;
  t.stiffness = normal.stiffness;
  t.grip = std::max(0.0, normal.force + normal.adhesion);

  Vec3 force = -normal.force * contacts.normal[i];
  if (law_.needs.friction) force += slide(call, t, sums);
  contacts.force[i] = force;
  if (law_.rolls) contacts.moment[i] = roll(call, t, sums);
  if (world.inverse_mass[t.a] * world.inverse_mass[t.b] == 0.0) drive(call, t, sums);
}

/// Relative velocity at the contact: its slip in the middle of the step, its approach at the end.
inline ContactKinematics SmoothContact::move(const Call& call, Touch& t) const {
  const World& world = call.world;
  const Vec3 &n = call.contacts.normal[t.i], &arm = call.contacts.arm[t.i];
  Vec3 velocity = world.velocity[t.b] - world.velocity[t.a];
  t.branch = world.branch(t.a, t.b, call.contacts.feature[t.i]);
  if (world.cell) velocity += world.cell->strain_rate.cwiseProduct(t.branch);
  if (call.rotates) {
    t.arm_b = arm - t.branch;
    velocity += world.angular_velocity[t.b].cross(t.arm_b) - world.angular_velocity[t.a].cross(arm);
  }
  const double opening = velocity.dot(n);
  t.slip_velocity = velocity - opening * n;
  ContactKinematics at;
  at.approach_velocity = at.middle_velocity = -opening;
  if (call.lag > 0.0) at.approach_velocity -= change_at(call, t).dot(n);
  return at;
}

/// Of the relative velocity at the contact, from the middle of the step to its end [m/s].
inline Vec3 SmoothContact::change_at(const Call& call, const Touch& t) const {
  Vec3 change = change_.linear[t.b] - change_.linear[t.a];
  if (call.rotates) change += change_.angular[t.b].cross(t.arm_b) - change_.angular[t.a].cross(call.contacts.arm[t.i]);
  return change;
}

/// Friction on A. The common spring in place: by pointer a contact takes twice as long.
inline Vec3 SmoothContact::slide(const Call& call, const Touch& t, SmoothSums& sums) const {
  if (!law_.friction.is_spring) return slide_by_pointer(call, t, sums);
  const Lanes& numbers = law_.rows[t.pair].tangential;
  const CoulombSpring::Parameters p{numbers[0], numbers[1], numbers[2]};
  const FrictionResponse out =
      CoulombSpring::pull(p, slip_step(call, t), *reinterpret_cast<const Spring*>(t.before + law_.state),
                          *reinterpret_cast<Spring*>(t.now + law_.state));
  sums.spring_energy += out.energy;
  sums.spring_work += out.work;
  return p.damping > 0.0 ? damp(call, t, p, out.load, sums) : out.load;
}

inline SlipStep SmoothContact::slip_step(const Call& call, const Touch& t) const {
  const Vec3& n = call.contacts.normal[t.i];
  return {n, twist(call.world, t.a, t.b, n, call.dt), call.dt * t.slip_velocity, t.stiffness, t.grip};
}

[[gnu::noinline]] Vec3 SmoothContact::slide_by_pointer(const Call& call, const Touch& t, SmoothSums& sums) const {
  const FrictionResponse out =
      law_.friction.pull(law_.rows[t.pair].tangential, slip_step(call, t), t.before + law_.state, t.now + law_.state);
  sums.spring_energy += out.energy;
  sums.spring_work += out.work;
  return out.load;
}

/// Friction on A by a spring that pulls with `elastic` and its dashpot: together they slide at mu N.
inline Vec3 SmoothContact::damp(const Call& call, const Touch& t, const CoulombSpring::Parameters& p,
                                const Vec3& elastic, SmoothSums& sums) const {
  const Vec3 &n = call.contacts.normal[t.i], &arm = call.contacts.arm[t.i];
  Vec3 velocity = t.slip_velocity;
  if (call.lag > 0.0) velocity += change_at(call, t);
  velocity -= velocity.dot(n) * n;
  const double mobility = slip_mobility(call.world, t.a, arm) + slip_mobility(call.world, t.b, t.arm_b);
  const double stiffness = CoulombSpring::stiffness(p, t.stiffness);
  const double dashpot = 2.0 * p.damping * std::sqrt(stiffness / mobility);
  const DamperStep<double> step{call.dt, call.lag * mobility};
  const Vec3 load =
      within(elastic + damper_force(step, dashpot, stiffness, velocity, t.slip_velocity), p.friction * t.grip);
  sums.viscous_power += (load - elastic).dot(velocity);
  return load;
}

/// Moment on A against rolling.
inline Vec3 SmoothContact::roll(const Call& call, const Touch& t, SmoothSums& sums) const {
  const World& world = call.world;
  const Vec3& n = call.contacts.normal[t.i];
  const Lanes& numbers = law_.rows[t.pair].rolling;
  const AnyRolling::Parameters p{law_.rolling, numbers[0], numbers[1]};
  const auto in_plane = [&n](const Vec3& x) { return Vec3(x - x.dot(n) * n); };
  const Vec3 middle = in_plane(world.angular_velocity[t.b] - world.angular_velocity[t.a]);
  Vec3 spin = middle;
  if (call.lag > 0.0) spin += in_plane(change_.angular[t.b] - change_.angular[t.a]);
  const double mobility = rolling_mobility(world, t.a, call.contacts.arm[t.i]) + rolling_mobility(world, t.b, t.arm_b);
  const RollingStep step{t.stiffness, t.grip, t.radius, 1.0 / mobility, spin_inertia(world, t.a, t.b),
                         spin.norm(), call.dt};
  const double limit = AnyRolling::limit(p, step), stiffness = AnyRolling::stiffness(p, step);
  const SlipStep turn{n, twist(world, t.a, t.b, n, call.dt), call.dt * middle, 0.0, 0.0};
  const FrictionResponse elastic =
      pull_spring(turn, stiffness, limit, *reinterpret_cast<const Spring*>(t.before + rolling_at_),
                  *reinterpret_cast<Spring*>(t.now + rolling_at_));
  sums.spring_energy += elastic.energy;
  sums.spring_work += elastic.work;
  const DamperStep<double> damper{call.dt, AnyRolling::stops_at_once(p) ? 0.0 : call.lag * mobility};
  const double dashpot = AnyRolling::damping(p, step);
  const Vec3 moment = within(elastic.load + damper_force(damper, dashpot, stiffness, spin, middle), limit);
  sums.viscous_power += (moment - elastic.load).dot(spin);
  return moment;
}

/// Power that fixed and driven bodies put into the contact: minus the force on them times the velocity there.
inline void SmoothContact::drive(const Call& call, const Touch& t, SmoothSums& sums) const {
  const World& world = call.world;
  const auto power = [&](Slot s, const Vec3& arm, double sign) {
    if (world.is_movable(s)) return 0.0;
    Vec3 velocity = world.velocity[s];
    double moment_power = 0.0;
    if (call.rotates) velocity += world.angular_velocity[s].cross(arm);
    if (law_.rolls) moment_power = call.contacts.moment[t.i].dot(world.angular_velocity[s]);
    return -sign * (call.contacts.force[t.i].dot(velocity) + moment_power);
  };
  sums.driven_power += power(t.a, call.contacts.arm[t.i], 1.0) + power(t.b, t.arm_b, -1.0);
}

void SmoothContact::record(const SmoothSums& now, const ContactSet& contacts, double dt, StepReport& report) {
  report.contacts = contacts.size();
  report.touching = now.touching;
  report.elastic = now.elastic + now.spring_energy;
  report.work = 0.5 * dt * (before_.driven_power + now.driven_power);
  Losses& lost = report.losses = {};
  if (dt > 0.0) {
    lost.viscous = 0.5 * dt * (before_.viscous_power + now.viscous_power) + now.late;
    lost.frictional = now.spring_work - (now.spring_energy - before_.spring_energy);
    if (!law_.holds) lost.plastic = now.lost;
  }
  if (law_.holds) lost.adhesive = now.lost;  // bodies in contact at the start begin to adhere there
  report.dissipated = lost.viscous + lost.frictional + lost.plastic + lost.adhesive;
  report.has_solver = false;
  before_ = now;
}

}  // namespace epafi
