#include "scenes/cli/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/parallel.h"
#include "engine/state_snapshot.h"
#include "scenes/carry_over.h"
#include "scenes/peak_memory.h"
#include "scenes/processor_time.h"
#include "scenes/progress.h"

namespace epafi {

namespace {

/// Parts and volume of every shape that was cut from a file.
std::string solids_text(const Assembly& a) {
  std::string out;
  for (const SolidParts& s : a.shapes->of<SolidParts>())
    out += fmt::format(
        "  solid         {} triangles, {} convex parts, volume {:.9g} m^3, moments {:.6g} {:.6g} {:.6g} m^5\n",
        s.surface.triangles.size(), s.parts.size(), s.volume, s.inertia(0, 0), s.inertia(1, 1), s.inertia(2, 2));
  return out;
}

/// What was joined of every mesh.
std::string meshes_text(const Assembly& a) {
  std::string out;
  for (const TriangleMesh& m : a.shapes->of<TriangleMesh>()) {
    const std::string joined = m.joined.to_string();
    out += fmt::format("  mesh          {} triangles, {} faces{}{}\n", m.triangles.size(), m.joined.faces,
                       joined.empty() ? "" : "; ", joined);
  }
  return out;
}

bool polyhedra_move(const Scene& scene) {
  const auto is_polyhedral = [&](std::size_t shape) {
    const std::string& type = scene.shapes[shape].type;
    return type == "box" || type == "polyhedron" || type == "solid";
  };
  return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                     [&](const BodySpec& b) { return b.moves() && is_polyhedral(b.shape); }) ||
         std::any_of(scene.fills.begin(), scene.fills.end(),
                     [&](const FillSpec& f) { return std::any_of(f.shapes.begin(), f.shapes.end(), is_polyhedral); });
}

/// Pairs of spheres in their own loop, which may have taken over the list.
std::size_t listed_spheres(const Simulation& sim) {
  const std::size_t in_loop = sim.work.report.contacts - std::min(sim.work.report.contacts, sim.work.contacts.size());
  return std::max(sim.work.pairs.spheres.size(), in_loop);
}

/// Peak of a run [bytes]: what this process holds after the first steps, and what a run has on top of it: the copy of
/// the state kept for failures, its output, and the pairs and contacts of a packed state, where the scene starts loose
/// and something brings its bodies together. free: bodies that move, `later` of them poured in later.
double predicted_memory(Assembly& a, std::size_t free, std::size_t later, bool polyhedra) {
  Simulation& sim = *a.simulation;
  const auto held = static_cast<double>(peak_memory());
  ByteCounter state;
  sim.visit(state);
  const auto hulls = static_cast<double>(a.shapes->of<ConvexHull>().size());
  const auto bodies = static_cast<double>(free);
  // those that spheres have in their own loop are not in the set
  const auto there = static_cast<double>(std::max(sim.work.contacts.size(), sim.work.report.touching));
  const bool gathers = sim.world.gravity != Vec3::Zero() || sim.world.cell;
  const double loose = gathers ? std::max(0.0, 1.0 - there / std::max(1.0, 2.0 * bodies)) : 0.0;
  // a packing has about six neighbours per body, each pair counted once; faces touch in up to four points
  const double contacts = loose * std::max(0.0, (polyhedra ? 10.0 : 3.0) * bodies - there);
  const double pairs =
      loose * std::max(0.0, (polyhedra ? 9.0 : 7.0) * bodies -
                                static_cast<double>(sim.work.pairs.pairs.size() + listed_spheres(sim)));
  // of spheres in their own loop in the set, where a measure asks for it, beside pair and spring
  const auto in_set = static_cast<double>(a.plan.memory.in_set);
  const bool asks = std::ranges::any_of(
      a.scene.measures, [&](const auto& spec) { return a.measure(spec)->wants_contacts() == ContactView::all; });
  const double own = (asks ? in_set + 32.0 : 0.0) + (a.plan.needs.contact_moment ? 190.0 : 60.0);
  const double contact = a.plan.fused_spheres ? own : static_cast<double>(a.plan.memory.contact);
  const double now_asked = a.plan.fused_spheres && asks ? (in_set + 32.0) * there : 0.0;
  // HDF5, what it remembers of the shapes in run.h5 (32 MB at most), a frame
  const double output = 6e6 + std::min(32e6, 14e3 * hulls) + (polyhedra ? 2000.0 : 20.0) * bodies;
  // a large copy goes to a scratch file, while lists that take more room than its pieces have made way
  const double copy = state.total > StateSnapshot::most_in_memory ? 0.0 : static_cast<double>(state.total);
  const double beside = a.plan.fused_spheres ? 2.0 : 3.0;  // lists beside the state, over it; the loop has it in common
  return held + copy + output + contacts * contact + now_asked + pairs * static_cast<double>(a.plan.memory.pair) +
         static_cast<double>(later) * beside * static_cast<double>(a.plan.memory.body);
}

/// Of the whole run, by the processor seconds that its steps would take with `there` of the `free` bodies. Not by the
/// clock: what else runs on the machine would count.
std::string time_text(double seconds, std::size_t there, std::size_t free) {
  if (10 * there < free)
    return "  wall time     not to be told by the first steps: nearly all bodies are poured in later\n";
  const double all = seconds * static_cast<double>(free) / static_cast<double>(std::max<std::size_t>(1, there));
  return fmt::format(
      "  processor     about {:.3g} s, by the first steps (denser states cost more)\n"
      "  wall time     about {} with {} threads where nothing else runs\n",
      all, clock_text(all / thread_count()), thread_count());
}

/// Processor seconds of a step by the first ones, which are made here: not by the very first, which still ask for
/// memory.
std::optional<Failure> time_steps(Simulation& sim, std::uint64_t last, double& seconds) {
  constexpr std::uint64_t warm = 5, most = 300;
  constexpr double enough = 0.5;  // [s]
  const std::uint64_t first = sim.steps();
  double start = process_seconds();
  std::uint64_t timed = 0;
  while ((timed < 1 || process_seconds() - start < enough) && sim.steps() < std::min(first + most, last)) {
    if (auto failure = sim.advance()) return failure;
    ++timed;
    if (sim.steps() == first + warm && sim.steps() < last) start = process_seconds(), timed = 0;
  }
  seconds = (process_seconds() - start) / static_cast<double>(std::max<std::uint64_t>(1, timed));
  return {};
}

}  // namespace

