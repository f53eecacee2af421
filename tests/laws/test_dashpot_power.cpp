// Losses of dashpots as they are booked: finite and of the size of forces and velocities, however a contact parts.
#include <algorithm>
#include <cmath>
#include <random>

#include "laws/smooth/damper.h"
#include "tests/support/catch.h"

using namespace epafi;

TEST_CASE("the loss told of a dashpot stays of the size of its forces, in contacts that part too", "[laws][smooth]") {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const double growth : {0.0, 0.25, 0.5, 1.5})
    for (int k = 0; k < 200000; ++k) {
      const double overlap = std::pow(10.0, -9.0 + 6.0 * unit(random)), v = 2.0 * unit(random) - 1.0;
      const double dt = 1e-5, mass = 1e-3, stiffness = 1e6 * unit(random), dashpot = 3.0 * unit(random);
      const double late = v + 0.1 * (unit(random) - 0.5);
      const DamperStep<double> step{dt, 0.5 * dt / mass};
      const DampedContact<double> now{overlap, stiffness * overlap, stiffness, dashpot, growth};
      const double before = overlap + dt * std::abs(v);  // the deepest that the step began with
      const double most = 40.0 * dashpot * std::pow(before / overlap, std::max(1.0, growth));
      const double told = dashpot_power(step, 0.0, late, v, now);
      REQUIRE(std::isfinite(told));
      REQUIRE(std::abs(told) <= most * std::abs(late - v));
    }
}
