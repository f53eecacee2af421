// Springs that pull beside the centre of spheres: their ends turn with the bodies, and what they store is what they
// give back.
#include <fmt/format.h>

#include <cmath>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

std::string vec(Random& random, double size) {
  return fmt::format("[{:.9g}, {:.9g}, {:.9g}]", random.uniform(-size, size), random.uniform(-size, size),
                     random.uniform(-size, size));
}

std::string ball(const std::string& name, double x, Random& random) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nshape = \"ball\"\nmaterial = \"m\"\nposition = [{}, 0, 0]\nvelocity = {}\n"
      "angular_velocity = {}\n",
      name, x, vec(random, 0.02), random.uniform(0.0, 1.0) < 0.5 ? "[0, 0, 0]" : vec(random, 3.0));
}

}  // namespace

TEST_CASE("springs beside the centres of spheres keep their energy", "[physics][spring][energy]") {
  // spheres had no orientation: the arm of a spring stood still while the body turned, and energy came from nowhere
  for (std::uint64_t draw = 0; draw < 16; ++draw) {
    Random random(81, draw);
    const bool linked = draw % 2 == 0, smooth = draw % 4 < 2;
    const auto k = [&] { return std::pow(10.0, random.uniform(1.0, 3.0)); };
    const std::string stiffness = linked ? fmt::format("[{0:.9g}, {0:.9g}, {0:.9g}]", k())
                                         : fmt::format("[{:.9g}, {:.9g}, {:.9g}]", k(), k(), k());
    const std::string text =
        fmt::format(
            "run = {{ duration = 0.5, output_interval = 0.5, time_step = 2e-5 }}\n"
            "material.m = {{ density = 2500, youngs_modulus = 1e6, poissons_ratio = 0.25 }}\n"
            "contact = {{ method = \"{}\", restitution = 0.5, friction = 0 }}\n"
            "shape.ball = {{ sphere = {{ radius = 0.005 }} }}\n",
            smooth ? "smooth" : "nonsmooth") +
        ball("a", 0.0, random) + ball("b", 0.03, random) +
        fmt::format("[[spring]]\nname = \"s\"\nbody = \"a\"\nattachment = {}\n{}stiffness = {}\npreload = {}\n",
                    vec(random, 0.004), linked ? "to = \"b\"\n" : "", stiffness, vec(random, 0.02));
    auto run = start_text(text);
    INFO("draw " << draw << "\n" << text);
    run.advance_to(0);
    REQUIRE(run.failure.empty());
    CHECK(std::abs(run.energy_error()) < 1e-3);
  }
}

TEST_CASE("springs in a straining cell take its work", "[physics][spring][energy]") {
  // the strain moved their ends without work: 0.03 of the energy came from nowhere
  for (std::uint64_t draw = 0; draw < 8; ++draw) {
    Random random(82, draw);
    const auto place = [&] {
      return fmt::format("[{:.9g}, {:.9g}, {:.9g}]", random.uniform(), random.uniform(), random.uniform());
    };
    std::string text = fmt::format(
        "run = {{ duration = 0.1, output_interval = 0.1, time_step = 5e-6 }}\n"
        "[world.domain]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nperiodic = [\"x\", \"y\", \"z\"]\nstrain_rate = {}\n"
        "[material.m]\ndensity = 2600\n[contact]\nmethod = \"smooth\"\nrestitution = 0.5\nfriction = 0\nsmooth = {{ "
        "law = \"linear\", stiffness = 1e3 "
        "}}\n",
        vec(random, 0.5));
    for (const char* name : {"a", "b", "c"})
      text += fmt::format(
          "[[body]]\nname = \"{}\"\nshape.sphere.radius = 0.02\nmaterial = \"m\"\nposition = {}\nvelocity = {}\n", name,
          place(), vec(random, 0.5));
    for (const char* ends : {"body = \"a\"\nto = \"b\"", "body = \"b\"\nto = \"c\"", "body = \"a\""})
      text += fmt::format(
          "[[spring]]\n{}\nattachment = {}\nstiffness = [{:.9g}, {:.9g}, {:.9g}]\ndamping = [{:.9g}, 0, 1]\n", ends,
          vec(random, 0.02), random.uniform(10, 100), random.uniform(10, 100), random.uniform(10, 100),
          random.uniform(0, 2));
    INFO(text);
    SceneRun run = start_text(text);
    run.advance_to(0);
    CHECK(run.failure.empty());
    CHECK(std::abs(run.energy_error()) < 1e-4);
  }
}
