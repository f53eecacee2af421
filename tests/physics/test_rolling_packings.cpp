// A moment of fixed size against rolling (type A of Ai et al. 2011) takes energy from packings, whatever number of
// contacts turns a sphere.
#include <fmt/format.h>

#include <random>

#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

TEST_CASE("constant rolling moments give a shaken packing no energy", "[physics][rolling]") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int draw = 0; draw < 6; ++draw) {
    SceneRun run = start_text(fmt::format(R"([run]
duration = 0.06
output_interval = 1.0
[world]
gravity = [0, 0, -9.81]
domain = {{ min = [0, 0, 0], max = [0.05, 0.05, 0.3], periodic = ["x", "y"] }}
[material.a]
density = 2000.0
youngs_modulus = {}
poissons_ratio = 0.2
[contact]
method = "smooth"
restitution = {}
friction = {}
rolling_friction = {}
[contact.smooth]
law = "{}"
{}
rolling = "constant"
[shape.ball]
sphere = {{ radius = 0.004 }}
[[body]]
name = "floor"
shape = {{ half_space = {{ normal = [0, 0, 1] }} }}
material = "a"
motion = {{ oscillation = {{ direction = [0, 0, 1], amplitude = 0.002, frequency = 40 }} }}
[[fill]]
name = "grains"
shape = "ball"
material = "a"
count = 120
size = {{ distribution = "uniform", min = {}, max = 1.0 }}
region = {{ box = {{ min = [0.005, 0.005, 0.013], max = [0.045, 0.045, 0.18] }} }}
)",
                                          1e6 + 3e6 * unit(random), 0.5 + 0.3 * unit(random), 0.3 + 0.5 * unit(random),
                                          0.2 + 0.8 * unit(random), draw % 2 ? "linear" : "hertz-mindlin",
                                          draw % 2 ? "stiffness = 2e4" : "", 0.4 + 0.5 * unit(random)));
    run.advance_to(0);
    INFO(run.failure);
    CHECK(run.failure.empty());
    CHECK(run.energy_error() < 1e-3);  // with a sixth of the spin for each contact 0.02, with the whole 0.2 to 2
  }
}
