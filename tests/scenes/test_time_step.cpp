// The step of non-smooth scenes that write none: it follows size, gravity, motion and output; falling bodies are
// predicted.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "scenes/include/epafi/epafi.h"
#include "scenes/time_step.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

constexpr double g = 9.81;

/// A cube of that size above a floor, by that height. `more`: lines of the cube.
std::string cube(double size, double height, double gravity = g, const std::string& more = "") {
  return fmt::format(
      "run = {{ duration = 5.0 }}\nworld = {{ gravity = [0, 0, {:.17g}] }}\nmaterial.stone = {{ density = 1000.0 }}\n"
      "contact = {{ method = \"nonsmooth\", restitution = 0.0, friction = 0.5 }}\n"
      "[[body]]\nname = \"floor\"\nshape = {{ half_space = {{ normal = [0, 0, 1] }} }}\n"
      "material = \"stone\"\nfixed = true\n"
      "[[body]]\nname = \"cube\"\nshape = {{ box = {{ size = [{:.17g}, {:.17g}, {:.17g}] }} }}\nmaterial = \"stone\"\n"
      "position = [0, 0, {:.17g}]\n{}\n",
      -gravity, size, size, size, 0.5 * size + height, more);
}

double step_of(const std::string& scene, const std::vector<std::string>& overrides = {}) {
  return load_text(scene, overrides)->time_step.value;
}

}  // namespace

TEST_CASE("a non-smooth scene of metres at rest takes 1/60 s, or what divides its output", "[scenes][time_step]") {
  CHECK(step_of(cube(1.0, 0.0)) == Approx(1.0 / 60.0).epsilon(1e-12));
  for (const double interval : {0.5, 0.05, 0.03, 0.01, 1e-3}) {
    const double step = step_of(cube(1.0, 0.0), {fmt::format("run.output_interval={}", interval)});
    CHECK(step <= 1.0 / 60.0 * (1.0 + 1e-12));
    CHECK(interval / step == Approx(std::round(interval / step)).epsilon(1e-12));
  }
  const std::string measured = cube(1.0, 0.0) + "[[measure]]\nname = \"v\"\nkind = \"velocity\"\nbody = \"cube\"\n";
  CHECK(step_of(measured + "interval = 2e-3\n") <= 2e-3 * (1.0 + 1e-12));
  CHECK(step_of(cube(1.0, 0.0), {"run.time_step=1e-4"}) == 1e-4);
}

TEST_CASE("the default step goes by the square root of size over gravity", "[scenes][time_step]") {
  // all lengths times L, gravity times k: times go by sqrt(L / k); steps divide 5 s, which moves them by a step in 5 s
  const double reference = step_of(cube(0.1, 0.3));
  for (const auto& [length, gravity] : {std::pair(0.1, 1.0), {1e-3, 1.0}, {1e-4, 1.0}, {1.0, 10.0}, {1e-2, 100.0}}) {
    const double scale = std::sqrt(length / gravity), step = step_of(cube(0.1 * length, 0.3 * length, g * gravity));
    CHECK(step == Approx(scale * reference).epsilon(2.0 * reference / 5.0));
  }
}

TEST_CASE("what moves, turns and swings shortens the default step, and the reason says so", "[scenes][time_step]") {
  const double size = std::sqrt(3.0);  // of the sphere about the cube
  const auto fast = load_text(cube(1.0, 0.0, g, "velocity = [100, 0, 0]"));
  CHECK(fast->time_step.value <= 0.25 * size / 100.0 * (1.0 + 1e-9));
  CHECK(fast->time_step.value >= 0.24 * size / 100.0);
  CHECK_THAT(chosen_text(*fast), Catch::Contains("as written") && Catch::Contains("solver: adaptive (default)"));
  const auto spun = load_text(cube(1.0, 0.0, g, "angular_velocity = [0, 0, 20]"));
  CHECK(spun->time_step.value == Approx(0.1 / 20.0).epsilon(1e-2));
  CHECK_THAT(spun->time_step.reason, Catch::Contains("turn by 0.1 rad"));
  const std::string shaker =
      "[[body]]\nname = \"table\"\nshape = { box = { size = [1, 1, 1] } }\nmaterial = \"stone\"\nposition = [5, 0, 2]\n"
      "motion = { oscillation = { direction = [1, 0, 0], amplitude = 1e-3, frequency = 10.0 } }\n";
  CHECK(step_of(cube(1.0, 0.0) + shaker) == Approx(1.0 / 400.0).epsilon(1e-2));
}

TEST_CASE("the contact of a falling body is predicted: at the default step it overlaps the floor by next to nothing",
          "[scenes][time_step]") {
  // a contact within reach lets the body come to the floor and no further: gravity over half a step is left, g dt^2 / 2
  for (const double height : {0.05, 0.3, 1.0, 4.0}) {
    INFO("height " << height);
    const auto assembly = load_text(cube(0.1, height));
    const double dt = assembly->time_step.value;
    Simulation& sim = *assembly->simulation;
    double deepest = 0.0;
    while (sim.world.time < 1.0) {
      REQUIRE_FALSE(sim.advance());
      deepest = std::max(deepest, 0.05 - sim.world.position[1].z());
    }
    CHECK(deepest <= g * dt * dt);
    CHECK(sim.world.position[1].z() == Approx(0.05).margin(g * dt * dt));
  }
}

TEST_CASE("a sphere bounces by e^2 of its height at the default step, whatever its size", "[scenes][time_step]") {
  for (const double size : {0.01, 0.1, 1.0})
    for (const double e : {0.5, 0.8, 0.95}) {
      const double height = 3.0 * size, flight = std::sqrt(8.0 * height / g);
      const double end = flight * (0.5 + e + e * e + 0.5 * e * e * e);  // at the top after the third bounce
      const std::string scene = fmt::format(
          "run = {{ duration = {:.17g} }}\nworld = {{ gravity = [0, 0, {:.17g}] }}\n"
          "material.stone = {{ density = 1000.0 }}\n"
          "contact = {{ method = \"nonsmooth\", restitution = {:g}, friction = 0.5 }}\n"
          "[[body]]\nname = \"floor\"\nshape = {{ half_space = {{ normal = [0, 0, 1] }} }}\n"
          "material = \"stone\"\nfixed = true\n"
          "[[body]]\nname = \"ball\"\nshape = {{ sphere = {{ radius = {:.17g} }} }}\nmaterial = \"stone\"\n"
          "position = [0, 0, {:.17g}]\nvelocity = [0.1, 0, 0]\n",
          end, -g, e, 0.5 * size, 0.5 * size + height);
      const auto assembly = load_text(scene);
      Simulation& sim = *assembly->simulation;
      while (sim.world.time < end - 0.5 * assembly->time_step.value) REQUIRE_FALSE(sim.advance());
      INFO("size " << size << " e " << e << " step " << assembly->time_step.value);
      CHECK(sim.world.position[1].z() - 0.5 * size == Approx(height * std::pow(e, 6)).epsilon(1e-9));
    }
}

TEST_CASE("a written step longer than the run is reported, one as long is not", "[scenes][time_step]") {
  for (const double step : {5.0, 5.1}) {
    const auto a = load_text(cube(1.0, 0.0), {fmt::format("run.time_step={}", step)});
    CHECK(a->steps == 1);
    CHECK(a->simulation->warnings.all().size() == (step > 5.0 ? 1u : 0u));
  }
}
