/// @file rigid.cpp  Stacks, towers of unequal masses, pyramids and piles of polyhedra by the non-smooth solvers: time
/// per step beside what it buys. Usage: perf_rigid [pile.polyset side]... from the root of the sources; without
/// arguments the scenes of the library, with one those whose name begins with it. One thread. Time: mean of the steps'
/// CPU time over the last half (piles: the last 15 %). Overlap: deepest gap of the contacts, seen every 0.1 s, at any
/// time and at the end; drift: farthest that a body has moved sideways from its start; sag: farthest down; v_rms:
/// sqrt(2 T / m) at the end. "stands": no body turned by 15 degrees, moved 0.25 m sideways or sunk 0.5 m.
#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <numeric>

#include "engine/state/hash.h"
#include "engine/step/energy.h"
#include "engine/threads/parallel.h"
#include "scenes/assemble.h"
#include "scenes/full_registry.h"
#include "scenes/processor_time.h"
#include "scenes/reader/scene_reader.h"

namespace {

using namespace epafi;

struct Workload {
  std::string name, scene;
  std::vector<std::string> set;
  double dt = 0.0, duration = 0.0;
  bool pile = false;
};

struct Figures {
  double ms = 0.0, worst = 0.0, at_end = 0.0, mean = 0.0, drift = 0.0, sag = 0.0, speed = 0.0, iterations = 0.0;
  std::size_t points = 0;
  bool stands = true;
};

/// Overlaps relative to 1 m, or in a pile to the sum of the two bodies' radii.
void look_at_overlap(const Assembly& a, bool pile, Figures& f) {
  const Simulation& sim = *a.simulation;
  const ContactSet& c = sim.work.contacts;
  double deepest = 0.0, sum = 0.0;
  std::size_t overlapping = 0;
  const auto radius = [&](Slot s) {
    return sim.world.is_movable(s) ? a.shapes->bounding_radius(ShapeRef{sim.world.shape[s]}) : 0.0;
  };
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (!(c.gap[i] < 0.0)) continue;
    const double size = pile ? radius(c.a[i]) + radius(c.b[i]) : 1.0;
    deepest = std::max(deepest, -c.gap[i] / size);
    sum -= c.gap[i] / size;
    ++overlapping;
  }
  f.worst = std::max(f.worst, deepest);
  f.at_end = deepest;
  f.points = c.size();
  f.mean = overlapping > 0 ? sum / static_cast<double>(overlapping) : 0.0;
}

void look_at_places(const World& world, const std::vector<Vec3>& start, Figures& f) {
  f.drift = f.sag = 0.0;
  for (Slot s = 0; s < world.size(); ++s) {
    if (!world.is_movable(s)) continue;
    const Vec3 moved = world.position[s] - start[static_cast<std::size_t>(world.id[s])];
    f.drift = std::max(f.drift, moved.head<2>().norm());
    f.sag = std::max(f.sag, -moved.z());
    const double tilt =
        world.has_orientation() ? std::acos(std::min(1.0, (world.orientation[s] * Vec3::UnitZ()).z())) : 0.0;
    f.stands = f.stands && tilt < std::numbers::pi / 12 && f.drift < 0.25 && f.sag < 0.5;
  }
}

std::unique_ptr<Assembly> prepared(const std::string& scene, const std::vector<std::string>& set) {
  ReadResult read = read_scene(scene, set, full_registry());
  if (!read.scene) throw SceneError(read.problems);
  auto assembly = assemble(std::move(*read.scene));
  assembly->simulation->start();
  return assembly;
}

