#include "scenes/cli/check.h"

#include <fmt/format.h>

#include <chrono>

#include "engine/parallel.h"
#include "scenes/progress.h"

namespace epafi {

namespace {

/// Parts and volume of every shape that was cut from a file.
std::string solids_text(const Assembly& a) {
  std::string out;
  for (const SolidParts& s : a.shapes->of<SolidParts>())
    out += fmt::format("  solid         {} triangles, {} convex parts, volume {:.9g} m^3, moments {:.6g} {:.6g} {:.6g} m^5\n",
                       s.surface.triangles.size(), s.parts.size(), s.volume, s.inertia(0, 0), s.inertia(1, 1), s.inertia(2, 2));
  return out;
}

}  // namespace

std::string check_text(Assembly& a) {
  Simulation& sim = *a.simulation;
  const World& w = sim.world;
  std::size_t free = 0;
  for (Slot s = 0; s < w.size(); ++s) free += w.is_movable(s);
  std::string out =
      fmt::format("{}: fine\n  bodies        {} free, {} fixed or driven\n", a.scene.file, free, w.size() - free);
  sim.start();
  if (!sim.pipeline.scheme->needs_initial_forces()) {
    sim.pipeline.broad_phase->find_pairs(sim.world, sim.work.pairs);
    sim.pipeline.narrow_phase->collide(sim.world, sim.work.pairs, sim.work.contacts);
  }
  const Overlap overlap = measure_overlap(w, sim.work.contacts, *a.shapes);
  out += fmt::format(
      "  at t = 0      {} candidate pairs, {} contacts, {} pairs overlap, worst {:.3g} m ({:.2g} of the radius)\n",
      sim.work.pairs.pairs.size(), sim.work.contacts.size(), overlap.pairs, overlap.max, overlap.max_relative);
  out += solids_text(a);
  out += fmt::format("  time step     {:.6g} s: {}\n", a.time_step.value, a.time_step.reason);
  out += fmt::format("  steps         {}\n", a.steps);
  ByteCounter bytes;
  sim.visit(bytes);
  // the state, its copy kept for failures, pairs and contacts (about six per body once packed), boxes of the broad
  // phase
  const double contacts =
      std::max<double>(static_cast<double>(sim.work.contacts.size()), 6.0 * static_cast<double>(free));
  const double memory = 2.0 * static_cast<double>(bytes.total) +
                        contacts * static_cast<double>(a.plan.bytes_per_contact + 2 * sizeof(Pair)) +
                        400.0 * static_cast<double>(w.size());
  out += fmt::format("  memory        about {:.0f} MB ({} B per body, {} B per contact)\n", 30 + memory / 1e6,
                     a.plan.bytes_per_body, a.plan.bytes_per_contact);
  const auto start = std::chrono::steady_clock::now();
  const std::uint64_t first = sim.steps();
  double elapsed = 0;
  while (elapsed < 0.5 && sim.steps() < first + 100 && sim.steps() < a.steps) {
    if (const auto failure = sim.advance())
      return out + "  FAILS         " + failure->kind + ": " + failure->text + "\n";
    elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  const double per_step = elapsed / static_cast<double>(std::max<std::uint64_t>(1, sim.steps() - first));
  return out + fmt::format("  wall time     about {} with {} threads, by the first steps (denser states cost more)\n",
                           clock_text(per_step * static_cast<double>(a.steps)), thread_count());
}

}  // namespace epafi
