// Contacts of any shapes go through the passes of a law in tiles: every one has the bits that it has alone, whatever
// the lanes and its neighbours in the tile, and the forces of the law's formulas for one contact.
#include <cmath>

#include "engine/lanes/targets.h"
#include "engine/units/random.h"
#include "laws/smooth/choose_law.h"
#include "laws/smooth/smooth_contact.h"
#include "laws/smooth/spring.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

constexpr double dt = 1e-5;

Vec3 draw(Random& random) { return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}; }

/// Three materials; of their pairs one has no friction, one no rolling friction, one neither damping.
SmoothSetup setup_of_parts(const std::string& normal, const std::string& tangential, const std::string& rolling) {
  SmoothSetup setup;
  setup.law = normal;
  setup.tangential = tangential;
  setup.rolling = rolling;
  setup.materials = {3, std::vector<MaterialPair>(9)};
  for (std::size_t i = 0; i < 9; ++i) {
    const std::size_t sum = i / 3 + i % 3;  // symmetric
    MaterialPair& pair = setup.materials.pairs[i];
    pair.a.youngs_modulus = 5e6 * static_cast<double>(1 + sum);
    pair.a.poissons_ratio = 0.3;
    pair.b = pair.a;
    pair.restitution = sum == 4 ? 1.0 : 0.3 + 0.1 * static_cast<double>(sum);
    pair.friction = sum == 1 ? 0.0 : 0.1 * static_cast<double>(sum + 1);
    pair.rolling_friction = sum == 2 ? 0.0 : 0.05;
    pair.parameters.set("stiffness", 1e4 * static_cast<double>(1 + sum));
    pair.parameters.set("exponent", 1.0 + 0.4 * static_cast<double>(sum));
    pair.parameters.set("reference_speed", 1.0);
    pair.parameters.set("relaxation_time", 1e-5);
    pair.parameters.set("work_of_adhesion", 0.5 * static_cast<double>(sum));
  }
  return setup;
}

/// Pairs of bodies without a shape, and a contact each: what detection tells of it is drawn anew every step.
struct Contacts {
  World world{Columns{.rotation = true, .anisotropy = true}};
  ContactSet set;

  Contacts(std::size_t n, Random& random) {
    world.gravity = {0, 0, -9.81};
    for (std::size_t k = 0; k < 2 * n; ++k) {
      Body body;
      const bool free = k % 2 == 0 || random.uniform() < 0.8;
      body.mass = free ? random.uniform(1e-4, 1e-2) : 0.0;
      const Vec3 moments(random.uniform(1, 1.5), random.uniform(1, 1.5), random.uniform(1, 1.5));
      body.inertia = 1e-5 * body.mass * moments;
      body.position = 0.01 * draw(random);
      body.orientation = turned(Quat(1, 0, 0, 0), draw(random));
      body.velocity = draw(random);
      body.angular_velocity = 30.0 * draw(random);
      body.material = static_cast<std::uint16_t>(random.bits() % 3);
      world.add(body);
    }
    set.with_curvature = set.with_area = true;
  }
  /// The same contacts a step later; a few open, begin or part within the reach of adhesion.
  void redraw(Random& random) {
    const std::size_t n = world.size() / 2;
    const ContactSet last = set;
    set.clear();
    set.with_curvature = set.with_area = true;
    for (std::size_t k = 0; k < n; ++k) {
      ContactPoint c;
      c.gap = random.uniform() < 0.8 ? -random.uniform(1e-7, 3e-4) : random.uniform(0, 2e-5);
      c.normal = last.size() > 0 ? Vec3(last.normal[k] + 0.01 * draw(random)).normalized() : draw(random).normalized();
      c.arm = last.size() > 0 ? Vec3(last.arm[k] + 1e-5 * draw(random)) : Vec3(5e-3 * draw(random));
      c.effective_radius = random.uniform(1e-3, 5e-3);
      c.area = random.uniform(1e-7, 1e-5);
      set.append(static_cast<Slot>(2 * k), static_cast<Slot>(2 * k + 1), c);
    }
    for (Slot s = 0; s < world.size(); ++s) {
      world.force[s] = 0.1 * draw(random);
      world.torque[s] = 1e-4 * draw(random);
    }
  }
  ContactSet only(std::size_t k) const {
    ContactSet one;
    one.with_curvature = one.with_area = true;
    one.append(set.a[k], set.b[k], {set.gap[k], set.normal[k], set.arm[k], set.effective_radius[k], 0, set.area[k]});
    return one;
  }
};

