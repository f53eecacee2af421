// Losses of dashpots as they are booked: the work on the way that bodies go.
#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

#include "laws/smooth/damper.h"
#include "tests/support/catch.h"
#include "tests/support/experiments.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

struct Booked {
  double told, exact;  ///< over the energy of the impact
};

/// A sphere strikes a plane at 1 m/s, `gap` above it at the start. Exact: the dashpot's force in every step by the
/// velocity that the step ends with, which is the mean of those before and after it.
Booked impact_on_plane(const std::string& law, double elastic_power, double e, double gap, const Parameters& more) {
  const Material glass{"glass", 2500, 1e7, 0.3};
  Rig rig = sphere_on_plane(setup_of({law, e, 0, 0, more}, {glass}), 0.005, gap, {0, 0, -1});
  rig.start();
  const double dt = 1e-5;
  double exact = 0.0;
  for (int k = 0; k < 400; ++k) {
    rig.step(dt);
    const double overlap = 0.005 - rig.world.position[0].z();
    if (!(overlap > 0.0)) continue;
    const double spring = elastic_power * rig.work.report.elastic / overlap;
    exact -= dt * (rig.world.force[0].z() - spring) * rig.world.velocity[0].z();
  }
  rig.ledger.measure(rig.world);
  const double energy = 0.5 * rig.mass();
  return {rig.ledger.last().losses.viscous / energy, exact / energy};
}

}  // namespace

TEST_CASE("the loss told of a dashpot is its work on the way that the body goes", "[laws][smooth][energy]") {
  const std::pair<double, double> bounds[] = {{0.9, 1e-5}, {0.6, 1e-8}, {0.3, 1e-8}, {0.1, 1e-12}};
  const std::tuple<std::string, double, Parameters> laws[] = {
      {"hertz", 2.5, {}},
      {"linear", 2.0, parameters_of({{"stiffness", 1e5}})},
      {"hunt-crossley", 2.5, parameters_of({{"reference_speed", 1.0}})},
      {"power-law", 2.5, parameters_of({{"stiffness", 1e7}, {"exponent", 1.5}})}};
  for (const auto& [law, power, parameters] : laws)
    for (const auto& [e, bound] : bounds)
      for (int phase = 0; phase < 12; ++phase) {
        const Booked b = impact_on_plane(law, power, e, 1e-5 * phase / 12.0, parameters);
        INFO(law << ", e " << e << ", phase " << phase);
        CHECK(b.exact > 0.5 * (1.0 - e * e));
        CHECK(std::abs(b.told - b.exact) < bound);
      }
}

TEST_CASE("an impact that begins at a touch returns alike on either side of it", "[laws][smooth]") {
  std::mt19937 random(21);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int draw = 0; draw < 60; ++draw) {
    const double e = 0.25 + 0.65 * unit(random), overlap = 0.005 * std::pow(10.0, -11.0 - 4.5 * unit(random));
    const bool later = draw % 2 == 1;  // reached at the end of a step, or at the start of the run
    const auto returned = [&](double gap) {
      const Material glass{"glass", 2500, 1e7, 0.3};
      const SmoothSetup setup = setup_of({"linear", e, 0, 0, parameters_of({{"stiffness", 1e5}})}, {glass});
      Rig rig = sphere_on_plane(setup, 0.005, 0.0, {0, 0, -1});
      const double dt = 0.1 * pi * std::sqrt(rig.mass() / 1e5);
      rig.world.position[0].z() = 0.005 + gap + (later ? 2.0 * dt : 0.0);
      rig.start();
      for (int k = 0; k < 20; ++k) rig.step(dt);
      return rig.world.velocity[0].z();
    };
    INFO("e " << e << ", overlap " << overlap << ", draw " << draw);
    CHECK(returned(-overlap) == Approx(returned(overlap)).epsilon(1e-4));
    CHECK(returned(-overlap) == Approx(e).margin(0.02));  // as at any other phase of ten steps
  }
}

