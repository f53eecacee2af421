#include <cmath>

#include "engine/units/random.h"
#include "laws/all_laws.h"
#include "laws/smooth/spring.h"
#include "tests/support/catch.h"
#include "tests/support/experiments.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

const Material oxide{"al oxide", 4000, 380e9, 0.23};
constexpr double g = 9.81;

/// Of an elastic Hertz impact of a sphere of aluminium oxide on a rigid plane [s].
double oxide_contact_time(double radius, double normal_speed) {
  const double m = 4.0 / 3.0 * pi * radius * radius * radius * 4000, modulus = 380e9 / (1 - 0.23 * 0.23);
  return 2.868266 * std::pow(m * m / (radius * modulus * modulus * normal_speed), 0.2);
}

/// A sphere resting on the plane at its Hertz equilibrium overlap, N = m g cos(tilt), gravity tilted towards +x.
Rig resting_sphere(const SmoothSetup& setup, double radius, double tilt, const Vec3& velocity,
                   const Vec3& spin = Vec3::Zero()) {
  Rig rig = sphere_on_plane(setup, radius, 0.0, velocity, spin);
  rig.world.gravity = g * Vec3(std::sin(tilt), 0, -std::cos(tilt));
  const double modulus = setup.materials.of(0, 1).effective_modulus();
  rig.world.position[0].z() -=
      std::pow(0.75 * rig.mass() * g * std::cos(tilt) / (modulus * std::sqrt(radius)), 2.0 / 3.0);
  rig.start();
  return rig;
}

}  // namespace

TEST_CASE("a sliding sphere comes to roll at 5/7 of its speed and then keeps it (case A14)", "[laws][friction][A14]") {
  const double radius = 0.05, v0 = 2.0, dt = 2e-5;
  Rig rig = resting_sphere(setup_of({"hertz-mindlin", 0.8, 0.2}, {ball, rigid}), radius, 0.0, {v0, 0, 0});
  const double start = rig.world.position[0].x();
  double rolls_at = 0.0, distance = 0.0;
  while (rolls_at == 0.0 && rig.world.time < 0.5) {
    rig.step(dt);
    if (rig.world.velocity[0].x() - radius * rig.world.angular_velocity[0].y() > 0) continue;
    rolls_at = rig.world.time;
    distance = rig.world.position[0].x() - start;
  }
  CHECK(rolls_at == Approx(0.291248).epsilon(2e-3));
  CHECK(distance == Approx(0.499282).epsilon(2e-3));
  // the tangential spring goes on swinging, without loss; a Hann window over 40 of its periods takes that out
  const auto mean_speed = [&] {
    double mean = 0.0;
    for (int k = 0; k < 10000; ++k) {
      rig.step(dt);
      mean += 2 * std::pow(std::sin(pi * k / 10000), 2) * rig.world.velocity[0].x() / 10000;
    }
    return mean;
  };
  const double mean = mean_speed();
  CHECK(mean == Approx(1.428571).epsilon(2e-3));
  CHECK(radius * rig.world.angular_velocity[0].y() == Approx(1.428571).epsilon(2e-3));
  for (int k = 0; k < 90000; ++k) rig.step(dt);
  CHECK(std::abs(mean_speed() - mean) < 1e-6);
  rig.ledger.measure(rig.world);
  CHECK(std::abs(rig.ledger.relative_error()) < 1e-5);
}

TEST_CASE("backspin R w0 = 5/2 v0 stops a sphere dead (case A14)", "[laws][friction][A14]") {
  const double radius = 0.05, v0 = 2.0;
  Rig rig =
      resting_sphere(setup_of({"hertz", 0.8, 0.2}, {ball, rigid}), radius, 0.0, {v0, 0, 0}, {0, -2.5 * v0 / radius, 0});
  while (rig.world.time < 1.2) rig.step(2e-5);  // it stops at v0/(mu g) = 1.02 s
  CHECK(std::abs(rig.world.velocity[0].x()) < 2e-3 * v0);
  CHECK(std::abs(radius * rig.world.angular_velocity[0].y()) < 2e-3 * v0);
}