/// The formulas for one contact: laws/smooth/spring.h, dashpot.h and rolling.h, in the order of their texts.
struct OneContact {
  std::vector<double> normal;
  std::vector<double> friction;
  Spring rolling;
  Vec3 force, moment = Vec3::Zero();

  explicit OneContact(const SmoothLaw& law) : normal(law.state + 1), friction(law.friction.memory) {}

  /// Velocities in the middle of the step and at its end, of B against A.
  struct Motion {
    Vec3 middle, late, spin, late_spin, both_spins;
    double inverse_mass = 0.0, slip_mobility = 0.0, rolling_mobility = 0.0, inverse_inertia = 0.0;
  };
  static Motion motion(const World& w, const ContactSet& set, std::size_t k, double lag) {
    Motion m;
    m.middle = m.late = m.spin = m.late_spin = m.both_spins = Vec3::Zero();
    for (const double sign : {-1.0, 1.0}) {
      const Slot s = sign < 0.0 ? set.a[k] : set.b[k];
      const Vec3 arm = sign < 0.0 ? set.arm[k] : set.arm_b(k, w);
      const double inertia = w.inverse_inertia_of(s).sum() / 3.0,
                   slips = w.inverse_mass[s] + arm.squaredNorm() * inertia;
      const Vec3 turns = w.is_movable(s) ? Vec3(lag * w.apply_inverse_inertia(s, w.torque[s])) : Vec3(0, 0, 0);
      const Vec3 change = lag * w.acceleration(s) + turns.cross(arm);
      const Vec3 velocity = w.velocity[s] + Vec3(w.angular_velocity[s].cross(arm));
      m.middle += sign * velocity;
      m.late += sign * (velocity + change);
      m.spin += sign * w.angular_velocity[s];
      m.late_spin += sign * (w.angular_velocity[s] + turns);
      m.both_spins += w.angular_velocity[s];
      m.inverse_mass += w.inverse_mass[s];
      m.slip_mobility += slips;
      m.inverse_inertia += inertia;
      if (slips > 0.0) m.rolling_mobility += inertia * w.inverse_mass[s] / slips;
    }
    return m;
  }

  void act(const SmoothLaw& law, const World& w, const ContactSet& set, std::size_t k) {
    force = moment = Vec3::Zero();
    if (!(set.gap[k] < 0.0 || (law.holds && law.holds(normal.data())))) {
      *this = OneContact(law);
      force = Vec3::Zero();
      return;
    }
    const double lag = law.damped ? 0.5 * dt : 0.0;
    const Vec3 n = set.normal[k];
    const auto in_plane = [&](const Vec3& x) { return Vec3(x - n.dot(x) * n); };
    const Motion m = motion(w, set, k, lag);
    ContactKinematics at{-set.gap[k], -m.late.dot(n), 1.0 / m.inverse_mass, set.effective_radius[k], set.area[k]};
    at.middle_velocity = -m.middle.dot(n);
    at.step = {dt, lag * m.inverse_mass};
    const std::size_t pair = law.materials * w.material[set.a[k]] + w.material[set.b[k]];
    std::vector<double> next(normal.size());
    const NormalResponse r = law.normal().one(law.numbers.data() + law.per_pair * pair, at, normal.data(), next.data(),
                                              law.locates ? &dt : nullptr);
    normal = next;
    force = -r.force * n;
    if (!law.needs.friction) return;
    const double grip = std::max(0.0, r.force + r.adhesion);
    const SlipStep slip{n, 0.5 * dt * n.dot(m.both_spins), dt * in_plane(m.middle), r.stiffness, grip};
    force += damped_friction(law, pair, slip, m, in_plane(m.late), lag);
    if (law.rolls) resist_rolling(law, pair, slip, m, at.effective_radius, lag);
  }

