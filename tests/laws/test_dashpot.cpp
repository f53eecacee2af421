// The dashpot beside the friction spring: the damping that comes out is the one asked for, and its ledger closes.
#include <cmath>

#include "engine/units/random.h"
#include "laws/material.h"
#include "laws/smooth/critical_step.h"
#include "laws/smooth/dashpot.h"
#include "tests/support/catch.h"
#include "tests/support/experiments.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// Slip velocities of a sphere that sticks to a plane under its weight, where they are largest, one by one.
std::vector<double> swings(const std::string& law, const std::string& tangential, double zeta, double dt) {
  const double radius = 0.01, k = 1e5;
  ContactChoice choice{law, 1.0, 2.0, 0.0, parameters_of({{"stiffness", k}, {"tangential_damping", zeta}}), tangential};
  Rig rig(setup_of(choice, {ball, rigid}));
  rig.wall_material = 1;
  rig.world.gravity = {0, 0, -9.81};
  rig.add_sphere(radius, 2500, {0, 0, radius}, {1e-4, 0, 0});
  rig.add_plane(Vec3::UnitZ());
  const double weight = 9.81 * rig.mass();
  const double modulus = 1e9 / (1 - 0.25 * 0.25);
  const double overlap =
      law == "linear" ? weight / k : std::pow(0.75 * weight / (modulus * std::sqrt(radius)), 2.0 / 3);
  rig.world.position[0].z() -= overlap;
  rig.start();
  std::vector<double> largest;
  double before = 0.0, last = 0.0;
  for (int i = 0; i < 400000 && largest.size() < 6; ++i) {
    const double slip = rig.world.velocity[0].x() - radius * rig.world.angular_velocity[0].y();
    if (i > 5 && last > before && last > slip && last > 0.0)  // by the parabola through three points
      largest.push_back(last + 0.125 * (slip - before) * (slip - before) / (2.0 * last - slip - before));
    before = last;
    last = slip;
    rig.step(dt);
  }
  return largest;
}

}  // namespace

TEST_CASE("a sticking sphere swings with the tangential damping asked for", "[laws][friction][dashpot]") {
  for (const auto& [law, tangential] : {std::pair("linear", "spring-dashpot"), std::pair("hertz", "mindlin-dashpot")})
    for (const double zeta : {0.0, 0.05, 0.2}) {
      INFO(law << ", zeta " << zeta);
      const auto largest = swings(law, tangential, zeta, 1e-6);
      REQUIRE(largest.size() == 6);
      const double expected = std::exp(-2.0 * pi * zeta / std::sqrt(1.0 - zeta * zeta));
      for (std::size_t i = 1; i < largest.size(); ++i)
        if (largest[i] > 1e-10) CHECK(largest[i] / largest[i - 1] == Approx(expected).epsilon(2e-3));
    }
}

TEST_CASE("the ledger of a heap with tangential dashpots closes with the step", "[laws][friction][dashpot][energy]") {
  double error[2];
  for (int fine = 0; fine < 2; ++fine) {
    ContactChoice choice{"hertz-mindlin",  0.6, 0.4, 0.0, parameters_of({{"tangential_damping", 0.3}}),
                         "mindlin-dashpot"};
    Rig rig(setup_of(choice, {Material{"glass", 2500, 1e8, 0.25}, rigid}));
    rig.world.gravity = {0, 0, -9.81};
    rig.wall_material = 1;
    Random random(3, 0);
    for (int k = 0; k < 27; ++k) {
      const Vec3 jitter(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
      rig.add_sphere(0.005, 2500, 0.0125 * Vec3(k % 3, k / 3 % 3, k / 9) + 1e-3 * jitter + Vec3(0, 0, 0.007),
                     0.3 * jitter, 20 * jitter);
    }
    rig.add_plane(Vec3::UnitZ());
    for (const Vec3& n : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)})
      rig.add_plane(n, n.sum() > 0 ? Vec3(-0.007, -0.007, 0) : Vec3(0.032, 0.032, 0));
    rig.start();
    while (rig.world.time < 0.08) rig.step(fine ? 5e-6 : 1e-5);
    rig.ledger.measure(rig.world);
    CHECK(rig.ledger.last().dissipated > 0.2 * rig.ledger.last().kinetic);
    error[fine] = std::abs(rig.ledger.relative_error());
  }
  INFO("errors " << error[0] << " " << error[1]);
  // losses are booked with the velocity at the end of the step: what is left is the scatter of single impacts
  CHECK(error[0] < 1e-4);
  CHECK(error[1] < error[0] / 2);
}

