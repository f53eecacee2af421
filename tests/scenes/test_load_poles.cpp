// Poles of loads that follow time: found wherever they lie; bounded functions, jumps included, have none.
#include <cmath>
#include <functional>

#include "engine/units/random.h"
#include "scenes/load_poles.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

TEST_CASE("a pole of first or second order is found at its place", "[scenes][loads]") {
  for (std::uint64_t draw = 0; draw < 200; ++draw) {
    Random random(71, draw);
    const double at = random.uniform(0.01, 0.99), size = std::pow(10.0, random.uniform(-6.0, 6.0));
    const double beside = random.uniform(-1.0, 1.0);
    INFO("draw " << draw << ", at " << at << ", size " << size);
    const auto first = [&](double t) { return size * (1.0 / (t - at) + beside); };
    const auto second = [&](double t) { return -size / ((t - at) * (t - at)); };
    for (const auto& f : {std::function<double(double)>(first), std::function<double(double)>(second)}) {
      const auto pole = find_pole(f, 0.0, 1.0);
      REQUIRE(pole);
      CHECK(*pole == Approx(at).epsilon(1e-6));
    }
  }
}

TEST_CASE("waves, pulses and jumps of any height have no pole", "[scenes][loads]") {
  for (std::uint64_t draw = 0; draw < 200; ++draw) {
    Random random(72, draw);
    const double at = random.uniform(0.1, 0.9), rate = random.uniform(1.0, 3000.0);
    const double size = std::pow(10.0, random.uniform(-6.0, 6.0)), width = std::pow(10.0, random.uniform(-3.0, -1.0));
    INFO("draw " << draw << ", at " << at << ", rate " << rate << ", width " << width);
    CHECK_FALSE(find_pole([&](double t) { return size * std::sin(rate * t); }, 0.0, 1.0));
    CHECK_FALSE(find_pole([&](double t) { return std::sin(rate * t) > 0.0 ? size : -size; }, 0.0, 1.0));
    CHECK_FALSE(find_pole([&](double t) { return t < at ? 0.0 : size; }, 0.0, 1.0));
    CHECK_FALSE(find_pole([&](double t) { return size * std::exp(-std::pow((t - at) / width, 2)); }, 0.0, 1.0));
    CHECK_FALSE(find_pole([&](double t) { return size * (t - at); }, 0.0, 1.0));
  }
}

TEST_CASE("a scene whose force passes its pole within the run is refused with body and time", "[scenes][loads]") {
  const std::string body = "[[body]]\nname = \"b\"\nshape = { sphere = { radius = 0.01 } }\nmaterial = \"m\"\n";
  const std::string head = "run = { duration = 0.1, time_step = 1e-3 }\nmaterial.m = { density = 2500 }\n";
  const std::string contact = "contact = { method = \"nonsmooth\", restitution = 0, friction = 0 }\n";
  const auto started = [&](const char* force, double duration) {
    return start_text(head + contact + body + force, {"run.duration=" + std::to_string(duration)});
  };
  CHECK_THROWS_WITH(started("force = [0, \"= 1/(t - 0.05)\", 0]\n", 0.1),
                    Catch::Contains("force of 'b': component y leaves all measure at t = 0.05 s"));
  CHECK_NOTHROW(started("force = [0, \"= 1/(t - 0.05)\", 0]\n", 0.04));
  CHECK_NOTHROW(started("force = [0, \"= 1/(t - 0.05)\", 0]\n", 0.0499));
}