TEST_CASE("a sphere on an incline rolls or slides with the accelerations of rigid bodies (case A15)",
          "[laws][friction][A15]") {
  const double radius = 0.05, tilt = 25 * pi / 180, dt = 2e-5;
  struct Row {
    double friction, acceleration, spin;
  };  // threshold mu = 2/7 tan(25 deg) = 0.133231
  for (const Row& row : {Row{0.5, 2.961347, 2.961347},
                         {0.14, 2.961347, 2.961347},
                         {0.1, 3.256797, 2.222720},
                         {0.13, 2.990184, 2.889536}}) {
    // sliding: a = g (sin - mu cos), R alpha = 5/2 mu g cos
    Rig rig = resting_sphere(setup_of({"hertz", 0.5, row.friction}, {ball, rigid}), radius, tilt, {0, 0, 0});
    while (rig.world.time < 0.5) rig.step(dt);
    INFO("mu = " << row.friction);
    CHECK(rig.world.velocity[0].x() / rig.world.time == Approx(row.acceleration).epsilon(2e-3));
    CHECK(radius * rig.world.angular_velocity[0].y() / rig.world.time == Approx(row.spin).epsilon(2e-3));
    rig.ledger.measure(rig.world);
    CHECK(std::abs(rig.ledger.relative_error()) < 1e-4);
  }
}

TEST_CASE("rolling friction holds a sphere at rest without creep and slows it by 5/7 mu_r g (type C)",
          "[laws][rolling]") {
  const double radius = 0.05, dt = 2e-5, mu_r = 0.05;
  SECTION("at rest on a slope below mu_r") {
    Rig rig = resting_sphere(setup_of({"hertz", 0.5, 0.8, mu_r}, {ball, rigid}), radius, 0.5 * mu_r, {0, 0, 0});
    while (rig.world.time < 2.0) rig.step(dt);
    const Vec3 place = rig.world.position[0];
    while (rig.world.time < 4.0) rig.step(dt);
    CHECK((rig.world.position[0] - place).norm() < 1e-9);
    CHECK(rig.world.velocity[0].norm() < 1e-8);
  }
  SECTION("rolling freely: torque balance about the contact gives a = mu_r g / (1 + 2/5)") {
    const double v = 1.0;
    Rig rig =
        resting_sphere(setup_of({"hertz", 0.5, 0.8, mu_r}, {ball, rigid}), radius, 0.0, {v, 0, 0}, {0, v / radius, 0});
    while (rig.world.time < 1.0) rig.step(dt);
    CHECK(rig.world.velocity[0].x() == Approx(v - mu_r * g / 1.4 * rig.world.time).epsilon(3e-3));
    rig.ledger.measure(rig.world);
    CHECK(std::abs(rig.ledger.relative_error()) < 1e-4);
  }
}

TEST_CASE("an oblique impact in full slip obeys rigid impulse balance (case A08)", "[laws][impact][A08]") {
  // e_t = 1 - mu (1 + e)/tan(theta), omega = 5/2 mu (1 + e) V cos(theta)/R
  const double radius = 2.5e-3, speed = 3.9, mu = 0.092, e = 0.98;
  struct Row {
    double degrees, ratio, spin;
  };
  for (const Row& row : {Row{35, .73985, 581.95},
                         {45, .81784, 502.35},
                         {50, .84715, 456.65},
                         {60, .89483, 355.21},
                         {75, .95119, 183.87},
                         {85, .98406, 61.918}}) {
    const double theta = row.degrees * pi / 180, vn = speed * std::cos(theta), vt = speed * std::sin(theta);
    const double time = oxide_contact_time(radius, vn), dt = time / 1000;
    Rig rig = sphere_on_plane(setup_of({"hertz", e, mu}, {oxide, rigid}), radius, 0.3 * vn * dt, {vt, 0, -vn});
    const Impact impact = run_impact(rig, dt);
    INFO("theta = " << row.degrees);
    CHECK(rig.world.velocity[0].x() / vt == Approx(row.ratio).epsilon(1e-3));
    CHECK(std::abs(rig.world.angular_velocity[0].y()) == Approx(row.spin).epsilon(1e-3));
    CHECK(std::abs(impact.energy_error) < 1e-5);
  }
}

