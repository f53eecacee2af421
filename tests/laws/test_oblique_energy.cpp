// An oblique impact on a wall never gains energy: every law, 0 to 89 degrees, friction 0 to 2.
#include <cmath>

#include "laws/smooth/critical_step.h"
#include "tests/support/catch.h"
#include "tests/support/experiments.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

const Material fast_ball{"ball", 4000, 1e9, 0.3};
constexpr double ball_radius = 2.5e-3, ball_speed = 3.9;

struct LawCase {
  const char* law;
  const char* tangential;  ///< "": the law's own
  Parameters parameters{};
};

std::vector<LawCase> cases() {
  const double k = 1e9 * ball_radius;
  return {{"linear", "coulomb-spring", parameters_of({{"stiffness", k}})},
          {"hertz", "coulomb-spring"},
          {"hertz-mindlin", ""},
          {"hertz-mindlin", "mindlin-deresiewicz"},
          {"hunt-crossley", "mindlin", parameters_of({{"reference_speed", ball_speed}})},
          {"kuwabara-kono", "mindlin", parameters_of({{"relaxation_time", 1e-7}})},
          {"power-law", "coulomb-spring",
           parameters_of({{"stiffness", k * std::pow(1e-2 * ball_radius, -1.0)}, {"exponent", 2}})},
          {"walton-braun", "coulomb-spring", parameters_of({{"stiffness", k}})},
          {"dmt", "mindlin", parameters_of({{"work_of_adhesion", 0.05}})},
          {"jkr", "mindlin", parameters_of({{"work_of_adhesion", 0.05}})}};
}

/// Energy after over energy before, the worst over three phases of the first touch.
double energy_ratio(const LawCase& c, double e, double mu, double degrees, int steps) {
  ContactChoice choice{c.law, e, mu, 0.0, c.parameters, mu > 0 ? c.tangential : "none", ""};
  const SmoothSetup setup = setup_of(choice, {fast_ball, rigid});
  const double angle = degrees * pi / 180, normal = ball_speed * std::cos(angle);
  const double mass = 4.0 / 3.0 * pi * ball_radius * ball_radius * ball_radius * fast_ball.density;
  const double time = estimate_impact(setup, setup.materials.of(0, 1), {mass, ball_radius, normal}).contact_time;
  double worst = 0.0;
  for (int phase = 0; phase < 3; ++phase) {
    const double dt = time / steps;
    Rig rig = sphere_on_plane(setup, ball_radius, (phase + 0.5) / 3 * normal * dt,
                              {ball_speed * std::sin(angle), 0, -normal}, mu > 0 ? Vec3(0, 200, 100) : Vec3(0, 0, 0));
    const double before = kinetic_energy(rig.world);
    rig.start();
    for (int k = 0; k < 20 * steps; ++k) rig.step(dt);
    // what adhesion still holds has its energy in the contact
    worst = std::max(worst, (kinetic_energy(rig.world) + rig.work.report.elastic) / before);
  }
  return worst;
}

}  // namespace

TEST_CASE("oblique impacts gain no energy beyond the error of the scheme (case B02)", "[laws][impact][oblique][long]") {
  // Verlet at 100 steps per contact: 7.2e-6 of e, twice that of the energy, times the 1.5 that the case allows
  for (const LawCase& c : cases())
    for (double mu : {0.0, 0.1, 0.5, 2.0})
      for (double degrees : {0.0, 20.0, 45.0, 70.0, 89.0}) {
        INFO(c.law << " " << c.tangential << " mu " << mu << " at " << degrees << " degrees");
        CHECK(energy_ratio(c, 1.0, mu, degrees, 100) < 1 + 2.2e-5);
        CHECK(energy_ratio(c, 0.6, mu, degrees, 100) < 1 + 2.2e-5);
      }
}

TEST_CASE("finely stepped oblique impacts gain no energy beyond 1e-9", "[laws][impact][oblique][slow]") {
  for (const LawCase& c : cases())
    for (double mu : {0.1, 0.5, 2.0})
      for (double degrees = 0.0; degrees < 89.5; degrees += 8.9) {
        INFO(c.law << " " << c.tangential << " mu " << mu << " at " << degrees << " degrees");
        CHECK(energy_ratio(c, 1.0, mu, degrees, 20000) < 1 + 1e-9);
      }
}
