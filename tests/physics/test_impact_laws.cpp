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
