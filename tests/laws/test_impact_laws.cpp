// Laws of impact beside Newton's: Poisson's and one impact at a time (cases A21, A22, A23, A24).
#include "tests/support/catch.h"
#include "tests/support/rigid_experiment.h"

using namespace epafi;
using namespace epafi::test;

namespace {

RigidSettings settings(const std::string& impact, double restitution, double dt, double friction = 0.0) {
  RigidSettings s{.friction = friction, .restitution = restitution, .dt = dt, .gravity = Vec3::Zero()};
  s.parameters.set("impact", impact);
  s.parameters.set("tolerance", 1e-13);
  s.parameters.set("iterations", 100000.0);
  s.parameters.set("correction", 0.0);
  return s;
}

/// Spheres of one radius in a row along x, touching, the first `strikers` of them with 1 m/s; their velocities later.
std::vector<double> cradle(const std::string& impact, std::size_t count, std::size_t strikers) {
  RigidExperiment run(settings(impact, 1.0, 1e-3));
  for (std::size_t i = 0; i < count; ++i) {
    const bool strikes = i < strikers;  // they fly as a block, 0.01 m from the others
    run.sphere(0.05, 1000, Vec3(0.1 * static_cast<double>(i) + (strikes ? 0.0 : 0.01), 0, 0), Vec3(strikes, 0, 0));
  }
  run.run(30);
  std::vector<double> v;
  for (Slot s = 0; s < count; ++s) v.push_back(run.world.velocity[s].x());
  return v;
}

double momentum(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double x : v) sum += x;
  return sum;
}
double energy(const std::vector<double>& v) {
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return sum;
}

}  // namespace

TEST_CASE("A23: a heavy ball, a light one and a wall collide 3, 31, 314 times: the digits of pi",
          "[laws][impact][A23][long]") {
  // mass 1 at rest at x = 1, mass 100^n comes with 1 m/s; elastic and frictionless (Galperin 2003)
  const double radius = 1e-3, density = 1.0 / (4.0 / 3.0 * M_PI * radius * radius * radius);
  struct Case {
    double mass;
    std::uint64_t collisions;
  };
  for (const Case c : {Case{1.0, 3}, Case{100.0, 31}, Case{1e4, 314}}) {
    INFO("mass ratio " << c.mass);
    RigidSettings s = settings("sequential", 1.0, 1e-4);
    s.reach = 10.0;
    RigidExperiment run(s);
    run.plane(Vec3::Zero(), Vec3::UnitX());
    const Slot light = run.sphere(radius, density, Vec3(1.0, 0, 0));
    const Slot heavy = run.sphere(radius, c.mass * density, Vec3(1.1, 0, 0), Vec3(-1, 0, 0));
    const double before = run.kinetic();
    run.run(100000);
    CHECK(impact_count(*run.pipeline.contact_model) == c.collisions);
    CHECK(run.kinetic() == Approx(before).epsilon(1e-9));
    CHECK(run.world.velocity[light].x() >= 0.0);
    CHECK(run.world.velocity[heavy].x() >= run.world.velocity[light].x());
    // velocities turn by twice the angle atan(1 / sqrt(mass)) with every pair of collisions
    const double angle = std::atan(1.0 / std::sqrt(c.mass)),
                 k = static_cast<double>(c.collisions / 2 + c.collisions % 2);
    CHECK(run.world.velocity[heavy].x() == Approx(-std::cos(2.0 * angle * k)).margin(1e-9));
  }
}

TEST_CASE("A23: steps of 1e-4 s without events give the heavy ball its speed within 1 %", "[laws][impact][A23]") {
  const double radius = 1e-3, density = 1.0 / (4.0 / 3.0 * M_PI * radius * radius * radius);
  RigidSettings s = settings("newton", 1.0, 1e-4);
  s.reach = 10.0;
  RigidExperiment run(s);
  run.plane(Vec3::Zero(), Vec3::UnitX());
  run.sphere(radius, density, Vec3(1.0, 0, 0));
  const Slot heavy = run.sphere(radius, 100 * density, Vec3(1.1, 0, 0), Vec3(-1, 0, 0));
  run.run(100000);
  CHECK(run.world.velocity[heavy].x() == Approx(-std::cos(32.0 * std::atan(0.1))).epsilon(0.01));
}

