/// @file smooth_contact.h  The loop of smooth contact: forces of all contacts by the parts of one law, then sums by body.
/// Dampers see velocities at the time of the detection (StepClock::velocity_lag), predicted with the stored acceleration;
/// springs see the displacement over the step, velocity of its middle times dt. Both are second order with velocity Verlet.
///
/// Energies (StepReport): viscous losses and work of driven bodies by the trapezoid of their power; losses of springs
/// (slip, rescaling, opening of the contact) as work done on them minus growth of their energy.
#pragma once
#include "engine/error.h"
#include "engine/incidence.h"
#include "engine/parallel.h"
#include "engine/pipeline.h"
#include "laws/contact_law.h"
#include "laws/smooth/spring.h"

namespace epafi {

/// Sums over contacts, of one block and of all.
struct SmoothSums {
  std::size_t touching = 0;
  double elastic = 0.0;       ///< of the normal parts [J]
  double spring_energy = 0.0; ///< of the friction and rolling springs [J]
  double spring_work = 0.0;   ///< done on the springs during the step [J]
  double viscous_power = 0.0; ///< lost in dampers now [W]
  double driven_power = 0.0;  ///< of driven bodies on the others now [W]

  SmoothSums& operator+=(const SmoothSums& o) {
    touching += o.touching, elastic += o.elastic, spring_energy += o.spring_energy, spring_work += o.spring_work;
    viscous_power += o.viscous_power, driven_power += o.driven_power;
    return *this;
  }
};

/// Change of the velocities between the middle of the step and the detection, by slot.
struct VelocityChange {
  std::vector<Vec3> linear, angular;
  /// lag dt times the stored acceleration.
  void predict(const World& world, double time);
};

/// Springs of all contacts, carried by contact key; the last step's beside this one's.
class SpringMemory {
 public:
  void advance(const ContactSet& contacts, std::size_t springs_per_contact);
  /// Spring k of contact i in the last step: an unloaded one where the contact is new.
  Spring before(std::size_t i, std::size_t k) const {
    return previous_[i] == ContactMemory::none ? Spring{} : old_[previous_[i] * per_contact_ + k];
  }
  Spring& now(std::size_t i, std::size_t k) { return now_[i * per_contact_ + k]; }
  double energy() const;
  void reorder(const Reordering& change);
  void visit(StateVisitor& visitor);

 private:
  ContactMemory keys_;
  std::vector<std::uint32_t> previous_;
  std::vector<Spring> old_, now_;
  std::size_t per_contact_ = 1;
};

template <NormalLaw Normal, TangentialLaw Tangential, RollingLaw Rolling>
class SmoothContact final : public ContactModel {
  static constexpr bool slides = Tangential::is_present, rolls = Rolling::is_present;
  static constexpr std::size_t springs = (slides ? 1u : 0u) + (rolls ? 1u : 0u);

 public:
  static constexpr Needs needs = Normal::needs | Tangential::needs | Rolling::needs;

  explicit SmoothContact(const MaterialTable& table) : materials_(table.materials), damped_(rolls) {
    for (const MaterialPair& pair : table.pairs) {
      pairs_.emplace_back();
      if (!pair.occurs) continue;
      pairs_.back() = {Normal::parameters(pair), Tangential::parameters(pair), Rolling::parameters(pair)};
      damped_ = damped_ || Normal::is_damped(pairs_.back().normal);
    }
  }

  const char* name() const override { return "smooth"; }

  void act(World& world, ContactSet& contacts, const StepClock& clock, StepReport& report) override {
    contacts.force.resize(contacts.size());
    contacts.with_moment = rolls;
    if (rolls) contacts.moment.resize(contacts.size());
    const double lag = damped_ ? clock.velocity_lag * clock.dt : 0.0;
    if (lag > 0.0) change_.predict(world, lag);
    if constexpr (springs > 0) memory_.advance(contacts, springs);
    EPAFI_REQUIRE(world.rotates() || springs == 0, "friction and rolling need a world with rotation");
    const SmoothSums sums = world.rotates() ? run<true>(world, contacts, clock.dt, lag > 0.0)
                                            : run<(springs > 0)>(world, contacts, clock.dt, lag > 0.0);
    incidence_.build(contacts, world.size());
    gather_forces(contacts, incidence_, world);
    record(sums, contacts, clock.dt, report);
  }