TEST_CASE("the energy balance of an impact that begins in overlap closes", "[laws][smooth][energy]") {
  std::mt19937 random(22);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int draw = 0; draw < 60; ++draw) {
    const Material glass{"glass", 2500, 1e7, 0.3};
    const double e = unit(random), overlap = 0.005 * std::pow(10.0, -2.0 - 3.0 * unit(random));
    const SmoothSetup setup = setup_of({"linear", e, 0, 0, parameters_of({{"stiffness", 1e5}})}, {glass});
    Rig rig = sphere_on_plane(setup, 0.005, -overlap, {0, 0, -1});
    const double dt = 0.02 * pi * std::sqrt(rig.mass() / 1e5);
    rig.start();
    for (int k = 0; k < 80; ++k) rig.step(dt);
    rig.ledger.measure(rig.world);
    INFO("e " << e << ", overlap " << overlap << ", draw " << draw);
    CHECK(std::abs(rig.ledger.relative_error()) < 0.01);
  }
}

TEST_CASE("the loss told of a dashpot is its work where steps change too", "[laws][smooth][energy]") {
  std::mt19937 random(20);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const double e : {0.6, 0.3, 0.1})
    for (int draw = 0; draw < 40; ++draw) {
      const Material glass{"glass", 2500, 1e7, 0.3};
      const SmoothSetup setup = setup_of({"linear", e, 0, 0, parameters_of({{"stiffness", 1e5}})}, {glass});
      Rig rig = sphere_on_plane(setup, 0.005, 1e-5 * unit(random), {0, 0, -1});
      rig.start();
      double dt = 1e-5, power = 0.0, exact = 0.0;
      for (int k = 0; k < 600; ++k) {
        if (unit(random) < 0.3) dt = 1e-5 / static_cast<double>(1 + random() % 4);
        exact += 0.5 * dt * power;
        rig.step(dt);
        const double overlap = 0.005 - rig.world.position[0].z();
        power = 0.0;
        if (overlap > 0.0)
          power = -(rig.world.force[0].z() - 2.0 * rig.work.report.elastic / overlap) * rig.world.velocity[0].z();
        exact += 0.5 * dt * power;
      }
      rig.ledger.measure(rig.world);
      const double energy = 0.5 * rig.mass();
      INFO("e " << e << ", draw " << draw);
      CHECK(exact > 0.5 * (1.0 - e * e) * energy);
      CHECK(std::abs(rig.ledger.last().losses.viscous - exact) < 1e-12 * energy);
    }
}

TEST_CASE("the balance of damped adhesive impacts closes, whether they part or stick", "[laws][smooth][energy]") {
  std::mt19937 random(19);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  int stuck = 0;
  for (int k = 0; k < 120; ++k) {
    const double work = std::pow(10.0, -2.0 + 2.0 * unit(random)), speed = std::pow(10.0, -2.0 + 2.0 * unit(random));
    const double e = 0.1 + 0.8 * unit(random), radius = 1e-3;
    const Material soft{"soft", 2000, 5e6, 0.3};
    const std::string law = k % 2 == 0 ? "jkr" : "dmt";
    Rig rig = sphere_on_plane(setup_of({law, e, 0, 0, parameters_of({{"work_of_adhesion", work}})}, {soft}), radius,
                              1e-6 * unit(random), {0, 0, -speed});
    rig.detection->reach = 1e-4;
    rig.start();
    const double dt = 2e-7;
    for (int n = 0; n < 6000; ++n) rig.step(dt);
    rig.ledger.measure(rig.world);
    INFO(law << ", w " << work << ", v " << speed << ", e " << e);
    CHECK(std::abs(rig.ledger.relative_error()) < 1e-2);
    stuck += rig.work.report.touching > 0;
  }
  CHECK(stuck > 10);
  CHECK(stuck < 110);
}
