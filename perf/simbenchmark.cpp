/// @file simbenchmark.cpp  SimBenchmark's rolling, 666 and bouncing cases (A17, A41) by several solvers: the error of
/// each case beside CPU time. Usage: perf_simbenchmark [seconds of simulated time, default 10; rolling takes 4 at
/// most]. rolling: mean squared velocity error of box and balls; 666: mean over steps of the summed squared overlap;
/// elastic: mean squared energy error. One thread. Published rows of other engines: docs/performance/solvers.md.
#include <fmt/format.h>

#include <cstdlib>

#include "engine/step/energy.h"
#include "engine/threads/parallel.h"
#include "scenes/assemble.h"
#include "scenes/full_registry.h"
#include "scenes/processor_time.h"
#include "scenes/reader/scene_reader.h"

namespace {

using namespace epafi;

/// Sum of squared overlaps of the balls (radius 0.1) with each other and with the ground, at the end of a step.
double squared_overlap(const World& world) {
  double sum = 0.0;
  for (Slot a = 0; a < world.size(); ++a) {
    if (!world.is_movable(a)) continue;
    const double ground = std::max(0.0, 0.1 - world.position[a].z());
    sum += ground * ground;
    for (Slot b = a + 1; b < world.size(); ++b) {
      if (!world.is_movable(b)) continue;
      const double d2 = (world.position[a] - world.position[b]).squaredNorm();
      if (d2 < 0.04) sum += (0.2 - std::sqrt(d2)) * (0.2 - std::sqrt(d2));
    }
  }
  return sum;
}

/// Squared errors of box and one ball against constant accelerations along the force at `time` (steps times dt: the
/// world's own clock is a sum, whose rounding of 3e-13 s after 4000 steps alone would give 1.6e-26).
double rolling_error(const World& world, double time) {
  const Vec3 along = Vec3(1, 1, 0) / std::sqrt(2.0);
  double worst = 0.0, box = 0.0;
  for (Slot s = 0; s < world.size(); ++s) {
    if (!world.is_movable(s)) continue;
    const bool is_box = world.inverse_mass[s] < 0.5;
    const double a = is_box ? 0.7385 : 0.211;
    const double e = (world.velocity[s] - a * time * along).squaredNorm();
    if (is_box)
      box = e;
    else
      worst = std::max(worst, e);
  }
  return box + worst;
}

void row(const std::string& scene, const std::string& solver, const std::string& iterations, double dt, double duration,
         bool elastic, const std::string& impact = "newton") {
  std::vector<std::string> set{"contact.nonsmooth.solver=" + solver, "contact.nonsmooth.iterations=" + iterations,
                               fmt::format("run.time_step={}", dt), fmt::format("run.duration={}", duration)};
  if (elastic && scene != "bouncing") set.push_back("params.restitution=1");
  set.push_back("contact.nonsmooth.impact=" + impact);
  ReadResult read = read_scene("scenes/library/simbenchmark/" + scene + ".toml", set, full_registry());
  if (!read.scene) throw SceneError(read.problems);
  auto assembly = assemble(std::move(*read.scene));
  Simulation& sim = *assembly->simulation;
  sim.start();
  const auto energy = [&] { return kinetic_energy(sim.world) + potential_energy(sim.world); };
  const double first = energy();
  double error = 0.0, seconds = 0.0, iterations_mean = 0.0;
  const auto steps = static_cast<std::uint64_t>(std::llround(duration / dt));
  while (sim.steps() < steps) {
    const double begin = thread_seconds();
    if (sim.advance(false)) return;
    seconds += thread_seconds() - begin;
    const double e = scene == "rolling" ? rolling_error(sim.world, static_cast<double>(sim.steps()) * dt)
                     : elastic          ? (energy() - first) * (energy() - first)
                                        : squared_overlap(sim.world);
    error += e / static_cast<double>(steps);
    iterations_mean += sim.work.report.solver.iterations / static_cast<double>(steps);
  }
  fmt::print("{:>10} {:>12} {:>8} {:>10.3g} {:>8} {:>12.3e} {:>9.3f} {:>10.1f}\n", scene, solver, dt, first,
             elastic ? (impact == "newton" ? "e=1" : "located") : "e=0", error, seconds, iterations_mean);
}

}  // namespace

int main(int argc, char** argv) {
  const double duration = argc > 1 ? std::atof(argv[1]) : 10.0;
  set_thread_count(1);
  fmt::print("{:>10} {:>12} {:>8} {:>10} {:>8} {:>12} {:>9} {:>10}\n", "case", "solver", "dt", "energy J", "", "error",
             "CPU s", "iterations");
  for (const auto& [solver, iterations] :
       {std::pair("pgs", "50"), std::pair("newton", "50"), std::pair("auto", "1000")}) {
    row("rolling", solver, iterations, 1e-3, std::min(4.0, duration), false);
    for (const double dt : {1e-3, 1e-2}) row("balls_666", solver, iterations, dt, duration, false);
    for (const char* impact : {"newton", "sequential"}) {
      row("balls_666", solver, iterations, 1e-3, duration, true, impact);
      row("bouncing", solver, iterations, 1e-3, 2.0 * duration, true, impact);
    }
  }
}