  void reorder(const Reordering& change) override {
    if constexpr (springs == 0) return;
    memory_.reorder(change);
    before_.spring_energy = memory_.energy();  // springs of removed bodies left with them
  }

  void visit(StateVisitor& visitor) override {
    visitor.value("smooth/viscous_power", before_.viscous_power);
    visitor.value("smooth/driven_power", before_.driven_power);
    if constexpr (springs > 0) {
      visitor.value("smooth/spring_energy", before_.spring_energy);
      memory_.visit(visitor);
    }
  }

 private:
  struct PairParameters {
    typename Normal::Parameters normal{};
    typename Tangential::Parameters tangential{};
    typename Rolling::Parameters rolling{};
  };
  /// A contact that touches, as the parts below share it.
  struct Touch {
    std::size_t i;
    Slot a, b;
    Vec3 arm_b;          ///< where the world rotates [m]
    Vec3 slip_velocity;  ///< of B against A at the contact, middle of the step, normal part taken out [m/s]
    ContactKinematics at;
    NormalResponse normal;
  };

  template <bool rotates>
  SmoothSums run(const World& world, ContactSet& contacts, double dt, bool predicted) {
    blocks_.resize((contacts.size() + sum_block - 1) / sum_block);
    parallel_blocks(contacts.size(), sum_block, [&](std::size_t begin, std::size_t end, std::size_t block) {
      blocks_[block] = evaluate_block<rotates>(world, contacts, begin, end, dt, predicted);
    });
    SmoothSums total;
    for (const SmoothSums& s : blocks_) total += s;
    return total;
  }

  /// Flattened: GCC leaves vector helpers uninlined in a body of this size, which costs twice the time (perf/laws.cpp).
  template <bool rotates>
  [[gnu::flatten]] SmoothSums evaluate_block(const World& world, ContactSet& contacts, std::size_t begin, std::size_t end,
                                             double dt, bool predicted) {
    SmoothSums sums;
    for (std::size_t i = begin; i < end; ++i) evaluate<rotates>(world, contacts, i, dt, predicted, sums);
    return sums;
  }

  template <bool rotates>
  void evaluate(const World& world, ContactSet& contacts, std::size_t i, double dt, bool predicted, SmoothSums& sums) {
    Touch t{i, contacts.a[i], contacts.b[i], Vec3::Zero(), Vec3::Zero(), {}, {}};
    const double mobility = world.inverse_mass[t.a] + world.inverse_mass[t.b];  // 1/m*
    if (!(contacts.gap[i] < 0.0) || mobility == 0.0) {
      contacts.force[i].setZero();
      if constexpr (rolls) contacts.moment[i].setZero();
      if constexpr (springs > 0)
        for (std::size_t k = 0; k < springs; ++k) memory_.now(i, k) = {};
      return;
    }
    ++sums.touching;
    t.at.overlap = -contacts.gap[i];
    t.at.effective_mass = 1.0 / mobility;
    t.at.effective_radius = needs.curvature ? contacts.effective_radius[i] : std::numeric_limits<double>::quiet_NaN();
    if constexpr (needs.area) t.at.area = contacts.area[i];
    move<rotates>(world, contacts, t, predicted);

    const PairParameters& p = pairs_[world.material[t.a] * materials_ + world.material[t.b]];
    t.normal = Normal::respond(p.normal, t.at);
    sums.elastic += t.normal.energy;
    sums.viscous_power += (t.normal.force - t.normal.elastic_force) * t.at.approach_velocity;

    Vec3 force = -t.normal.force * contacts.normal[i];
    if constexpr (slides) force += slide(world, contacts, t, p.tangential, dt, sums);
    contacts.force[i] = force;
    if constexpr (rolls) contacts.moment[i] = roll(world, contacts, t, p.rolling, dt, predicted, sums);
    if (world.inverse_mass[t.a] * world.inverse_mass[t.b] == 0.0) drive<rotates>(world, contacts, t, sums);
  }

  /// Relative velocity at the contact: its slip in the middle of the step, its approach at the end.
  template <bool rotates>
  void move(const World& world, const ContactSet& contacts, Touch& t, bool predicted) const {
    const Vec3 &n = contacts.normal[t.i], &arm = contacts.arm[t.i];
    Vec3 velocity = world.velocity[t.b] - world.velocity[t.a];
    if constexpr (rotates) {
      t.arm_b = arm + (world.position[t.a] - world.position[t.b]);
      velocity += world.angular_velocity[t.b].cross(t.arm_b) - world.angular_velocity[t.a].cross(arm);
    }
    const double opening = velocity.dot(n);
    if constexpr (slides) t.slip_velocity = velocity - opening * n;
    t.at.approach_velocity = -opening;
    if (!predicted) return;
    Vec3 change = change_.linear[t.b] - change_.linear[t.a];
    if constexpr (rotates) change += change_.angular[t.b].cross(t.arm_b) - change_.angular[t.a].cross(arm);
    t.at.approach_velocity -= change.dot(n);
  }

