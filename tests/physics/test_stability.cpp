// Exact thresholds of masonry, piles and cards (cases A28 to A32), decided 1 to 2 % on either side, and the tower.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

std::string set(const std::string& key, double value) { return fmt::format("{}={:.12g}", key, value); }

/// Largest displacement of the measured bodies within `duration`.
double moved(const std::string& scene, std::vector<std::string> overrides, double duration) {
  overrides.push_back(set("run.duration", duration));
  auto run = run_scene(scene, overrides);
  CHECK(run.failure.empty());
  return std::max(run.largest("drift", "distance"), run.largest("drift", "sag"));
}

/// n blocks of length 1 on a table, displaced by factor / (2 k) from the one below, counted from the top.
std::string overhang(int n, double factor) {
  std::string text = R"(
run = { duration = 20.0, time_step = 5e-3, output_interval = 1.0 }
world = { gravity = [0, 0, -9.81] }
material.stone = { density = 1000.0, youngs_modulus = "1 GPa", poissons_ratio = 0.2 }
[contact]
method = "nonsmooth"
restitution = 0.0
friction = 0.5
nonsmooth = { solver = "auto", iterations = 2000, tolerance = 1e-9, slop = 0.0 }
[[measure]]
name = "drift"
kind = "drift"
body = "block0"
interval = 0.1
[[body]]
name = "table"
shape = { box = { size = [4, 1, 1] } }
material = "stone"
position = [-2, 0, -0.5]
fixed = true
)";
  double x = -0.5;
  std::vector<double> centre(static_cast<std::size_t>(n));
  for (int k = n; k >= 1; --k) centre[static_cast<std::size_t>(k - 1)] = x += factor / (2.0 * k);
  for (int k = 0; k < n; ++k)
    text += fmt::format(R"([[body]]
name = "block{}"
shape = {{ box = {{ size = [1, 0.5, 0.2] }} }}
material = "stone"
position = [{:.17g}, 0, {:.17g}]
)",
                        k, centre[static_cast<std::size_t>(k)], 0.2 * (n - 1 - k) + 0.1);
  return text;
}

double overhang_moved(int n, double factor) {
  const auto path = std::filesystem::temp_directory_path() / fmt::format("epafi_overhang_{}_{}.toml", n, factor);
  std::ofstream(path) << overhang(n, factor);
  SceneRun run = prepare_scene(path.string(), {});
  std::filesystem::remove(path);
  run.simulation().start();
  run.advance_to(0);
  CHECK(run.failure.empty());
  return std::max(run.largest("drift", "distance"), run.largest("drift", "sag"));
}

}  // namespace

TEST_CASE("four spheres stand or fall at 2 % of both friction thresholds (A28)", "[physics][A28]") {
  const std::string scene = "stability/sphere_pile.toml";
  CHECK(moved(scene, {set("params.mu", 0.317837 * 1.02)}, 60.0) < 1e-4);
  CHECK(moved(scene, {set("params.mu", 0.317837 * 0.98)}, 8.0) > 0.1);
  CHECK(moved(scene, {"params.mu=1", set("params.mu_floor", 0.079459 * 1.02)}, 60.0) < 1e-4);
  CHECK(moved(scene, {"params.mu=1", set("params.mu_floor", 0.079459 * 0.98)}, 8.0) > 0.1);
}

TEST_CASE("two cards stand or slide at 2 % of the friction of the floor (A29)", "[physics][A29]") {
  for (const double beta : {10.0, 20.0, 30.0}) {
    INFO("beta " << beta);
    const double mu = 0.5 * (std::tan(beta * M_PI / 180.0) - 0.004);
    CHECK(moved("stability/cards.toml", {set("params.beta", beta), set("params.mu_floor", 1.02 * mu)}, 5.0) < 1e-9);
    CHECK(moved("stability/cards.toml", {set("params.beta", beta), set("params.mu_floor", 0.98 * mu)}, 5.0) > 0.1);
  }
}

TEST_CASE("two cards stand for a minute, and so does a house of three levels (A29)", "[physics][A29][slow]") {
  for (const double beta : {10.0, 20.0, 30.0}) {
    INFO("beta " << beta);
    const double mu = 0.5 * (std::tan(beta * M_PI / 180.0) - 0.004);
    CHECK(moved("stability/cards.toml", {set("params.beta", beta), set("params.mu_floor", 1.05 * mu)}, 60.0) < 1e-7);
  }
  CHECK(moved("stability/card_house.toml", {}, 60.0) < 1e-6);
}

TEST_CASE("a card house of three levels stands with friction 0.7 and falls with 0.15 (A29)", "[physics][A29][long]") {
  CHECK(moved("stability/card_house.toml", {}, 4.0) < 1e-7);
  CHECK(moved("stability/card_house.toml", {"params.mu=0.15"}, 2.0) > 0.1);
}

TEST_CASE("the harmonic overhang stands at 0.99 and falls at 1.01 of its blocks' offsets (A30)",
          "[physics][A30][long]") {
  for (const int n : {4, 5, 10}) {
    INFO(n << " blocks");
    CHECK(overhang_moved(n, 0.99) < 1e-3);
    CHECK(overhang_moved(n, 1.01) > 1.0);
  }
}