TEST_CASE("friction by spring and dashpot together stays below mu N and never adds energy",
          "[laws][friction][dashpot]") {
  // a sphere thrown at the floor with much slip: T = mu N until it sticks, then at most that
  ContactChoice choice{"hertz", 0.7, 0.3, 0.0, parameters_of({{"tangential_damping", 1.0}}), "mindlin-dashpot"};
  for (const double sideways : {0.05, 1.0, 5.0}) {
    Rig rig(setup_of(choice, {ball, rigid}));
    rig.wall_material = 1;
    rig.add_sphere(0.01, 2500, {0, 0, 0.01001}, {sideways, 0, -1});
    rig.add_plane(Vec3::UnitZ());
    rig.start();
    double energy = kinetic_energy(rig.world) + rig.work.report.elastic;
    for (int k = 0; k < 4000; ++k) {
      rig.step(1e-7);
      const ContactSet& c = rig.work.contacts;
      if (c.size() == 1) {
        const double normal = std::abs(c.force[0].z());
        CHECK(std::hypot(c.force[0].x(), c.force[0].y()) <= 0.3 * normal * (1 + 1e-12));
      }
      const double now = kinetic_energy(rig.world) + rig.work.report.elastic;
      CHECK(now <= energy * (1 + 1e-7));  // rounding and the steps' own error of 1e-8
      energy = now;
    }
    CHECK(rig.work.report.touching == 0);
  }
}

TEST_CASE("a dashpot asked for and not there is refused, with the law that has it", "[laws][friction][errors]") {
  const auto message = [](ContactChoice choice) {
    choice.friction = 0.3;
    choice.parameters = parameters_of({{"stiffness", 1e5}, {"tangential_damping", 0.2}});
    try {
      make_smooth_contact(setup_of(choice, {Material{"glass", 2500, 1e8, 0.25}}));
    } catch (const SceneError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  using Catch::Contains;
  CHECK_THAT(message({"linear"}), Contains("has no tangential_damping") && Contains("\"spring-dashpot\""));
  CHECK_THAT(message({"hertz"}), Contains("has no tangential_damping") && Contains("\"mindlin-dashpot\""));
  ContactChoice mixed{"linear"};
  mixed.tangential = "mindlin-dashpot";
  CHECK_THAT(message(mixed), Contains("needs a Hertzian normal law") && Contains("\"spring-dashpot\""));
  mixed.tangential = "spring-dashpot";
  CHECK(message(mixed) == "accepted");
}

TEST_CASE("a strong dashpot shortens the time step", "[laws][friction][critical_step]") {
  const Material glass{"glass", 2500, 1e8, 0.25};
  const auto step = [&](double zeta) {
    ContactChoice choice{"hertz", 0.9, 0.3, 0.0, parameters_of({{"tangential_damping", zeta}}), "mindlin-dashpot"};
    const SmoothSetup setup = setup_of(choice, {glass});
    return critical_step(setup, setup.materials.pairs[0], {0.5e-3, 0.0025, 1.0}).auto_step;
  };
  CHECK(step(1.0) < 0.6 * step(0.0));
  CHECK(step(0.01) == Approx(step(0.0)).epsilon(0.05));
}

TEST_CASE("the tangential dashpot of spheres is that of the restitution where the scene gives none",
          "[laws][dashpot]") {
  Random random(77, 0);
  for (int draw = 0; draw < 50; ++draw) {
    MaterialPair pair;
    pair.restitution = random.uniform(0.02, 1.0);
    const double mass = random.uniform(1e-6, 1e-3), k = random.uniform(1e3, 1e7);  // m* and k_t
    const double log = std::log(pair.restitution), beta = -log / std::sqrt(log * log + M_PI * M_PI);
    const double c = 2.0 * tangential_damping(pair) * std::sqrt(2.0 / 7.0 * mass * k);
    CHECK(c == Approx(2.0 * std::sqrt(5.0 / 6.0) * beta * std::sqrt(k * mass)).epsilon(1e-12));
    pair.parameters = parameters_of({{"tangential_damping", 0.7}});
    CHECK(tangential_damping(pair) == 0.7);
  }
}
