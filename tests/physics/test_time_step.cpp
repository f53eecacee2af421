// The time step that the program chooses, and the one it refuses: with loads, several points, strong dampers.
#include <cmath>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

const std::string small_steps_head = R"(title = "s"
material.m = { density = 2600.0, youngs_modulus = "50 MPa", poissons_ratio = 0.25 }
[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "m"
fixed = true
)";

std::string contact(const std::string& law, double restitution, double friction) {
  return "contact = { method = \"smooth\", restitution = " + std::to_string(restitution) +
         ", friction = " + std::to_string(friction) + ", smooth = { law = \"" + law + "\" } }\n";
}

std::string servo(double force) {
  return "{ servo = { force = " + std::to_string(force) + ", direction = [0, 0, -1], mass = 0.01, max_speed = 0.01 } }";
}

/// Three balls on each other between the floor and a plate that moves down.
std::string pressed_balls(const std::string& motion, double radius) {
  const std::string r = std::to_string(radius);
  return small_steps_head + R"(
[[body]]
name = "ball"
repeat = 3
shape = { sphere = { radius = )" +
         r + R"( } }
material = "m"
position = [0, 0, "= )" +
         r + "*(1 + 2*i)" + R"("]
[[body]]
name = "plate"
shape = { half_space = { normal = [0, 0, -1] } }
material = "m"
position = [0, 0, "= 6.1*)" +
         r + R"("]
motion = )" +
         motion + R"(
[[measure]]
name = "plate"
kind = "force"
body = "plate"
interval = 1e-3
)";
}

}  // namespace

TEST_CASE("a step chosen by itself follows the load of a servo wall", "[physics][time_step][long]") {
  Random random(3, 0);
  for (int k = 0; k < 6; ++k) {
    const double force = std::pow(10.0, random.uniform(-1, 1)), e = random.uniform(0, 0.8);
    INFO(force << " N, e = " << e);
    auto run = start_text("run = { duration = 0.5, time_step = \"auto\", output_interval = 0.01 }\n" +
                          contact(k % 2 ? "hertz-mindlin" : "tsuji", e, 0.3) + pressed_balls(servo(force), 0.0015));
    run.advance_to(0);
    CHECK(run.failure.empty());
    CHECK(-run.last("plate", "z") == Approx(-force).epsilon(1e-2));
    CHECK(std::abs(run.energy_error()) < 1e-2);
  }
}

TEST_CASE("a written step that a driven plate makes unstable ends the run with body, contact and step",
          "[physics][time_step]") {
  auto run = start_text("run = { duration = 0.1, time_step = 4e-5, output_interval = 0.01 }\n" +
                        contact("hertz-mindlin", 0.2, 0.3) + pressed_balls("{ velocity = [0, 0, -0.01] }", 0.0015));
  run.advance_to(0);
  CHECK_THAT(run.failure,
             Catch::Contains("the time step of 4e-05 s became unstable in step") && Catch::Contains("'ball["));
}

TEST_CASE("a box on four damped points slides as friction has it", "[physics][time_step]") {
  Random random(5, 0);
  for (int k = 0; k < 4; ++k) {
    const double mu = random.uniform(0.1, 0.5), slope = std::atan(mu) + random.uniform(0.02, 0.2);
    const double e = k % 2 ? 0.0 : 0.3;
    INFO("mu " << mu << ", slope " << slope << ", e " << e);
    char settings[200];
    std::snprintf(settings, sizeof settings,
                  "run = { duration = 0.1, time_step = \"auto\", output_interval = 0.01 }\n"
                  "world = { gravity = [%.9g, 0, %.9g] }\n",
                  9.81 * std::sin(slope), -9.81 * std::cos(slope));
    auto run = start_text(settings + contact("hertz", e, mu) + small_steps_head + R"(
[[body]]
name = "box"
shape = { box = { size = [0.07, 0.05, 0.011] } }
material = "m"
position = [0, 0, 0.0055]
[[measure]]
name = "v"
kind = "velocity"
body = "box"
interval = 0
)");
    run.advance_to(run.assembly->steps / 2);
    const double half_time = run.simulation().world.time, half_speed = run.last("v", "x");
    run.advance_to(0);
    // While it settles, friction is not yet that of its weight: its tangential springs grow with the way that it has
    // slid.
    const double acceleration = (run.last("v", "x") - half_speed) / (run.simulation().world.time - half_time);
    CHECK(acceleration == Approx(9.81 * (std::sin(slope) - mu * std::cos(slope))).epsilon(0.01));
    CHECK(std::abs(run.energy_error()) < 1e-2);
  }
}
