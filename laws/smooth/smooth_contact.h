/// @file smooth_contact.h  The loop of smooth contact: forces of all contacts by the parts of one law, then sums by
/// body. Dampers see velocities at the time of the detection (StepClock::velocity_lag), predicted with the stored
/// acceleration; springs see the displacement over the step, velocity of its middle times dt. Both are second order
/// with velocity Verlet.
///
/// Energies (StepReport): viscous losses and work of driven bodies by the trapezoid of their power; losses of springs
/// (slip, rescaling, opening of the contact) as work done on them minus growth of their energy.
#pragma once
#include <cstring>

#include "engine/state/incidence.h"
#include "engine/step/pipeline.h"
#include "engine/threads/parallel.h"
#include "engine/units/error.h"
#include "laws/contact_law.h"
#include "laws/smooth/contact_edge.h"
#include "laws/smooth/spring.h"

namespace epafi {

/// Sums over contacts, of one block and of all.
struct SmoothSums {
  std::size_t touching = 0;
  double elastic = 0.0;        ///< of the normal parts [J]
  double spring_energy = 0.0;  ///< of the friction and rolling springs [J]
  double spring_work = 0.0;    ///< done on the springs during the step [J]
  double viscous_power = 0.0;  ///< lost in dampers now [W]
  double driven_power = 0.0;   ///< of driven bodies on the others now [W]
  double lost = 0.0;           ///< to plastic deformation and adhesion during the step [J]

  SmoothSums& operator+=(const SmoothSums& o) {
    touching += o.touching;
    elastic += o.elastic;
    spring_energy += o.spring_energy;
    spring_work += o.spring_work;
    viscous_power += o.viscous_power;
    driven_power += o.driven_power;
    lost += o.lost;
    return *this;
  }
};

/// Change of the velocities between the middle of the step and the detection, by slot.
struct VelocityChange {
  std::vector<Vec3> linear, angular;
  /// time: lag dt, by which the stored acceleration is taken; 0: not needed.
  void predict(const World& world, double time);
  /// Only of the bodies that have contacts, which are found here.
  void predict(const World& world, const ContactSet& contacts, TouchedBodies& touched, double time);

 private:
  void resize(const World& world) {
    linear.resize(world.size());
    angular.resize(world.rotates() ? world.size() : 0);
  }
  void of(const World& world, Slot body, double time);
};

/// What the parts remember of one contact; parts without memory take no room.
template <class NormalMemory, class Friction, class Rolling>
struct ContactHistory {
  [[no_unique_address]] NormalMemory normal{};
  [[no_unique_address]] Friction friction{};
  [[no_unique_address]] Rolling rolling{};
};
template <class N, class T, class R>
inline constexpr bool is_plain<ContactHistory<N, T, R>> = true;  // numbers and Eigen's vectors only

/// The same with bodies A and B exchanged; what belongs to the normal has no side.
template <class N, class T, class R>
void exchange(ContactHistory<N, T, R>& history) {
  if constexpr (requires { exchange(history.friction); }) exchange(history.friction);
  if constexpr (requires { exchange(history.rolling); }) exchange(history.rolling);
}

/// Records of all contacts, carried by contact key; the last step's beside this one's.
template <class Record>
class RecordMemory {
 public:
  void advance(const ContactSet& contacts) {
    turned_.clear();
    keys_.match(
        contacts, previous_, [&](std::size_t k) { return std::memcmp(&now_[k], &fresh_, sizeof(Record)) == 0; },
        &turned_);
    old_.swap(now_);
    for (const std::uint32_t i : turned_) exchange(old_[previous_[i]]);
    now_.resize(contacts.size());
  }
  /// Of contact i in the last step: an unloaded one where the contact is new.
  const Record& before(std::size_t i) const {
    return previous_[i] == ContactMemory::none ? fresh_ : old_[previous_[i]];
  }
  Record& now(std::size_t i) { return now_[i]; }
  const Record& fresh() const { return fresh_; }
  /// No time has passed: contacts that are not new go on with what they remembered.
  void keep() {
    for (std::size_t i = 0; i < now_.size(); ++i)
      if (previous_[i] != ContactMemory::none) now_[i] = old_[previous_[i]];
  }
  void reorder(const Reordering& change) {
    const auto order = keys_.reorder(change);
    std::vector<Record> sorted;
    sorted.reserve(order.size());
    for (std::uint32_t k : order) sorted.push_back(now_[k]);
    now_.swap(sorted);
  }
  void visit(StateVisitor& visitor) {
    keys_.visit(visitor, "smooth/contact");
    visitor.rows(RowsOf::contacts, "smooth/record", now_);
  }

