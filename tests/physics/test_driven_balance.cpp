// Driven bodies that speed up and slow down: the balance of what they shake.
#include <cmath>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

struct Shaken {
  double frequency, amplitude, e, step;  ///< of the contact time
  std::string law;
};

/// Of the energy that the floor has put in: what the balance of two balls on it is open by.
double open_share(const Shaken& s, const std::string& more = "") {
  const double k = 2e4, mass = 2500 * 4.0 / 3.0 * 3.14159265358979 * 1.25e-7;
  const double contact = 3.14159265358979 * std::sqrt(mass / k);
  auto run = start_text("run = { duration = 0.25, time_step = " + std::to_string(s.step * contact) + R"( }
world = { gravity = [0, 0, -9.81] }
material.m = { density = 2500, youngs_modulus = "5 MPa", poissons_ratio = 0.25 }
contact = { method = "smooth", friction = 0, restitution = )" +
                        std::to_string(s.e) + ", smooth = { law = \"" + s.law + "\"" +
                        (s.law == "linear" ? ", stiffness = 2e4" : "") + R"( } }
[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "m"
motion = { oscillation = { direction = [0, 0, 1], frequency = )" +
                        std::to_string(s.frequency) + ", amplitude = " + std::to_string(s.amplitude) + R"( } }
[[body]]
name = "b"
repeat = 2
shape = { sphere = { radius = 0.005 } }
material = "m"
position = [0, 0, "= 0.005 + 0.01*i"]
[[measure]]
name = "energy"
kind = "energy"
)" + more);
  const auto balance = [&] {
    return run.last("energy", "kinetic") + run.last("energy", "potential") + run.last("energy", "elastic") +
           run.last("energy", "dissipated") - run.last("energy", "work");
  };
  run.advance_to(1);
  const double start = balance();
  run.advance_to(0);
  return (balance() - start) / run.last("energy", "work");
}

}  // namespace

TEST_CASE("the balance of balls on a shaken floor closes, with the square of the step", "[physics][driven]") {
  const auto mean_of = [](const std::string& law, double step, double most) {
    double sum = 0.0;
    for (std::uint32_t draw = 0; draw < 8; ++draw) {
      Random random(17, draw);
      Shaken s{random.uniform(300.0, 1000.0), 0.0, random.uniform(0.1, 0.6), step, law};
      const double omega = 2 * 3.14159265358979 * s.frequency;
      s.amplitude = random.uniform(3.0, 8.0) * 9.81 / (omega * omega);
      INFO("draw " << draw << ": " << s.frequency << " Hz, " << s.amplitude << " m, e " << s.e << ", " << law);
      const double open = std::abs(open_share(s));
      CHECK(open < most);
      sum += open / 8;
    }
    return sum;
  };
  const double hertz = mean_of("hertz", 0.1, 0.025), linear = mean_of("linear", 0.1, 0.09);
  CHECK(mean_of("hertz", 0.05, 0.025 / 4) < 0.3 * hertz);
  CHECK(mean_of("linear", 0.05, 0.1 / 4) < 0.35 * linear);
}

TEST_CASE("it does under a servo plate too, which feels the forces on the floor", "[physics][driven]") {
  const std::string plate = R"([[body]]
name = "plate"
shape = { half_space = { normal = [0, 0, -1] } }
position = [0, 0, 0.0201]
material = "m"
motion = { servo = { force = 0.2, direction = [0, 0, -1], mass = 0.01, max_speed = 0.2 } }
)";
  double sum = 0.0, half = 0.0;
  for (std::uint32_t draw = 0; draw < 6; ++draw) {
    Random random(18, draw);
    Shaken s{random.uniform(200.0, 600.0), random.uniform(2e-6, 8e-6), random.uniform(0.1, 0.6), 0.05, "hertz"};
    INFO("draw " << draw << ": " << s.frequency << " Hz, " << s.amplitude << " m, e " << s.e);
    const double open = std::abs(open_share(s, plate));
    CHECK(open < 0.006);
    s.step *= 0.5;
    sum += open;
    half += std::abs(open_share(s, plate));
  }
  CHECK(half < 0.4 * sum);
}