  /// Friction on A.
  Vec3 slide(const World& world, const ContactSet& contacts, const Touch& t, const typename Tangential::Parameters& p,
             double dt, SmoothSums& sums) {
    const Vec3& n = contacts.normal[t.i];
    const Vec3 displacement = dt * t.slip_velocity;
    return pull(t, 0, n, twist(world, t, n, dt), Tangential::stiffness(p, t.normal.stiffness), displacement,
                Tangential::friction(p) * t.normal.force, sums);
  }

  /// Moment on A against rolling.
  Vec3 roll(const World& world, const ContactSet& contacts, const Touch& t, const typename Rolling::Parameters& p, double dt,
            bool predicted, SmoothSums& sums) {
    const Vec3& n = contacts.normal[t.i];
    const auto in_plane = [&n](const Vec3& x) { return Vec3(x - x.dot(n) * n); };
    Vec3 spin = world.angular_velocity[t.b] - world.angular_velocity[t.a];
    const double stiffness = Rolling::stiffness(p, t.normal.stiffness, t.at.effective_radius);
    const double limit = Rolling::limit(p, t.normal.force, t.at.effective_radius);
    const Vec3 elastic = pull(t, springs - 1, n, twist(world, t, n, dt), stiffness, dt * in_plane(spin), limit, sums);
    if (predicted) spin += change_.angular[t.b] - change_.angular[t.a];
    spin = in_plane(spin);
    const double mobility = rolling_mobility(world, t.a, contacts.arm[t.i]) + rolling_mobility(world, t.b, t.arm_b);
    Vec3 moment = elastic + Rolling::damping(p, stiffness, 1.0 / mobility) * spin;
    const double square = moment.squaredNorm();
    if (square > limit * limit) moment *= limit / std::sqrt(square);
    sums.viscous_power += (moment - elastic).dot(spin);  // >= 0: moment is the nearest point of a ball that holds elastic
    return moment;
  }

  /// Moves spring k of the contact on; its load on A. In a call without time (dt = 0) the spring stays as it is.
  Vec3 pull(const Touch& t, std::size_t k, const Vec3& n, double twist_angle, double stiffness, const Vec3& displacement,
            double limit, SmoothSums& sums) {
    const Spring old = memory_.before(t.i, k);
    const Vec3 load = turn_load(old.load, n, twist_angle);
    const Spring now = extend(old, load, stiffness, displacement, limit);
    memory_.now(t.i, k) = now;
    sums.spring_energy += now.energy();
    sums.spring_work += 0.5 * (load + now.load).dot(displacement);
    return now.load;
  }

  /// Mean spin of the pair about the normal over the step [rad].
  static double twist(const World& world, const Touch& t, const Vec3& n, double dt) {
    return 0.5 * dt * n.dot(world.angular_velocity[t.a] + world.angular_velocity[t.b]);
  }

  /// 1/(I + m r^2) of a body that rolls about its contact point, I the harmonic mean of its moments; 0 when not free.
  static double rolling_mobility(const World& world, Slot s, const Vec3& arm) {
    if (!world.is_movable(s)) return 0.0;
    return 1.0 / (3.0 / world.inverse_inertia[s].sum() + arm.squaredNorm() / world.inverse_mass[s]);
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
    report.dissipated = 0.0;
    if (dt > 0.0)
      report.dissipated = 0.5 * dt * (before_.viscous_power + now.viscous_power) +
                          (now.spring_work - (now.spring_energy - before_.spring_energy));
    report.has_solver = false;
    before_ = now;
  }

  std::size_t materials_;
  std::vector<PairParameters> pairs_;  ///< as MaterialTable::pairs
  bool damped_;                        ///< some pair has a damper
  VelocityChange change_;
  SpringMemory memory_;
  Incidence incidence_;
  std::vector<SmoothSums> blocks_;
  SmoothSums before_;                  ///< of the last call
};

}  // namespace epafi