TEST_CASE("twenty overhanging blocks are decided as well (A30)", "[physics][A30][slow]") {
  CHECK(overhang_moved(20, 0.99) < 1e-3);
  CHECK(overhang_moved(20, 1.01) > 1.0);
}

TEST_CASE("an arch of 16 voussoirs stands 2 % above its least thickness and falls 2 % below (A31)",
          "[physics][A31][long]") {
  const std::string scene = "stability/arch.toml";
  CHECK(moved(scene, {set("params.ratio", 0.10708 * 1.02)}, 10.0) < 1e-6);
  CHECK(moved(scene, {set("params.ratio", 0.10708 * 0.98)}, 30.0) > 1.0);
}

TEST_CASE("arches of 8 and 32 voussoirs and their friction are decided within 2 % (A31)", "[physics][A31][slow]") {
  const std::string scene = "stability/arch.toml";
  for (const auto& [n, ratio] : {std::pair(8.0, 0.09997), {32.0, 0.10720}}) {
    INFO(n << " voussoirs");
    CHECK(moved(scene, {set("params.n", n), set("params.ratio", 1.02 * ratio)}, 60.0) < 1e-6);
    CHECK(moved(scene, {set("params.n", n), set("params.ratio", 0.98 * ratio)}, 30.0) > 1.0);
  }
  for (const auto& [ratio, mu] : {std::pair(0.12, 0.38203), {0.15, 0.35191}, {0.20, 0.30918}}) {
    INFO("ratio " << ratio);
    CHECK(moved(scene, {"params.n=32", set("params.ratio", ratio), set("params.mu", 1.02 * mu)}, 60.0) < 1e-6);
    CHECK(moved(scene, {"params.n=32", set("params.ratio", ratio), set("params.mu", 0.98 * mu)}, 30.0) > 0.1);
  }
}

TEST_CASE("the tower of 102 blocks settles by less than a hundredth of a block (A32)", "[physics][A32]") {
  auto run = run_scene("stability/tower.toml", {}, 200);
  CHECK(run.failure.empty());
  CHECK(run.largest("cross_drift", "distance") < 1e-4);
  CHECK(run.largest("cross_drift", "sag") < 1e-4);
}

TEST_CASE("the tower of 102 blocks stands for 60000 steps (A32)", "[physics][A32][slow]") {
  auto run = run_scene("stability/tower.toml");
  CHECK(run.failure.empty());
  CHECK(run.largest("cross_drift", "distance") < 1e-4);
  CHECK(run.largest("front_drift", "distance") < 1e-4);
}

TEST_CASE("a pushed box and the balls on it accelerate exactly (A17)", "[physics][A17]") {
  for (const double angle : {45.0, 60.0}) {
    auto run = run_scene("simbenchmark/rolling.toml", {set("params.angle", angle * M_PI / 180.0), "run.duration=1"});
    const double c = std::cos(angle * M_PI / 180.0), s = std::sin(angle * M_PI / 180.0);
    // squared velocity errors below 1e-10, the gate; an axis-aligned friction pyramid leaves the box at rest
    CHECK(run.last("box_velocity", "x") == Approx(0.7385 * c).margin(1e-6));
    CHECK(run.last("box_velocity", "y") == Approx(0.7385 * s).margin(1e-6));
    CHECK(run.last("ball_velocity", "x") == Approx(0.211 * c).margin(1e-6));
    CHECK(run.last("ball_velocity", "y") == Approx(0.211 * s).margin(1e-6));
  }
}

TEST_CASE("forty-nine elastic balls keep their energy to rounding over 4 s of bouncing (A41)", "[physics][A41]") {
  auto run = prepare_scene(library("simbenchmark/bouncing.toml"), {"run.duration=4"});
  run.simulation().start();
  World& world = run.simulation().world;
  const double first = kinetic_energy(world) + potential_energy(world);
  double worst = 0.0;
  while (world.time < 4.0) {
    REQUIRE(!run.simulation().advance(false));
    worst = std::max(worst, std::abs(kinetic_energy(world) + potential_energy(world) - first));
  }
  CHECK(worst < 1e-12 * first);  // two impacts of each; the best published mean over 20 s is 0.14 J
}

TEST_CASE("a falling cube of 216 elastic balls keeps its energy through every chain of impacts (A41)",
          "[physics][A41]") {
  auto run = prepare_scene(library("simbenchmark/balls_666.toml"), {"params.restitution=1", "run.duration=0.5"});
  run.simulation().start();
  World& world = run.simulation().world;
  const double first = kinetic_energy(world) + potential_energy(world);
  run.advance_to(0);
  CHECK(run.failure.empty());
  // the best published mean squared error is 8.4 J^2 over 10 s; without the release of induced contacts it was 5e4
  CHECK(std::abs(kinetic_energy(world) + potential_energy(world) - first) < 1.0);
}
