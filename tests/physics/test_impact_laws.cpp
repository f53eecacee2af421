// The law of impact as a key of the scene (case A24), and where the three differ.
#include <filesystem>
#include <fstream>

#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

TEST_CASE("the cradle of the library answers as its law of impact says (A24)", "[physics][impact][A24]") {
  const auto run = [](const std::string& law) {
    return run_scene("impact/cradle.toml", {"contact.nonsmooth.impact=" + law});
  };
  const auto sequential = run("sequential");
  CHECK(sequential.last("striker", "x") == Approx(0.0).margin(1e-10));
  CHECK(sequential.last("second", "x") == Approx(0.0).margin(1e-10));
  CHECK(sequential.last("last", "x") == Approx(1.0).epsilon(1e-10));
  for (const std::string law : {"newton", "poisson"}) {
    const auto spread = run(law);
    CHECK(spread.last("striker", "x") == Approx(-0.6).epsilon(1e-9));
    CHECK(spread.last("last", "x") == Approx(0.4).epsilon(1e-9));
  }
}

TEST_CASE("Poisson's law gives back a shock through contacts that did not approach, Newton's does not",
          "[physics][impact]") {
  // Two touching balls meet a wall with 1 m/s; e = 0 at the wall, 1 between them. Compression: impulses 2 m at the wall
  // and m between the balls. Poisson: the latter comes back, the outer ball leaves with 1 m/s. Newton: 1 times an
  // approach of 0.
  const auto path = std::filesystem::temp_directory_path() / "epafi_two_balls.toml";
  std::ofstream(path) << R"(
run = { duration = 0.1, time_step = 1e-3 }
material.ball = { density = 1000.0 }
material.wall = { density = 1000.0 }
[contact]
method = "nonsmooth"
restitution = 1.0
friction = 0.0
nonsmooth = { iterations = 1000, tolerance = 1e-12 }
[[contact.pair]]
between = ["ball", "wall"]
restitution = 0.0
[[body]]
name = "wall"
shape = { half_space = { normal = [1, 0, 0] } }
material = "wall"
fixed = true
[[body]]
name = "inner"
shape = { sphere = { radius = 0.05 } }
material = "ball"
position = [0.06, 0, 0]
velocity = [-1, 0, 0]
[[body]]
name = "outer"
shape = { sphere = { radius = 0.05 } }
material = "ball"
position = [0.16, 0, 0]
velocity = [-1, 0, 0]
[[measure]]
name = "inner"
kind = "velocity"
body = "inner"
[[measure]]
name = "outer"
kind = "velocity"
body = "outer"
)";
  for (const auto& [law, outer] : {std::pair("newton", 0.0), {"poisson", 1.0}}) {
    auto run = prepare_scene(path.string(), {std::string("contact.nonsmooth.impact=") + law});
    run.simulation().start();
    run.advance_to(0);
    INFO(law);
    CHECK(run.failure.empty());
    CHECK(run.last("inner", "x") == Approx(0.0).margin(1e-9));
    CHECK(run.last("outer", "x") == Approx(outer).margin(1e-9));
  }
  std::filesystem::remove(path);
}

namespace {
/// Apexes of the ball of impact/bounce.toml above the floor, from the parabola through the three highest places [m].
std::vector<double> apexes(double e, const std::string& law, const std::string& dt) {
  experiments::SceneRun run = experiments::run_scene(
      "impact/bounce.toml", {"params.restitution=" + std::to_string(e), "contact.nonsmooth.impact=" + law,
                             "run.time_step=" + dt, "run.duration=\"= 1/240\"", "run.output_interval=" + dt});
  Simulation& sim = run.simulation();
  const auto height = [&] {
    for (Slot s = 0; s < sim.world.size(); ++s)
      if (sim.world.is_movable(s)) return sim.world.position[s].z() - 0.5;
    return 0.0;
  };
  std::vector<double> found;
  double h[3] = {height(), height(), height()};
  while (found.size() < 3 && sim.world.time < 5.0) {
    REQUIRE(!sim.advance(false));
    h[0] = h[1], h[1] = h[2], h[2] = height();
    const bool fell = sim.world.time > 0.4;  // the first apex is the start
    if (fell && h[1] >= h[0] && h[1] > h[2]) {
      const double a = 0.5 * (h[2] - 2.0 * h[1] + h[0]), b = 0.5 * (h[2] - h[0]);
      found.push_back(h[1] - 0.25 * b * b / a);
    }
  }
  return found;
}
}  // namespace

TEST_CASE("a bouncing ball returns to e^2 of its height where impacts are located in the step", "[physics][impact]") {
  for (const double e : {0.5, 0.9}) {
    const auto located = apexes(e, "sequential", "\"= 1/240\"");
    REQUIRE(located.size() == 3);
    for (int k = 0; k < 3; ++k)
      CHECK(located[static_cast<std::size_t>(k)] == Approx(std::pow(e, 2 * (k + 1))).epsilon(1e-12));
    // impacts at the middle of the step miss the first apex by more than all three here together
    const auto middle = apexes(e, "newton", "\"= 1/240\"");
    CHECK(std::abs(middle.at(0) - e * e) > 4.0 * std::abs(located[0] - e * e));
  }
}