 private:
  ContactMemory keys_;
  std::vector<std::uint32_t> previous_, turned_;
  std::vector<Record> old_, now_;
  Record fresh_{};
};

/// Force on A times branch, by axis [N m]: the virial of a periodic cell, whose bits depend on the contacts alone; of
/// several processes of those that this one counts.
Vec3 contact_virial(const World& world, const ContactSet& contacts);

template <NormalLaw Normal, TangentialLaw Tangential, RollingLaw Rolling>
class SmoothContact final : public ContactModel {
  static constexpr bool slides = Tangential::is_present, rolls = Rolling::is_present,
                        hysteretic = RemembersNormal<Normal>;
  static constexpr bool remembers = slides || rolls || hysteretic;
  using Record =
      ContactHistory<NormalState<Normal>, typename Tangential::Memory, std::conditional_t<rolls, Spring, Nothing<2>>>;

 public:
  static constexpr Needs needs = Normal::needs | Tangential::needs | Rolling::needs;
  struct PairParameters {
    typename Normal::Parameters normal{};
    typename Tangential::Parameters tangential{};
    typename Rolling::Parameters rolling{};
  };

  /// pairs: as MaterialTable::pairs; those that do not occur are not read.
  /// locate: start and end of a contact count for the part of the step that they take (laws/smooth/contact_edge.h).
  SmoothContact(std::size_t materials, std::vector<PairParameters> pairs, bool locate = false)
      : materials_(materials), pairs_(std::move(pairs)), damped_(rolls || locate), locate_(locate) {
    for (const PairParameters& p : pairs_) {
      damped_ = damped_ || Normal::is_damped(p.normal);
      if constexpr (WithDashpot<Tangential>) damped_ = damped_ || p.tangential.damping > 0.0;
    }
  }
  explicit SmoothContact(const MaterialTable& table) : SmoothContact(table.materials, parameters_of(table)) {}

  const char* name() const override { return "smooth"; }

  void act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) override {
    contacts.force.resize(contacts.size());
    contacts.with_moment = rolls;
    if (rolls) contacts.moment.resize(contacts.size());
    const double lag = damped_ ? clock.velocity_lag * clock.dt : 0.0;
    if (!clock.touched) incidence_.build(contacts, world.size());
    if (clock.touched || (lag > 0.0 && 4 * contacts.size() < world.size()))
      change_.predict(world, contacts, touched_, lag);
    else
      change_.predict(world, lag);
    if constexpr (remembers) memory_.advance(contacts);
    EPAFI_REQUIRE(world.rotates() || !(slides || rolls), "friction and rolling need a world with rotation");
    SmoothSums sums;
    if constexpr (slides || rolls)
      sums = run<true>(world, contacts, clock.dt, lag);
    else
      sums = world.rotates() ? run<true>(world, contacts, clock.dt, lag) : run<false>(world, contacts, clock.dt, lag);
    if constexpr (remembers)
      if (clock.dt == 0.0) memory_.keep();
    if (clock.touched)
      gather_forces(contacts, touched_, world, *clock.touched);
    else
      gather_forces(contacts, incidence_, world);
    record(sums, contacts, clock.dt, report);
    if (world.cell) {                          // the forces before the strain and after it act on its way
      const Vec3 before = world.cell->virial;  // of all contacts, those of spheres in their own loop too
      world.cell->virial = contact_virial(world, contacts);
      report.work += 0.5 * clock.dt * (before + world.cell->virial).dot(world.cell->strain_rate);
    }
  }

  void reorder(const Reordering& change) override {
    if constexpr (remembers) memory_.reorder(change);
  }

  void visit(StateVisitor& visitor) override {
    visitor.share("smooth/viscous_power", before_.viscous_power);
    visitor.share("smooth/driven_power", before_.driven_power);
    if constexpr (slides || rolls) visitor.share("smooth/spring_energy", before_.spring_energy);
    if constexpr (remembers) memory_.visit(visitor);
  }