TEST_CASE("A24: Newton's cradle, one impact at a time, sends off as many balls as come", "[laws][impact][A24]") {
  for (const std::size_t strikers : {1, 2, 3}) {
    const auto v = cradle("sequential", 5, strikers);
    for (std::size_t i = 0; i < 5; ++i) CHECK(v[i] == Approx(i + strikers >= 5 ? 1.0 : 0.0).margin(1e-10));
  }
}

TEST_CASE("A24: impacts at all contacts at once spread the shock, with momentum and energy kept",
          "[laws][impact][A24]") {
  // one striker against n - 1 touching balls: they leave as one body of mass n - 1 does
  for (const std::string law : {"newton", "poisson"})
    for (const std::size_t n : {3, 5}) {
      INFO(law << " " << n);
      const auto v = cradle(law, n, 1);
      CHECK(momentum(v) == Approx(1.0).epsilon(1e-10));
      CHECK(energy(v) == Approx(1.0).epsilon(1e-10));
      CHECK(v[0] == Approx(2.0 / static_cast<double>(n) - 1.0).epsilon(1e-9));
      for (std::size_t i = 1; i < n; ++i) CHECK(v[i] == Approx(2.0 / static_cast<double>(n)).epsilon(1e-9));
    }
}

TEST_CASE("A21: every law of impact strikes a rod with the impulse of one contact, and gains no energy on the way",
          "[laws][impact][A21]") {
  for (const std::string law : {"newton", "poisson", "sequential"})
    for (const double degrees : {30.0, 45.0, 60.0})
      for (const double mu : {0.0, 0.3, 1.0})
        for (const double slide : {-2.0, 0.0, 0.5, 2.0}) {
          const double theta = degrees * M_PI / 180.0, thin = 1e-6;
          RigidExperiment run(settings(law, 0.5, 5e-7, mu));
          run.plane(Vec3::Zero(), Vec3::UnitZ());
          const Slot s =
              run.box(Vec3(0.5, thin, thin), 1e12, Vec3(0, 0, 0.5 * std::sin(theta) + thin * std::cos(theta) + 2e-6),
                      Vec3(slide, 0, -1), Quat(Eigen::AngleAxisd(theta, Vec3::UnitY())));
          const double before = run.kinetic(), c = std::cos(theta);
          run.run(8);
          INFO(law << " at " << degrees << " mu " << mu << " sliding " << slide);
          CHECK(run.kinetic() <= before * (1 + 1e-12));
          // two corners 2e-6 apart strike: one at a time they turn the rod about itself, at once they are one contact
          if (mu == 0.0 && law != "sequential")
            CHECK(run.world.velocity[s].z() == Approx(1.5 / (1 + 3 * c * c) - 1.0).margin(1e-5));
        }
}

TEST_CASE("A22: the ball of Zeno rests at the end of its series under every law of impact", "[laws][impact][A22]") {
  for (const std::string law : {"poisson", "sequential"})
    for (const auto& [e, rest] : {std::pair(0.5, 1.354571), {0.8, 4.063713}}) {
      RigidSettings s{.restitution = e, .reach = 1e-2};
      s.parameters.set("impact", law);
      RigidExperiment run(s);
      run.plane(Vec3::Zero(), Vec3::UnitZ());
      const Slot ball = run.sphere(0.05, 2500.0, Vec3(0, 0, 1.05));
      double last = 0.0;
      while (run.world.time < 1.5 * rest) {
        run.run(1);
        if (run.world.velocity[ball].norm() > 1e-9) last = run.world.time;
      }
      INFO(law << " e = " << e);
      CHECK(last == Approx(rest).epsilon(5e-3));
      CHECK(run.world.position[ball].z() == Approx(0.05).margin(1e-6));
    }
}