 private:
  Vec3 damped_friction(const SmoothLaw& law, std::size_t pair, const SlipStep& slip, const Motion& m, const Vec3& late,
                       double lag) {
    const Lanes& p = law.rows[pair].tangential;
    if (!law.friction.is_spring) {
      std::vector<double> next(friction.size());
      const Vec3 load = law.friction.pull(p, slip, friction.data(), next.data()).load;
      friction = next;
      return load;
    }
    const double stiffness = p[1] * slip.normal_stiffness, limit = p[0] * slip.normal_force;
    auto& spring = *reinterpret_cast<Spring*>(friction.data());
    const Spring before = spring;
    const Vec3 load = pull_spring(slip, stiffness, limit, before, spring).load;
    if (!law.needs.dashpots) return load;
    const double dashpot = 2.0 * p[2] * std::sqrt(stiffness / m.slip_mobility);
    const DamperStep<double> step{dt, lag * m.slip_mobility};
    return within(load + damper_force(step, dashpot, stiffness, late, Vec3(slip.displacement / dt)), limit);
  }
  void resist_rolling(const SmoothLaw& law, std::size_t pair, const SlipStep& slip, const Motion& m, double radius,
                      double lag) {
    const auto in_plane = [&](const Vec3& x) { return Vec3(x - slip.normal.dot(x) * slip.normal); };
    const Lanes& p = law.rows[pair].rolling;
    const AnyRolling::Parameters parameters{law.rolling, p[0], p[1]};
    const Vec3 turning = in_plane(m.spin), late = in_plane(m.late_spin);
    const double inertia = 1.0 / m.rolling_mobility;
    const RollingStep step{slip.normal_stiffness,   slip.normal_force, radius, inertia,
                           1.0 / m.inverse_inertia, late.norm(),       dt};
    const double stiffness = AnyRolling::stiffness(parameters, step), limit = AnyRolling::limit(parameters, step);
    SlipStep turn = slip;
    turn.displacement = dt * turning;
    const Spring before = rolling;
    const Vec3 load = pull_spring(turn, stiffness, limit, before, rolling).load;
    const DamperStep<double> half{dt, law.rolling == AnyRolling::Type::constant ? 0.0 : lag / inertia};
    moment = within(load + damper_force(half, AnyRolling::damping(parameters, step), stiffness, late, turning), limit);
  }
};

/// Three steps of n random contacts: all in one model, each in a model of its own, and each by the formulas.
void compare(const SmoothSetup& setup, std::size_t n, std::uint64_t seed) {
  Random random(seed, n);
  Contacts all(n, random);
  const SmoothLaw law = smooth_law(setup);
  SmoothContact together(law);
  std::vector<SmoothContact> alone;
  for (std::size_t k = 0; k < n; ++k) alone.emplace_back(law);
  std::vector<OneContact> formulas(n, OneContact(law));
  for (int step = 0; step < 3; ++step) {
    all.redraw(random);
    const std::vector<Vec3> force = all.world.force, torque = all.world.torque;
    const auto act = [&](SmoothContact& model, ContactSet& contacts) {
      all.world.force = force;
      all.world.torque = torque;
      StepReport report;
      model.act(all.world, contacts, {dt, 0.5}, report);
      return report;
    };
    const StepReport report = act(together, all.set);
    double elastic = 0.0, dissipated = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
      ContactSet one = all.only(k);
      const StepReport of_one = act(alone[k], one);
      elastic += of_one.elastic;
      dissipated += of_one.dissipated;
      all.world.force = force;
      all.world.torque = torque;
      formulas[k].act(law, all.world, all.set, k);
      INFO("contact " << k << " of " << n << ", step " << step);
      CHECK(all.set.force[k] == one.force[0]);
      // rounding of a few hundred operations, and of slip that is small beside the velocities: 1e-16 of 1e5
      CHECK((all.set.force[k] - formulas[k].force).norm() <= 1e-11 * formulas[k].force.norm());
      if (!law.rolls) continue;
      CHECK(all.set.moment[k] == one.moment[0]);
      CHECK((all.set.moment[k] - formulas[k].moment).norm() <= 1e-11 * formulas[k].moment.norm());
    }
    CHECK(report.elastic == Approx(elastic).epsilon(1e-12));
    CHECK(report.dissipated == Approx(dissipated).epsilon(1e-9));
  }
}

}  // namespace

TEST_CASE("every law acts on a tile of contacts as on each of them, and as its formulas", "[laws][tile]") {
  const Target most = GENERATE(Target::baseline, Target::avx2, Target::avx512);
  limit_target(most);
  std::uint64_t seed = 0;
  for (const Entry& normal : law_entries(NormalLaws{}))
    for (const Entry& tangential : law_entries(TangentialLaws{})) {
      const bool fits = with_law(NormalLaws{}, normal.name, [&](auto n) {
        return with_law(TangentialLaws{}, tangential.name,
                        [](auto t) { return decltype(t)::type::template fits<typename decltype(n)::type>; });
      });
      if (!fits) continue;
      const std::vector<Entry> rolling = law_entries(RollingLaws{});
      const std::string& turning = rolling[++seed % rolling.size()].name;
      INFO(normal.name << ", " << tangential.name << ", rolling " << turning);
      const std::size_t counts[] = {1, 5, 31, 32, 33, 70};  // tiles hold 32
      SmoothSetup setup = setup_of_parts(normal.name, tangential.name, turning);
      setup.locate = seed % 5 == 0;
      compare(setup, counts[seed % 6], seed);
    }
  limit_target(Target::avx512);
}