void row(const Workload& w, const std::string& solver, int iterations, double tolerance) {
  std::vector<std::string> set = w.set;
  set.push_back("contact.nonsmooth.solver=" + solver);
  set.push_back(fmt::format("contact.nonsmooth.iterations={}", iterations));
  set.push_back(fmt::format("contact.nonsmooth.tolerance={}", tolerance));
  set.push_back(fmt::format("run.time_step={}", w.dt));
  set.push_back(fmt::format("run.duration={}", w.duration));
  const auto assembly = prepared(w.scene, set);
  Simulation& sim = *assembly->simulation;
  std::vector<Vec3> start(sim.world.size());
  for (Slot s = 0; s < sim.world.size(); ++s) start[static_cast<std::size_t>(sim.world.id[s])] = sim.world.position[s];
  Figures f;
  std::vector<double> seconds;
  const auto steps = static_cast<std::uint64_t>(std::llround(w.duration / w.dt));
  const auto look = static_cast<std::uint64_t>(std::max(1.0, std::round(0.1 / w.dt)));
  while (sim.steps() < steps) {
    const double begin = process_seconds();
    if (const auto failure = sim.advance(false)) {
      fmt::print("{:>14} {:>8}: {}\n", w.name, solver, failure->text);
      return;
    }
    seconds.push_back(process_seconds() - begin);
    f.iterations += sim.work.report.solver.iterations / static_cast<double>(steps);
    if (sim.steps() % look != 0) continue;
    look_at_overlap(*assembly, w.pile, f);
    look_at_places(sim.world, start, f);
  }
  double mass = 0.0;
  for (Slot s = 0; s < sim.world.size(); ++s)
    if (sim.world.is_movable(s)) mass += 1.0 / sim.world.inverse_mass[s];
  f.speed = std::sqrt(2.0 * kinetic_energy(sim.world) / mass);
  const auto from =
      seconds.begin() + static_cast<std::ptrdiff_t>(static_cast<double>(seconds.size()) * (w.pile ? 0.85 : 0.5));
  f.ms = 1e3 * std::accumulate(from, seconds.end(), 0.0) / static_cast<double>(seconds.end() - from);
  fmt::print(
      "{:>14} {:>8} {:>5} {:>7.1e} {:>9.3f} {:>7.1f} {:>7} {:>10.2e} {:>10.2e} {:>10.2e} {:>10.2e} {:>10.2e} {:>10.2e} "
      "{:>6} {}\n",
      w.name, solver, iterations, tolerance, f.ms, f.iterations, f.points, f.worst, f.at_end, f.mean,
      w.pile ? 0.0 : f.drift, w.pile ? 0.0 : f.sag, f.speed,
      w.pile     ? "-"
      : f.stands ? "yes"
                 : "NO",
      state_hash(sim.world));
  std::fflush(stdout);
}

/// Mean acceleration of the box of incline/box.toml between 0.5 and 1.5 s [m/s^2].
double slide(double degrees, double azimuth, double dt) {
  const auto a =
      prepared("scenes/library/incline/box.toml",
               {fmt::format("params.angle={}", degrees * std::numbers::pi / 180),
                fmt::format("params.azimuth={}", azimuth), fmt::format("run.time_step={}", dt), "run.duration=1.5",
                "run.output_interval=0.5", "measure.box_velocity.interval=0.5", "measure.creep.interval=0.5"});
  double first = 0.0, last = 0.0;
  const auto steps = std::llround(1.5 / dt), third = std::llround(0.5 / dt);
  for (long long k = 1; k <= steps; ++k) {
    if (a->simulation->advance(false)) return std::nan("");
    const double v = a->simulation->world.velocity[a->simulation->world.is_movable(0) ? 0 : 1].norm();
    if (k == third) first = v;
    last = v;
  }
  return last - first;
}

/// INCLINE: where the box begins to slide (by more than 0.01 m/s^2, which is 0.052 degrees late), and how fast it does.
void incline(double azimuth, double dt) {
  const double g = 9.81, mu = 0.5, threshold = std::atan(mu) * 180 / std::numbers::pi;
  double low = threshold - 12, high = threshold + 12;
  while (high - low > 1e-4) {
    const double middle = 0.5 * (low + high);
    (slide(middle, azimuth, dt) > 0.01 ? high : low) = middle;
  }
  const double late = std::asin(0.01 / (g * std::hypot(1.0, mu))) * 180 / std::numbers::pi;
  fmt::print("INCLINE azimuth {:2} dt 1/{:3.0f}: threshold off by {:+.5f} degrees; acceleration off by", azimuth,
             1 / dt, 0.5 * (low + high) - late - threshold);
  for (const double more : {0.5, 2.0, 5.0}) {
    const double angle = (threshold + more) * std::numbers::pi / 180,
                 exact = g * (std::sin(angle) - mu * std::cos(angle));
    fmt::print(" {:+.1e}", slide(threshold + more, azimuth, dt) / exact - 1.0);
  }
  fmt::print(" at 0.5, 2, 5 degrees above\n");
}

