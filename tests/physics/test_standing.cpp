// Bodies with flat sides rest on a box as on a plane: a standing cylinder stays upright, a lying capsule lies still.
#include <fstream>

#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;

namespace {

struct Rest {
  Vec3 velocity, angular_velocity, axis, position;
};

Rest settle(const std::string& shape, const std::string& turn, double height) {
  const std::string path = std::string(EPAFI_BINARY_DIR) + "/standing.toml";
  std::ofstream(path)
      << "title = \"rest\"\n[run]\nduration = 1.0\ntime_step = 1e-3\n[world]\ngravity = [0, 0, -9.81]\n"
      << "[material.wood]\ndensity = 700\nyoungs_modulus = 1e10\npoissons_ratio = 0.3\n"
      << "[contact]\nmethod = \"nonsmooth\"\nrestitution = 0\nfriction = 0.5\n"
      << "[[body]]\nname = \"table\"\nshape = { box = { size = [2, 2, 0.5] } }\nmaterial = \"wood\"\nfixed = true\n"
      << "[[body]]\nname = \"guest\"\nshape = { " << shape << " }\nmaterial = \"wood\"\neuler_deg = " << turn
      << "\nposition = [0.2, -0.1, " << height << "]\n";
  auto run = experiments::prepare_scene(path, {});
  run.simulation().start();
  run.advance_to(0);
  CHECK(run.failure.empty());
  const World& world = run.simulation().world;
  const Slot s = world.slot_of(BodyId{1});
  return {world.velocity[s], world.angular_velocity[s], world.orientation[s] * Vec3::UnitZ(), world.position[s]};
}

}  // namespace

TEST_CASE("a cylinder that is set down on a box stands", "[physics][standing]") {
  const Rest rest =
      settle("cylinder = { radius = 0.1, length = 0.4 }", "[1, 0, 20]", 0.4525);  // a degree off, 0.7 mm above
  CHECK(rest.axis.z() == Approx(1.0).epsilon(1e-7));
  CHECK(rest.velocity.norm() < 1e-5);
  CHECK(rest.angular_velocity.norm() < 1e-4);
  CHECK(rest.position.z() == Approx(0.45).epsilon(1e-4));
}

TEST_CASE("a capsule that is laid on a box lies still", "[physics][standing]") {
  const Rest rest = settle("capsule = { radius = 0.1, length = 0.4 }", "[0, 89, 0]", 0.354);  // a degree off the level
  CHECK(std::abs(rest.axis.z()) < 1e-4);
  CHECK(rest.velocity.norm() < 1e-5);
  CHECK(rest.angular_velocity.norm() < 1e-4);
  CHECK(rest.position.z() == Approx(0.35).epsilon(1e-4));
}

TEST_CASE("a pile of 1000 stones comes to rest", "[physics][pile][slow]") {
  // 3e4 J at the peak; impulses handed on to points that were only near the old ones kept it at 3e-4 J
  experiments::SceneRun run = experiments::run_scene("pile/polyhedra.toml", {"run.duration=5"});
  REQUIRE(run.failure.empty());
  CHECK(kinetic_energy(run.simulation().world) < 1e-7);
  CHECK(run.energy_error() < 1e-3);
}
