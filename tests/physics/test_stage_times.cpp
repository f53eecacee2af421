// All time of a step stands in a stage of the summary, whatever happens between two steps.
#include <chrono>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

const std::string stages_head = R"(title = "stages"
run = { duration = 1.0, time_step = 5e-5, output_interval = 0.5 }
material.m = { density = 2500.0, youngs_modulus = "5 MPa", poissons_ratio = 0.3 }
contact = { method = "smooth", restitution = 0.6, friction = 0.5, smooth = { law = "hertz-mindlin" } }
shape.ball = { sphere = { radius = 0.0025 } }
)";

std::string fill(int count, const std::string& more) {
  return "[[fill]]\nname = \"g\"\nshape = \"ball\"\nmaterial = \"m\"\ncount = " + std::to_string(count) + "\n" + more;
}

/// Poured in and taken out all the time.
std::string stream(Random& random) {
  return stages_head + "world.gravity = [0, 0, -9.81]\n" +
         fill(900, "method = \"pour\"\nrate = " + std::to_string(random.uniform(1e4, 4e4)) +
                       "\nvelocity = [0, 0, -2]\n"
                       "region = { box = { min = [0, 0, 0.03], max = [0.06, 0.06, 0.06] } }\n") +
         "[[outlet]]\nname = \"hole\"\nregion = { box = { min = [-1, -1, -1], max = [1, 1, 0.01] } }\n";
}

std::string cell(Random& random) {
  const std::string rate = std::to_string(random.uniform(-5.0, -1.0));
  return stages_head +
         "world.domain = { min = [0, 0, 0], max = [0.034, 0.034, 0.034], periodic = [\"x\", \"y\", \"z\"], "
         "strain_rate = [" +
         rate + ", " + rate + ", 2.0] }\n" +
         fill(200, "velocity_deviation = 0.5\nregion = { box = { min = [0, 0, 0], max = [0.034, 0.034, 0.034] } }\n");
}

/// Many driven bodies and few free ones.
std::string driven(Random& random) {
  std::string text = stages_head + "world.gravity = [0, 0, -9.81]\n";
  for (int k = 0; k < 40; ++k)
    text += "[[body]]\nname = \"b" + std::to_string(k) + "\"\nmaterial = \"m\"\nshape = \"ball\"\nposition = [" +
            std::to_string(0.01 * k) +
            ", 0, 0]\nmotion = { rotation = { axis = [0, 0, 1], rate = " + std::to_string(random.uniform(1.0, 20.0)) +
            ", about = [0, 0, 0] } }\n";
  return text + fill(5, "region = { box = { min = [0, 0, 0.03], max = [0.03, 0.03, 0.06] } }\n");
}

}  // namespace

TEST_CASE("the stages of a step add up to its time", "[physics][events]") {
  Random random(65, 6);
  for (const std::string& scene : {stream(random), cell(random), driven(random)}) {
    auto run = start_text(scene);
    Simulation& sim = run.simulation();
    const double before = sim.work.report.seconds.all();
    double took = 0.0;
    for (int k = 0; k < 600; ++k) {
      const auto start = std::chrono::steady_clock::now();
      REQUIRE_FALSE(sim.advance().has_value());
      took += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    const double told = sim.work.report.seconds.all() - before;
    CHECK(told <= took);
    CHECK(told > 0.95 * took);
    CHECK(sim.work.report.seconds[Stage::events] > 0.0);
  }
}
