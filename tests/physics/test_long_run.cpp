// What holds for a thousand steps must hold for ten million: energy, momentum, memory, bits.
#include <malloc.h>

#include "engine/threads/parallel.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// Twelve balls that collide for ever in a periodic cell, with friction: a closed system.
const char* gas = R"TOML(
run = { duration = 100.0, time_step = 1e-5, output_interval = 10.0, seed = 5 }
world = { domain = { min = [0, 0, 0], max = [0.05, 0.05, 0.05], periodic = ["x", "y", "z"] } }
material.ball = { density = 1000.0, youngs_modulus = "1 MPa", poissons_ratio = 0.3 }
contact = { method = "smooth", restitution = 1.0, friction = 0.3, smooth = { law = "hertz-mindlin" } }
[[body]]
name = "ball"
repeat = [2, 2, 3]
shape = { sphere = { radius = 0.006 } }
material = "ball"
position = ["= 0.0125 + 0.025*i", "= 0.0125 + 0.025*j + 0.001*k", "= 0.008 + 0.0166*k"]
velocity = ["= 0.3*(i - 0.4)*(k + 0.5)", "= 0.2*(k - j) + 0.1*i", "= 0.25*(j - 0.5) - 0.1*k"]
)TOML";

struct Ending {
  std::string hash, failure;
  double energy_error = 0.0, momentum_error = 0.0;
  std::size_t heap_growth = 0;
};

Ending run_gas(std::uint64_t steps) {
  SceneRun run = start_text(gas, {"run.duration=" + std::to_string(1e-5 * static_cast<double>(steps))});
  const World& w = run.simulation().world;
  const Vec3 before = linear_momentum(w);
  double scale = 0.0;
  for (Slot s = 0; s < w.size(); ++s) scale += w.velocity[s].norm() / w.inverse_mass[s];
  run.advance_to(steps / 2);
  const std::size_t heap = mallinfo2().uordblks;
  run.advance_to(0);
  const std::size_t now = mallinfo2().uordblks;
  return {run.hash(), run.failure, run.energy_error(), (linear_momentum(w) - before).norm() / scale,
          now > heap ? now - heap : 0};
}

void check_gas(std::uint64_t steps) {
  const support::KeepThreads keep;
  set_thread_count(1);
  const Ending one = run_gas(steps);
  set_thread_count(3);
  const Ending three = run_gas(steps);
  INFO(steps << " steps: energy " << one.energy_error << ", momentum " << one.momentum_error << ", heap "
             << one.heap_growth);
  CHECK(one.failure.empty());
  CHECK(std::abs(one.energy_error) < 1e-3);
  // every contact adds equal and opposite rounding: a walk of as many steps as there are, each 1e-16
  CHECK(one.momentum_error < 1e-15 * std::sqrt(static_cast<double>(steps)));
  CHECK(one.heap_growth < 65536);  // columns may still find their largest size; one pointer lost per step is 400 kB
  CHECK(three.hash == one.hash);
}

}  // namespace

TEST_CASE("a hundred thousand steps keep energy, momentum, memory and bits", "[physics][long]") { check_gas(100000); }

TEST_CASE("ten million steps keep energy, momentum, memory and bits", "[physics][long][slow]") { check_gas(10000000); }