TEST_CASE("micro-slip impacts converge to the published incremental Mindlin law with rescaling (cases A08, A09)",
          "[laws][impact][A08][A09]") {
  const double mu = 0.092, e = 0.98, speed = 3.9, radius = 2.5e-3;
  struct Row {
    double degrees, ratio, spin;
  };
  for (const Row& row : {Row{2, .87937, 16.42},
                         {5, .86114, 47.20},
                         {10, .71056, 196.02},
                         {15, .63143, 372.0},
                         {20, .62010, 506.7},
                         {25, .63812, 596.5},
                         {30, .68449, 615.2}}) {
    const double theta = row.degrees * pi / 180, vn = speed * std::cos(theta), vt = speed * std::sin(theta);
    const double time = oxide_contact_time(radius, vn);
    for (const auto& [steps, gate] : {std::pair{100, 0.02}, {4000, 0.003}}) {
      const double dt = time / steps;
      Rig rig = sphere_on_plane(setup_of({"hertz", e, mu}, {oxide, rigid}), radius, 0.3 * vn * dt, {vt, 0, -vn});
      run_impact(rig, dt);
      INFO("theta = " << row.degrees << ", " << steps << " steps");
      CHECK(std::abs(rig.world.velocity[0].x() - row.ratio * vt) < gate * speed);
      CHECK(std::abs(std::abs(radius * rig.world.angular_velocity[0].y()) - radius * row.spin) < gate * speed);
    }
  }
  // A09, steel of 10 um: R omega and recoil over mu v_n
  const Material steel{"steel", 7850, 208e9, 0.3};
  const double r = 1e-5, vn = 5, m = 4.0 / 3.0 * pi * r * r * r * 7850, modulus = 208e9 / 0.91;
  const double time = 2.868266 * std::pow(m * m / (r * modulus * modulus * vn), 0.2);
  struct Recoil {
    double psi, recoil, spin;
  };
  for (const Recoil& row : {Recoil{1, .4156, -.4174},
                            {2, -.1908, -1.5649},
                            {3, -.9886, -2.8490},
                            {4, -1.3980, -3.8557},
                            {5, -1.4356, -4.5969},
                            {6, -.9814, -4.9867},
                            {8, 1.0, -5.0}}) {
    const double scale = 0.3 * vn, dt = time / 4000;
    Rig rig =
        sphere_on_plane(setup_of({"hertz", 1.0, 0.3}, {steel, rigid}), r, 0.3 * vn * dt, {row.psi * scale, 0, -vn});
    run_impact(rig, dt);
    const double spin = -r * rig.world.angular_velocity[0].y() / scale,
                 recoil = rig.world.velocity[0].x() / scale + spin;
    INFO("psi = " << row.psi);
    CHECK(std::abs(spin - row.spin) < 0.003);
    CHECK(std::abs(recoil - row.recoil) < 0.003 * 2);  // both of their errors
  }
}

TEST_CASE(
    "a spinning sphere dropped on a plane gains the speed of full slip, less the lag of its spring (cases A10, A11)",
    "[laws][impact][A10][A11]") {
  // R = .1, v_n = .2, mu = .4, e = .5; full slip: v_t = mu (1 + e) v_n = .12, omega = omega0 - 3
  const Material aluminium{"aluminium", 2700, 70e9, 0.33};
  const double radius = 0.1, vn = 0.2, m = 4.0 / 3.0 * pi * 1e-3 * 2700, modulus = 70e9 / (1 - 0.33 * 0.33);
  const double time = 2.868266 * std::pow(m * m / (radius * modulus * modulus * vn), 0.2), dt = time / 4000;
  // converged values of the incremental Mindlin law with Tsuji damping, independent computation
  struct Row {
    double spin, speed_out, spin_out;
  };
  for (const Row& row : {Row{0.5, .018184509, .045387268},
                         {1, .041606967, -.040174174},
                         {2, .081485042, -.037126046},
                         {3, .10848853, .28778686},
                         {5, .11758768, 2.060308},
                         {12, .11908648, 9.0228381},
                         {22, .11951812, 19.012047}}) {
    Rig rig = sphere_on_plane(setup_of({"hertz", 0.5, 0.4}, {aluminium, rigid}), radius, 0.3 * vn * dt, {0, 0, -vn},
                              {0, row.spin, 0});
    run_impact(rig, dt);
    INFO("spin " << row.spin);
    CHECK(std::abs(rig.world.velocity[0].x() - row.speed_out) < 0.003 * 0.4 * 1.5 * vn);
    CHECK(std::abs(rig.world.angular_velocity[0].y() - row.spin_out) < 0.003 * 3);
  }
  // two equal spheres of the same spin, each at .2: the plane between them is a mirror of slip
  const double pair_time = 2.868266 * std::pow(m * m / 4 / (0.5 * radius * modulus * modulus / 4 * 2 * vn), 0.2);
  Rig rig(setup_of({"hertz", 0.5, 0.4}, {aluminium}));
  rig.add_sphere(radius, 2700, {-radius - 1e-9, 0, 0}, {vn, 0, 0}, {0, 0, 22});
  rig.add_sphere(radius, 2700, {radius + 1e-9, 0, 0}, {-vn, 0, 0}, {0, 0, 22});
  run_impact(rig, pair_time / 4000);
  CHECK(rig.world.velocity[0].y() == Approx(-0.12).epsilon(0.005));
  CHECK(rig.world.velocity[1].y() == Approx(0.12).epsilon(0.005));
  for (int s : {0, 1}) CHECK(rig.world.angular_velocity[static_cast<std::size_t>(s)].z() == Approx(19).epsilon(0.005));
}

