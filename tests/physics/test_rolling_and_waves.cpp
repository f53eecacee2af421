// Motions with closed answers over many steps: the domino wave (case A33) and Euler's disk (case A34).
#include <fmt/format.h>

#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// Speed of the wave over sqrt(g h): pitch by the mean time between neighbouring impacts of dominoes 50 to `last`.
double domino_speed(double spacing, int last) {
  SceneRun run = prepare_scene(library("stability/dominoes.toml"), {fmt::format("params.spacing={}", spacing)});
  Simulation& sim = run.simulation();
  sim.start();
  std::vector<double> struck;  // domino 1, 2 ... first turns
  const double h = 0.048, pitch = 0.1575 * h + spacing * h;
  std::vector<Slot> dominoes;
  for (Slot s = 0; s < sim.world.size(); ++s)
    if (sim.world.is_movable(s)) dominoes.push_back(s);
  std::sort(dominoes.begin(), dominoes.end(),
            [&](Slot a, Slot b) { return sim.world.position[a].x() < sim.world.position[b].x(); });
  while (struck.size() <= static_cast<std::size_t>(last) && sim.world.time < 3.0) {
    const auto failure = sim.advance(false);
    INFO((failure ? failure->text : std::string()));
    REQUIRE(!failure);
    while (struck.size() < dominoes.size() && sim.world.angular_velocity[dominoes[struck.size()]].y() > 0.1)
      struck.push_back(sim.world.time);
  }
  REQUIRE(struck.size() > static_cast<std::size_t>(last));
  const double time = (struck[static_cast<std::size_t>(last)] - struck[50]) / (last - 50);
  return pitch / time / std::sqrt(9.81 * h);
}

/// Largest departures of Euler's disk from its steady state: of Omega^2 sin(alpha) = 4 g/R and of the energy, relative.
std::pair<double, double> disk_errors(double alpha, double duration) {
  SceneRun run = prepare_scene(library("stability/euler_disk.toml"),
                               {fmt::format("params.alpha={}", alpha), fmt::format("run.duration={}", duration)});
  Simulation& sim = run.simulation();
  sim.start();
  const World& world = sim.world;
  Slot disk = 0;
  while (!world.is_movable(disk)) ++disk;
  const auto axis = [&] { return Vec3(world.orientation[disk] * Vec3::UnitZ()); };
  const auto heading = [&] { return std::atan2(axis().y(), axis().x()); };
  const auto energy = [&] { return kinetic_energy(world) + potential_energy(world); };
  const double first = energy();
  double turned = 0.0, last = heading(), window = 0.0, tilt = 0.0, worst = 0.0, worst_energy = 0.0;
  int steps = 0;
  while (sim.steps() < run.assembly->steps) {
    if (sim.advance(false)) return {infinity, infinity};
    const double now = heading();
    turned += std::remainder(now - last, 2.0 * M_PI);
    last = now;
    tilt += std::acos(axis().z());
    ++steps;
    worst_energy = std::max(worst_energy, std::abs(energy() / first - 1.0));
    if (steps < 5000) continue;
    window = std::abs(turned) / (steps * sim.time_step);
    worst = std::max(worst, std::abs(window * window * std::sin(tilt / steps) / (4.0 * 9.81 / 0.0375) - 1.0));
    turned = tilt = 0.0;
    steps = 0;
  }
  return {worst, worst_energy};
}

}  // namespace

TEST_CASE("the domino wave has the speed of the leaning train at every spacing (A33)", "[physics][A33][slow]") {
  const double expected[] = {2.259, 1.968, 1.838, 1.756, 1.694, 1.640, 1.594};
  for (const int k : {3, 1, 2, 4, 5, 6, 7}) {
    const double speed = domino_speed(0.1 * k, 58);
    WARN("s/h = 0." << k << ": " << speed << " sqrt(g h)");
    CHECK(speed == Approx(expected[k - 1]).epsilon(0.05));
  }
}

TEST_CASE("Euler's disk keeps its steady state where nothing dissipates (A34)", "[physics][A34]") {
  const auto [relation, energy] = disk_errors(10.0, 2.0);
  CHECK(relation < 0.02);
  CHECK(energy < 1e-3);
}

TEST_CASE("Euler's disk turns for ten seconds at 20, 10, 5 and 3 degrees without loss (A34)", "[physics][A34][slow]") {
  for (const double alpha : {20.0, 10.0, 5.0, 3.0}) {
    INFO(alpha << " degrees");
    const auto [relation, energy] = disk_errors(alpha, 10.0);
    CHECK(relation < 0.02);
    CHECK(energy < 0.01);
  }
}