/// BOUNCE: the first three apexes of a ball that falls by 1 m, each from the parabola through its highest places.
void bounce(double e, const std::string& law, double dt) {
  const auto a = prepared("scenes/library/impact/bounce.toml",
                          {fmt::format("params.restitution={}", e), "contact.nonsmooth.impact=" + law,
                           fmt::format("run.time_step={}", dt), fmt::format("measure.height.interval={}", dt)});
  World& world = a->simulation->world;
  const auto height = [&] { return world.position[world.is_movable(0) ? 0 : 1].z() - 0.5; };
  fmt::print("BOUNCE e {} {:>10} dt 1/{:4.0f}: apexes off by", e, law, 1 / dt);
  double h[3] = {height(), height(), height()};
  for (int found = 0; found < 3 && world.time < 10.0;) {
    if (a->simulation->advance(false)) return;
    h[0] = h[1];
    h[1] = h[2];
    h[2] = height();
    if (world.time < 0.4 || h[1] < h[0] || h[1] <= h[2]) continue;
    const double curve = 0.5 * (h[2] - 2.0 * h[1] + h[0]), slope = 0.5 * (h[2] - h[0]);
    fmt::print(" {:+.1e}", (h[1] - 0.25 * slope * slope / curve) / std::pow(e, 2 * ++found) - 1.0);
  }
  fmt::print("\n");
}

void single_bodies() {
  for (const double azimuth : {0.0, 45.0})
    for (const double dt : {1.0 / 60, 1.0 / 240}) incline(azimuth, dt);
  for (const double e : {0.5, 0.9})
    for (const double dt : {1.0 / 60, 1.0 / 240, 1.0 / 1000})
      for (const char* law : {"newton", "sequential"}) bounce(e, law, dt);
}

}  // namespace

int main(int argc, char** argv) {
  set_thread_count(1);
  fmt::print("{:>14} {:>8} {:>5} {:>7} {:>9} {:>7} {:>7} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>6} {}\n",
             "workload", "solver", "it", "tol", "ms/step", "mean it", "points", "overlap", "at end", "mean", "drift m",
             "sag m", "v_rms m/s", "stands", "state");
  const std::string stack = "scenes/library/stacking/stack.toml", pyramid = "scenes/library/stacking/pyramid.toml";
  const std::string pile = "scenes/library/pile/polyhedra.toml";
  if (argc > 2) {
    for (int i = 1; i + 1 < argc; i += 2) {
      const Workload w{
          "POLY-PILE", pile, {fmt::format("bodies.0.file={}", argv[i]), fmt::format("params.side={}", argv[i + 1])},
          1.0 / 240,   4.0,  true};
      for (const int sweeps : {50, 20}) row(w, "pgs", sweeps, 1e-6);
    }
    return 0;
  }
  const Workload work[] = {
      {"STACK-20 60", stack, {"params.n=20"}, 1.0 / 60, 10.0},
      {"STACK-100 240", stack, {"params.n=100"}, 1.0 / 240, 10.0},
      {"MASS-10000 240", "scenes/library/stacking/heavy_boxes.toml", {"params.q=10000"}, 1.0 / 240, 10.0},
      {"PYRAMID-50 60", pyramid, {"params.n=50"}, 1.0 / 60, 5.0},
      {"POLY-PILE-1000", pile, {}, 1.0 / 240, 4.0, true},
  };
  const std::string only = argc > 1 ? argv[1] : "";
  if (only.empty()) single_bodies();
  for (const Workload& w : work) {
    if (!w.name.starts_with(only)) continue;
    row(w, "pgs", 50, 1e-6);
    if (w.pile) row(w, "soft-step", 4, 1e-6);
    if (w.pile) continue;
    if (w.scene == pyramid) row(w, "pgs", 20, 1e-6);  // as deep as the peers' quickest: 2 mm
    for (const double tolerance : {1e-6, 1e-3}) row(w, "newton", 100, tolerance);
    row(w, "auto", 1000, 1e-6);
    row(w, "soft-step", 4, 1e-6);
  }
}