namespace {

/// One contact moved by hand through the spring: overlap and sliding along given lines, work done ON it.
struct DrivenContact {
  Hertz::Parameters normal{1e9, 0.0};
  Mindlin::Parameters tangential{0.3, 0.8};
  Spring spring{};
  double overlap = 0.0, work = 0.0, largest_energy = 0.0;

  double normal_force() const { return Hertz::respond(normal, {overlap, 0, 1, 1e-3}).force; }
  double normal_energy() const { return Hertz::respond(normal, {overlap, 0, 1, 1e-3}).energy; }
  void move(double to_overlap, const Vec3& slide, int steps) {
    const double from = overlap;
    const double elastic = normal_energy();
    for (int k = 1; k <= steps; ++k) {
      overlap = from + (to_overlap - from) * k / steps;
      const NormalResponse r = Hertz::respond(normal, {overlap, 0, 1, 1e-3});
      const Vec3 step = slide / steps, before = spring.load;
      spring = extend(spring, before, Mindlin::stiffness(tangential, r.stiffness), step, tangential.friction * r.force);
      work += 0.5 * (before + spring.load).dot(step);
      largest_energy = std::max(largest_energy, energy_of(spring));
    }
    work += normal_energy() - elastic;  // the normal law is conservative: its integral is exact
  }
};

}  // namespace

TEST_CASE("shear, unload, shear back, reload costs half the shear energy and never gives any (case A13)",
          "[laws][friction][A13]") {
  const double d1 = 1e-5;
  DrivenContact contact;
  contact.move(d1, {0, 0, 0}, 100);
  const double kt = Mindlin::stiffness(contact.tangential, Hertz::respond(contact.normal, {d1, 0, 1, 1e-3}).stiffness);
  const double shear = 0.1 * 0.3 * contact.normal_force() / kt;
  contact.work = 0.0;
  contact.move(d1, {shear, 0, 0}, 100);
  const double stored = energy_of(contact.spring);
  contact.move(d1 / 4, {0, 0, 0}, 1000);
  contact.move(d1 / 4, {-shear, 0, 0}, 100);
  contact.move(d1, {0, 0, 0}, 1000);
  // unloading to d1/4 halves k_t and the load with it: half the energy comes back
  CHECK(contact.work == Approx(0.5 * stored).epsilon(1e-9));
  CHECK(contact.spring.load.norm() < 1e-12 * kt * shear);
}

TEST_CASE("no random closed cycle of overlap and slip takes energy out of a contact (case A13)",
          "[laws][friction][A13]") {
  double worst = 1.0;
  for (std::uint64_t cycle = 0; cycle < 1000; ++cycle) {
    Random random(7, cycle);
    DrivenContact contact;
    Vec3 place = Vec3::Zero();
    const double start = random.uniform(0.2e-5, 1e-5);
    contact.move(start, {0, 0, 0}, 100);
    contact.work = 0.0;
    for (int leg = 0; leg < 6; ++leg) {
      const Vec3 target(random.uniform(-1e-6, 1e-6), random.uniform(-1e-6, 1e-6), 0);
      // the last leg closes the cycle
      const Vec3 to = leg < 5 ? target : Vec3(0, 0, 0);
      contact.move(leg < 5 ? random.uniform(0.1e-5, 1e-5) : start, to - place, 2000);
      place = to;
    }
    worst = std::min(worst, contact.work / contact.largest_energy);
  }
  INFO("worst work over largest shear energy " << worst);
  CHECK(worst >= -1e-9);
}