 private:
  static std::vector<PairParameters> parameters_of(const MaterialTable& table) {
    std::vector<PairParameters> out(table.pairs.size());
    for (std::size_t i = 0; i < out.size(); ++i)
      if (const MaterialPair& pair = table.pairs[i]; pair.occurs)
        out[i] = {Normal::parameters(pair), Tangential::parameters(pair), Rolling::parameters(pair)};
    return out;
  }
  /// A contact that touches, as the parts below share it.
  struct Touch {
    std::size_t i;
    Slot a, b;
    Vec3 branch;         ///< from the centre of A to that of B [m]
    Vec3 arm_b;          ///< where the world rotates [m]
    Vec3 slip_velocity;  ///< of B against A at the contact, middle of the step, normal part taken out [m/s]
    ContactKinematics at;
    NormalResponse normal;
  };

  template <bool rotates>
  SmoothSums run(const World& world, ContactSet& contacts, double dt, double lag) {
    blocks_.resize((contacts.size() + sum_block - 1) / sum_block);
    parallel_blocks(contacts.size(), sum_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
      blocks_[block] = evaluate_block<rotates>(world, contacts, begin, end, dt, lag);
    });
    SmoothSums total;
    for (const SmoothSums& s : blocks_) total += s;
    return total;
  }

  /// Flattened: GCC leaves vector helpers uninlined in a body of this size, which costs twice the time (perf/laws.cpp).
  template <bool rotates>
  [[gnu::flatten]] SmoothSums evaluate_block(const World& world, ContactSet& contacts, std::size_t begin,
                                             std::size_t end, double dt, double lag) {
    SmoothSums sums;
    for (std::size_t i = begin; i < end; ++i)
      if (world.counts(contacts.a[i], contacts.b[i])) {
        evaluate<rotates>(world, contacts, i, dt, lag, sums);
      } else {
        SmoothSums counted_elsewhere;
        evaluate<rotates>(world, contacts, i, dt, lag, counted_elsewhere);
      }
    return sums;
  }

  template <bool rotates>
  void evaluate(const World& world, ContactSet& contacts, std::size_t i, double dt, double lag, SmoothSums& sums) {
    Touch t{i, contacts.a[i], contacts.b[i], Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), {}, {}};
    const double mobility = world.inverse_mass[t.a] + world.inverse_mass[t.b];  // 1/m*
    bool touches = contacts.gap[i] < 0.0;
    if constexpr (requires { Normal::holds(memory_.before(i).normal); })
      touches = touches || Normal::holds(memory_.before(i).normal);
    if (!touches || mobility == 0.0) {
      contacts.force[i].setZero();
      if constexpr (rolls) contacts.moment[i].setZero();
      if constexpr (remembers) memory_.now(i) = memory_.fresh();
      return;
    }
    ++sums.touching;
    t.at.overlap = -contacts.gap[i];
    t.at.effective_mass = 1.0 / mobility;
    t.at.effective_radius = needs.curvature ? contacts.effective_radius[i] : std::numeric_limits<double>::quiet_NaN();
    if constexpr (needs.area) t.at.area = contacts.area[i];
    move<rotates>(world, contacts, t, dt, lag);

    const PairParameters& p = pairs_[world.material[t.a] * materials_ + world.material[t.b]];
    if constexpr (hysteretic) {
      t.normal = Normal::respond(p.normal, t.at, memory_.before(i).normal, memory_.now(i).normal);
      sums.lost += t.normal.lost;
    } else {
      t.normal = Normal::respond(p.normal, t.at);
      if constexpr (PowerParts<Normal>)
        if (locate_) t.normal = weigh_edge<Normal>(p.normal, t.at, dt, t.normal);
    }
    sums.elastic += t.normal.energy;
    sums.viscous_power += viscous_loss<Normal>(t.at, t.normal);

    Vec3 force = -t.normal.force * contacts.normal[i];
    if constexpr (slides) force += slide(world, contacts, t, p.tangential, dt, lag, sums);
    contacts.force[i] = force;
    if constexpr (rolls) contacts.moment[i] = roll(world, contacts, t, p.rolling, dt, lag, sums);
    if (world.inverse_mass[t.a] * world.inverse_mass[t.b] == 0.0) drive<rotates>(world, contacts, t, sums);
  }

  /// Relative velocity at the contact: its slip in the middle of the step, its approach at the end.
  template <bool rotates>
  void move(const World& world, const ContactSet& contacts, Touch& t, double dt, double lag) const {
    const Vec3 &n = contacts.normal[t.i], &arm = contacts.arm[t.i];
    Vec3 velocity = world.velocity[t.b] - world.velocity[t.a];
    t.branch = world.branch(t.a, t.b, contacts.feature[t.i]);
    if (world.cell) velocity += world.cell->strain_rate.cwiseProduct(t.branch);
    if constexpr (rotates) {
      t.arm_b = arm - t.branch;
      velocity += world.angular_velocity[t.b].cross(t.arm_b) - world.angular_velocity[t.a].cross(arm);
    }
    const double opening = velocity.dot(n);
    if constexpr (slides) t.slip_velocity = velocity - opening * n;
    t.at.approach_velocity = -opening;
    t.at.middle_velocity = -opening;
    if (!(lag > 0.0)) return;
    t.at.approach_velocity -= change_at<rotates>(t, arm).dot(n);
    t.at.step = {dt, lag / t.at.effective_mass};
  }

  /// Of the relative velocity at the contact, from the middle of the step to its end [m/s].
  template <bool rotates>
  Vec3 change_at(const Touch& t, const Vec3& arm) const {
    Vec3 change = change_.linear[t.b] - change_.linear[t.a];
    if constexpr (rotates) change += change_.angular[t.b].cross(t.arm_b) - change_.angular[t.a].cross(arm);
    return change;
  }

  /// Friction on A.
  Vec3 slide(const World& world, const ContactSet& contacts, const Touch& t, const typename Tangential::Parameters& p,
             double dt, double lag, SmoothSums& sums) {
    const Vec3& n = contacts.normal[t.i];
    const SlipStep step{n, twist(world, t, n, dt), dt * t.slip_velocity, t.normal.stiffness,
                        std::max(0.0, t.normal.force + t.normal.adhesion)};
    const FrictionResponse out = Tangential::pull(p, step, memory_.before(t.i).friction, memory_.now(t.i).friction);
    sums.spring_energy += out.energy;
    sums.spring_work += out.work;
    if constexpr (WithDashpot<Tangential>)
      if (p.damping > 0.0) return damp(world, contacts, t, p, out.load, dt, lag, sums);
    return out.load;
  }

  /// Friction on A by a spring that pulls with `elastic` and its dashpot: together they slide at mu N.
  Vec3 damp(const World& world, const ContactSet& contacts, const Touch& t, const typename Tangential::Parameters& p,
            const Vec3& elastic, double dt, double lag, SmoothSums& sums) const {
    const Vec3 &n = contacts.normal[t.i], &arm = contacts.arm[t.i];
    Vec3 velocity = t.slip_velocity;
    if (lag > 0.0) velocity += change_at<true>(t, arm);
    velocity -= velocity.dot(n) * n;
    const double mobility = slip_mobility(world, t.a, arm) + slip_mobility(world, t.b, t.arm_b);
    const double stiffness = Tangential::stiffness(p, t.normal.stiffness);
    const double dashpot = 2.0 * p.damping * std::sqrt(stiffness / mobility);
    const double limit = p.friction * std::max(0.0, t.normal.force + t.normal.adhesion);
    const DamperStep<double> step{dt, lag * mobility};
    const Vec3 load = within(elastic + damper_force(step, dashpot, stiffness, velocity, t.slip_velocity), limit);
    sums.viscous_power += (load - elastic).dot(velocity);
    return load;
  }

  /// 1/m + r^2/I of a body pushed sideways at its contact point, I the harmonic mean of its moments; 0 when not free.
  static double slip_mobility(const World& world, Slot s, const Vec3& arm) {
    if (!world.is_movable(s)) return 0.0;
    return world.inverse_mass[s] + arm.squaredNorm() * world.inverse_inertia_of(s).sum() / 3.0;
  }

  /// Moment on A against rolling.
  Vec3 roll(const World& world, const ContactSet& contacts, const Touch& t, const typename Rolling::Parameters& p,
            double dt, double lag, SmoothSums& sums) {
    const Vec3& n = contacts.normal[t.i];
    const auto in_plane = [&n](const Vec3& x) { return Vec3(x - x.dot(n) * n); };
    const Vec3 middle = in_plane(world.angular_velocity[t.b] - world.angular_velocity[t.a]);
    Vec3 spin = middle;
    if (lag > 0.0) spin += in_plane(change_.angular[t.b] - change_.angular[t.a]);
    const double mobility = rolling_mobility(world, t.a, contacts.arm[t.i]) + rolling_mobility(world, t.b, t.arm_b);
    const RollingStep step{t.normal.stiffness,
                           std::max(0.0, t.normal.force + t.normal.adhesion),
                           t.at.effective_radius,
                           1.0 / mobility,
                           spin_inertia(world, t),
                           spin.norm(),
                           dt};
    const double limit = Rolling::limit(p, step);
    const SlipStep turn{n, twist(world, t, n, dt), dt * middle, 0.0, 0.0};
    const FrictionResponse elastic =
        pull_spring(turn, Rolling::stiffness(p, step), limit, memory_.before(t.i).rolling, memory_.now(t.i).rolling);
    sums.spring_energy += elastic.energy;
    sums.spring_work += elastic.work;
    const DamperStep<double> damper{dt, Rolling::stops_at_once(p) ? 0.0 : lag * mobility};
    const double stiffness = Rolling::stiffness(p, step), dashpot = Rolling::damping(p, step);
    const Vec3 moment = within(elastic.load + damper_force(damper, dashpot, stiffness, spin, middle), limit);
    sums.viscous_power += (moment - elastic.load).dot(spin);
    return moment;
  }

  /// Mean spin of the pair about the normal over the step [rad].
  static double twist(const World& world, const Touch& t, const Vec3& n, double dt) {
    return 0.5 * dt * n.dot(world.angular_velocity[t.a] + world.angular_velocity[t.b]);
  }

  /// 1/(I + m r^2) of a body that rolls about its contact point, I the harmonic mean of its moments; 0 when not free.
  static double rolling_mobility(const World& world, Slot s, const Vec3& arm) {
    if (!world.is_movable(s)) return 0.0;
    return 1.0 / (3.0 / world.inverse_inertia_of(s).sum() + arm.squaredNorm() / world.inverse_mass[s]);
  }

  /// 1/(1/I_a + 1/I_b), I as above.
  static double spin_inertia(const World& world, const Touch& t) {
    double inverse = 0.0;
    for (const Slot s : {t.a, t.b})
      if (world.is_movable(s)) inverse += world.inverse_inertia_of(s).sum() / 3.0;
    return 1.0 / inverse;
  }

  /// Power that fixed and driven bodies put into the contact: minus the force on them times the velocity there.
  template <bool rotates>
  static void drive(const World& world, const ContactSet& contacts, const Touch& t, SmoothSums& sums) {
    const auto power = [&](Slot s, const Vec3& arm, double sign) {
      if (world.is_movable(s)) return 0.0;
      Vec3 velocity = world.velocity[s];
      double moment_power = 0.0;
      if constexpr (rotates) velocity += world.angular_velocity[s].cross(arm);
      if constexpr (rolls) moment_power = contacts.moment[t.i].dot(world.angular_velocity[s]);
      return -sign * (contacts.force[t.i].dot(velocity) + moment_power);
    };
    sums.driven_power += power(t.a, contacts.arm[t.i], 1.0) + power(t.b, t.arm_b, -1.0);
  }

  void record(const SmoothSums& now, const ContactSet& contacts, double dt, StepReport& report) {
    report.contacts = contacts.size();
    report.touching = now.touching;
    report.elastic = now.elastic + now.spring_energy;
    report.work = 0.5 * dt * (before_.driven_power + now.driven_power);
    Losses& lost = report.losses = {};
    constexpr bool holds_on = requires { &Normal::holds; };
    if (dt > 0.0) {
      lost.viscous = 0.5 * dt * (before_.viscous_power + now.viscous_power);
      lost.frictional = now.spring_work - (now.spring_energy - before_.spring_energy);
      if (!holds_on) lost.plastic = now.lost;
    }
    if (holds_on) lost.adhesive = now.lost;  // bodies that touch at the start meet there
    report.dissipated = lost.viscous + lost.frictional + lost.plastic + lost.adhesive;
    report.has_solver = false;
    before_ = now;
  }

  std::size_t materials_;
  std::vector<PairParameters> pairs_;
  bool damped_;  ///< velocities at the time of the detection are wanted
  bool locate_;
  VelocityChange change_;
  RecordMemory<Record> memory_;
  Incidence incidence_;
  TouchedBodies touched_;  ///< where they are few
  std::vector<SmoothSums> blocks_;
  SmoothSums before_;  ///< of the last call
};

}  // namespace epafi