std::string check_text(Assembly& a) {
  Simulation& sim = *a.simulation;
  const World& w = sim.world;
  const bool polyhedra = polyhedra_move(a.scene);
  std::vector<BodySpec>().swap(a.scene.bodies), give_back_heap();  // as runs do
  std::size_t free = 0;
  for (Slot s = 0; s < w.size(); ++s) free += w.is_movable(s);
  const std::size_t later = w.ids_given() - w.size();
  std::string out = fmt::format("{}: fine\n  bodies        {} free, {} fixed or driven{}\n", a.scene.file, free,
                                w.size() - free, later > 0 ? fmt::format(", {} poured in later", later) : "");
  (void)enter_simulation(a);
  if (!sim.pipeline.scheme->needs_initial_forces()) {
    sim.pipeline.broad_phase->find_pairs(sim.world, sim.work.pairs);
    sim.pipeline.narrow_phase->collide(sim.world, sim.work.pairs, sim.work.contacts);
  }
  const Overlap overlap = measure_overlap(w, {w, sim.work.contacts, sim.pipeline.contact_model.get()}, *a.shapes);
  out += fmt::format(
      "  at t = 0      {} candidate pairs, {} contacts, {} pairs overlap, worst {:.3g} m ({:.2g} of the radius)\n",
      sim.work.pairs.pairs.size() + listed_spheres(sim), std::max(sim.work.contacts.size(), sim.work.report.touching),
      overlap.pairs, overlap.max, overlap.max_relative);
  out += solids_text(a) + meshes_text(a);
  out += fmt::format("  time step     {:.6g} s: {}\n", a.time_step.value, a.time_step.reason);
  if (std::isfinite(a.time_step.limit))
    out += fmt::format("  its limit     {:.4g} s{}\n", a.time_step.limit,
                       a.time_step.limit_reason.empty() ? "" : ": " + a.time_step.limit_reason);
  out += fmt::format("  steps         {}\n", a.steps);
  double seconds = 0.0;
  std::optional<Failure> failure;
  with_team(
      [&] { failure = time_steps(sim, a.steps, seconds); });  // as runs have it: threads do not go between two steps
  if (failure) return out + "  FAILS         " + failure->kind + ": " + failure->text + "\n";
  out += fmt::format("  memory        about {:.0f} MB ({} B per body, {} B per contact)\n",
                     1e-6 * predicted_memory(a, free + later, later, polyhedra), a.plan.memory.body,
                     a.plan.memory.contact);
  return out + time_text(seconds * static_cast<double>(a.steps), free, free + later);
}

}  // namespace epafi
