// A shot through a thin plate (case B08): without being asked for, detection at the ends of a step misses it; a body
// that is `continuous` bounces. r = 5 mm at 300 m/s, plate of 0.1 mm 1 m away, steps of 1 ms: 0.3 m of way per step.
#include <filesystem>
#include <fstream>

#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;

namespace {

std::string shot(const std::string& name, const std::string& flag, const std::string& method = "nonsmooth") {
  const std::string path = std::string(EPAFI_BINARY_DIR) + "/shot_" + name + ".toml";
  std::ofstream out(path);
  out << "title = \"shot\"\n[run]\nduration = 8e-3\ntime_step = 1e-3\n"
      << "[material.steel]\ndensity = 7800\nyoungs_modulus = 2e11\npoissons_ratio = 0.3\n"
      << "[contact]\nmethod = \"" << method << "\"\nrestitution = 0.5\nfriction = 0\n"
      << "[[body]]\nname = \"plate\"\nshape = { box = { size = [1e-4, 8, 8] } }\nmaterial = \"steel\"\nfixed = true\n"
      << "position = [1.00005, 0, 0]\n"
      << "[[body]]\nname = \"ball\"\nshape = { sphere = { radius = 5e-3 } }\nmaterial = \"steel\"\nposition = [0, 0, "
         "0]\n"
      << "velocity = [300, 40, 0]\n"
      << flag;
  return path;
}

Body end_of(const std::string& scene) {
  auto run = experiments::prepare_scene(scene, {});
  run.simulation().start();
  run.advance_to(0);
  CHECK(run.failure.empty());
  const World& world = run.simulation().world;
  const Slot s = world.slot_of(BodyId{1});  // the ball
  Body ball;
  ball.position = world.position[s];
  ball.velocity = world.velocity[s];
  return ball;
}

}  // namespace

TEST_CASE("a continuous ball bounces off the plate that it would pass (B08)", "[physics][B08]") {
  const Body passed = end_of(shot("plain", ""));
  CHECK(passed.position.x() == Approx(300 * 8e-3));
  const Body held = end_of(shot("held", "continuous = true\n"));
  CHECK(held.velocity.x() == Approx(-150.0).epsilon(1e-9));  // restitution 0.5
  CHECK(held.velocity.y() == Approx(40.0).epsilon(1e-12));   // no friction: it goes on along the plate
  CHECK(held.position.x() < 0.995);
  // It loses the rest of the half step in which it was held, half a step of 0.02 m along the plate.
  CHECK(held.position.y() > 40 * 7.4e-3);
}

TEST_CASE("continuous is for free bodies under impulses, and says so", "[physics][B08]") {
  CHECK_THROWS_WITH(end_of(shot("smooth", "continuous = true\n", "smooth")), Catch::Contains("nonsmooth"));
  CHECK_THROWS_WITH(end_of(shot("fixed", "continuous = true\nfixed = true\n")), Catch::Contains("free bodies"));
}
