// Stress, solid fraction and profiles of small arrangements whose answers are known.
#include <cmath>
#include <fstream>
#include <numbers>

#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/viz_export/temporary_folder.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

SceneRun run_text(const std::string& text, double duration) {
  const TemporaryFolder folder;
  const std::string path = (folder / "scene.toml").string();
  std::ofstream(path)
      << "title = \"m\"\nrun = { duration = " << duration << ", output_interval = " << duration << " }\n"
      << "material.m = { density = 2500.0, youngs_modulus = \"10 MPa\", poissons_ratio = 0.25 }\n"
      << "contact = { method = \"smooth\", restitution = 0.2, friction = 0.0, smooth = { law = \"hertz\" } }\n"
      << text;
  SceneRun run = prepare_scene(path, {});
  run.simulation().start();
  run.advance_to(0);
  REQUIRE(run.failure.empty());
  return run;
}

}  // namespace

TEST_CASE("a resting column carries its weight: stress of Love and Weber", "[physics][measures]") {
  // three spheres of radius R on a floor, at rest: contacts carry 3, 2, 1 weights over the columns R and 2 R between
  // centres
  auto run = run_text(R"(world = { gravity = [0, 0, -9.81] }
[[body]]
shape = { half_space = { normal = [0, 0, 1] } }
material = "m"
fixed = true
name = "floor"
[[body]]
name = "ball"
repeat = 3
shape = { sphere = { radius = 0.1 } }
material = "m"
position = [0, 0, "= 0.1 + 0.2*i"]
[[measure]]
name = "stress"
kind = "stress"
region = { box = { min = [-0.2, -0.2, -0.1], max = [0.2, 0.2, 0.7] } }
[[measure]]
name = "lowest"
kind = "stress"
region = { box = { min = [-0.2, -0.2, -0.1], max = [0.2, 0.2, 0.1] } }
)",
                      2.0);
  const double weight = 2500 * 4.0 / 3.0 * std::numbers::pi * 1e-3 * 9.81;
  // arms are shorter by the overlaps, below 1e-2 of R at 10 MPa
  CHECK(run.last("lowest", "zz") == Approx(3 * weight * 0.1 / (0.16 * 0.2)).epsilon(1e-2));
  CHECK(run.last("stress", "zz") == Approx(weight * (3 * 0.1 + 2 * 0.2 + 1 * 0.2) / (0.16 * 0.8)).epsilon(1e-2));
  CHECK(run.last("stress", "pressure") == Approx(run.last("stress", "zz") / 3).epsilon(1e-9));
  CHECK(std::abs(run.last("stress", "xy")) < 1e-9);
}

TEST_CASE("solid fraction counts whole and cut bodies, profiles their layers", "[physics][measures]") {
  auto run = run_text(R"(world = { gravity = [0, 0, 0] }
[[body]]
name = "whole"
shape = { sphere = { radius = 0.1 } }
material = "m"
position = [0.5, 0.5, 0.25]
velocity = [1, 0, 0]
[[body]]
name = "half"
shape = { box = { size = [0.1, 0.1, 0.1] } }
material = "m"
position = [0, 0.5, 0.75]
velocity = [0, 2, 0]
[[measure]]
name = "fill"
kind = "solid_fraction"
region = { box = { min = [0, 0, 0], max = [1, 1, 1] } }
[[measure]]
name = "layers"
kind = "profile"
region = { box = { min = [-1, -1, 0], max = [2, 2, 1] } }
bins = 2
)",
                      1e-6);
  const double sphere = 4.0 / 3.0 * std::numbers::pi * 1e-3;
  CHECK(run.last("fill", "fraction") == Approx(sphere + 0.5e-3).epsilon(1e-6));
  CHECK(run.last("fill", "bodies") == 2.0);
  CHECK(run.last("layers", "velocity_x_0") == Approx(1.0));
  CHECK(run.last("layers", "velocity_y_1") == Approx(2.0));
  CHECK(run.last("layers", "density_1") == Approx(2500 * 1e-3 / 4.5));
}
