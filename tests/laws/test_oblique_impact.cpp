// Oblique impacts of a spinning sphere on a plane: no law gives energy, at any angle, friction and spin.
#include <cmath>

#include "laws/smooth/critical_step.h"
#include "tests/support/catch.h"
#include "tests/support/experiments.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

const Material grain{"grain", 4000, 1e9, 0.3};

struct Parts {
  const char *law, *tangential;
};

double energy_gain(const Parts& parts, double e, double mu, double degrees, double spin, int steps, bool locate) {
  const double R = 2.5e-3, v = 3.9, angle = degrees * pi / 180, vn = std::max(v * std::cos(angle), 1e-6);
  ContactChoice choice{parts.law, e, mu, 0,
                       parameters_of({{"stiffness", 1e6},
                                      {"exponent", 1.0},
                                      {"reference_speed", vn},
                                      {"relaxation_time", 1e-6},
                                      {"work_of_adhesion", 0.02}})};
  choice.tangential = parts.tangential;
  SmoothSetup setup = setup_of(choice, {grain, rigid});
  setup.locate = locate;
  const double m = 4.0 / 3.0 * pi * R * R * R * 4000;
  const double dt = estimate_impact(setup, setup.materials.of(0, 1), {m, R, vn}).contact_time / steps;
  Rig rig(setup, Columns{.rotation = true});
  rig.wall_material = 1;
  rig.add_sphere(R, 4000, {0, 0, R + 0.37 * vn * dt}, {v * std::sin(angle), 0, -v * std::cos(angle)},
                 {0.3 * spin, spin, 0.1 * spin});
  rig.add_plane(Vec3::UnitZ());
  rig.detection->reach = smooth_reach(setup, R);
  const double before = kinetic_energy(rig.world);
  rig.start();
  for (int k = 0; k < 20 * steps; ++k) {
    rig.step(dt);
    if (k > steps / 2 && rig.work.report.touching == 0) break;
  }
  return kinetic_energy(rig.world) / before - 1;
}

const Parts all_parts[] = {{"linear", "coulomb-spring"},
                           {"hertz", "mindlin"},
                           {"hertz", "coulomb-spring"},
                           {"hertz", "mindlin-deresiewicz"},
                           {"hunt-crossley", "mindlin"},
                           {"flores", "mindlin"},
                           {"power-law", "coulomb-spring"},
                           {"kuwabara-kono", "mindlin"},
                           {"walton-braun", "coulomb-spring"},
                           {"dmt", "mindlin"},
                           {"jkr", "mindlin"}};

}  // namespace

TEST_CASE("no law gives energy in an oblique impact, 0 to 89 degrees, mu 0 to 2, spinning or not",
          "[laws][impact][energy][long]") {
  double worst = -1.0;
  for (const Parts& parts : all_parts)
    for (double e : {1.0, 0.6})
      for (double mu : {0.0, 0.1, 0.5, 2.0})
        for (double degrees : {0.0, 20.0, 45.0, 70.0, 89.0})
          for (double spin : {0.0, 1500.0, -1500.0})
            for (bool locate : {false, true}) {
              const double gain = energy_gain(parts, e, mu, degrees, spin, 80, locate);
              INFO(parts.law << " " << parts.tangential << " e " << e << " mu " << mu << " at " << degrees << " spin "
                             << spin << " locate " << locate);
              // velocity Verlet at 80 steps: 1.25e-5 in e (case B02), 2.5e-5 in the energy
              CHECK(gain < 2.5e-5);
              worst = std::max(worst, gain);
            }
  CHECK(worst > -1e-3);  // the elastic frictionless ones lose nothing either
}
