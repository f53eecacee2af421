#include "scenes/cli/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "engine/state/state_snapshot.h"
#include "engine/threads/parallel.h"
#include "scenes/carry_over.h"
#include "scenes/peak_memory.h"
#include "scenes/predicted_time.h"
#include "scenes/processor_time.h"
#include "scenes/progress.h"
#include "viz_export/output/output_observers.h"
#include "viz_export/vtk/surface.h"

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

/// Triangles, faces and joined vertices of each mesh.
std::string meshes_text(const Assembly& a) {
  std::string out;
  for (const TriangleMesh& m : a.shapes->of<TriangleMesh>()) {
    const std::string joined = m.joined.to_string();
    out += fmt::format("  mesh          {} triangles, {} faces{}{}\n", m.triangles.size(), m.joined.faces,
                       joined.empty() ? "" : "; ", joined);
  }
  return out;
}

/// Number of moving bodies; fills without a written number count as one.
struct Movers {
  double all = 0.0, polyhedra = 0.0, balls = 0.0;  ///< balls: spheres and clumps
  double others = 0.0;                             ///< seconds of all but polyhedra in a smooth packing, a step

  void add(const std::string& type, double number) {
    using namespace predicted;
    static const std::map<std::string, double> prices{
        {"sphere", smooth_sphere},  {"clump", smooth_clump},     {"capsule", smooth_capsule},
        {"cylinder", smooth_round}, {"ellipsoid", smooth_round}, {"superquadric", smooth_superquadric}};
    all += number;
    if (type == "box" || type == "polyhedron" || type == "solid") polyhedra += number;
    if (type == "sphere" || type == "clump") balls += number;
    if (const auto price = prices.find(type); price != prices.end()) others += number * price->second;
  }
};

Movers movers_of(const Scene& scene) {
  Movers out;
  for (const BodySpec& b : scene.bodies)
    if (b.moves()) out.add(scene.shapes[b.shape].type, 1.0);
  for (const FillSpec& f : scene.fills) {
    const double number = f.count ? static_cast<double>(*f.count) : 1.0;
    const double weights = std::accumulate(f.weights.begin(), f.weights.end(), 0.0);
    for (std::size_t k = 0; k < f.shapes.size(); ++k)
      out.add(scene.shapes[f.shapes[k]].type, number * f.weights[k] / weights);
  }
  return out;
}

/// Pairs of spheres in their own loop, which may have taken over the list.
std::size_t listed_spheres(const Simulation& sim) {
  const std::size_t in_loop = sim.work.report.contacts - std::min(sim.work.report.contacts, sim.work.contacts.size());
  return std::max(sim.work.pairs.spheres.size(), in_loop);
}

/// Number of contacts; those of the loop over spheres are not in the set.
double contacts_there(const Simulation& sim) {
  return static_cast<double>(std::max(sim.work.contacts.size(), sim.work.report.touching));
}

/// True where gravity or a cell brings the bodies together.
bool gathers(const Simulation& sim) { return sim.world.gravity != Vec3::Zero() || sim.world.cell; }

/// Share of the contacts of a packing of so many bodies that are still to come.
double share_to_come(const Simulation& sim, double bodies) {
  return gathers(sim) ? std::max(0.0, 1.0 - contacts_there(sim) / std::max(1.0, 2.0 * bodies)) : 0.0;
}

/// Number still to come out of `packed`, with the reserve of columns.
double to_come(const Simulation& sim, double packed, double there) {
  return gathers(sim) ? 1.25 * std::max(0.0, packed - there) : 0.0;
}

/// Peak memory of a run [bytes]: that of this process after the first steps, plus the copy of the state kept for
/// failures, the output, and pairs and contacts of the packed state where the scene starts loose. free: moving bodies,
/// `later` of them poured in later.
double predicted_memory(Assembly& a, std::size_t free, std::size_t later, bool polyhedra) {
  Simulation& sim = *a.simulation;
  const auto held = static_cast<double>(peak_memory());
  ByteCounter state;
  sim.visit(state);
  const auto hulls = static_cast<double>(a.shapes->of<ConvexHull>().size());
  const auto bodies = static_cast<double>(free);
  const double there = contacts_there(sim);
  // a packing has about six neighbours per body, each pair counted once; faces touch in up to four points
  const double contacts = to_come(sim, (polyhedra ? 10.0 : 3.0) * bodies, there);
  const double pairs = to_come(sim, (polyhedra ? 9.0 : 7.0) * bodies,
                               static_cast<double>(sim.work.pairs.pairs.size() + listed_spheres(sim)));
  // where a measure needs contacts of the loop over spheres, these are also in the set
  const auto in_set = static_cast<double>(a.plan.memory.in_set);
  const bool asks = std::ranges::any_of(
      a.scene.measures, [&](const auto& spec) { return a.measure(spec)->wants_contacts() == ContactView::all; });
  const double own = (asks ? in_set + 32.0 : 0.0) + (a.plan.needs.contact_moment ? 190.0 : 60.0);
  const double contact = a.plan.fused_spheres ? own : static_cast<double>(a.plan.memory.contact);
  // HDF5, its cache of shapes in run.h5 (limited by Hdf5File), a frame
  const double output = 6e6 + std::min(8e6, 14e3 * hulls) + (polyhedra ? 2000.0 : 20.0) * bodies;
  // a large copy is written to a scratch file, after lists larger than its pieces were freed
  const double copy = state.total > StateSnapshot::most_in_memory ? 0.0 : static_cast<double>(state.total);
  const double beside =
      a.plan.fused_spheres ? 2.0 : 3.0;  // size of lists over that of the state; the loop over spheres shares some
  return held + copy + output + contacts * contact + pairs * static_cast<double>(a.plan.memory.pair) +
         static_cast<double>(later) * beside * static_cast<double>(a.plan.memory.body);
}

std::string time_text(const PredictedTime& time, const RunCounts& run, double present) {
  if (present < 0.1) return "  wall time     unknown: nearly all bodies enter after the first steps\n";
  return fmt::format(
      "  processor     about {:.3g} s: {:.3g} s of steps and measures (from the first ones and expected contacts), "
      "{:.3g} s of output\n"
      "  wall time     about {} with {} threads if nothing else runs\n",
      time.total(), time.steps, time.output, clock_text(wall_seconds(time.total(), run.bodies, thread_count())),
      thread_count());
}

/// Adds the measures of a run without its files. Returns the mean number per step that read contacts.
double add_measures(Assembly& a) {
  Simulation& sim = *a.simulation;
  double reading = 0.0;
  for (const auto& spec : a.scene.measures) {
    std::unique_ptr<Measure> measure = a.measure(spec);
    if (measure->wants_contacts() != ContactView::none) reading += 1.0 / std::max(1.0, spec.interval / sim.time_step);
    sim.observers.push_back(std::make_unique<MeasureRecorder>(spec.name, std::move(measure), nullptr, nullptr,
                                                              EverySteps::of_time(spec.interval, sim.time_step)));
  }
  return reading;
}

/// Makes the first steps. The second half gives the cost of later ones, since the first ones allocate memory.
std::optional<Failure> time_steps(Simulation& sim, std::uint64_t last, FirstSteps& first) {
  constexpr std::uint64_t most = 3000;
  constexpr double enough = 0.5;  // [s]
  const std::uint64_t from = sim.steps();
  const double start = process_seconds();
  std::vector<double> passed;
  while (sim.steps() < std::min(from + most, last)) {
    if (auto failure = sim.advance()) return failure;
    passed.push_back(process_seconds() - start);
    if (passed.back() > enough && passed.size() > 1) break;
  }
  if (passed.empty()) return {};
  const std::size_t half = (passed.size() - 1) / 2;
  first.seconds = passed.back();
  first.made = static_cast<double>(passed.size());
  first.later = passed.size() > 1 ? (passed.back() - passed[half]) / static_cast<double>(passed.size() - 1 - half)
                                  : passed.back();
  return {};
}

/// Height of the highest free body above the lowest body at the start, against gravity [m].
double height_of_bodies(const World& w) {
  double low = infinity, high = -infinity;
  const Vec3 up = w.gravity == Vec3::Zero() ? Vec3(Vec3::Zero()) : Vec3(-w.gravity.normalized());
  for (Slot s = 0; s < w.size(); ++s) {
    const double h = up.dot(w.position[s]);
    low = std::min(low, h);
    if (w.is_movable(s)) high = std::max(high, h);
  }
  return high > low ? high - low : 0.0;
}

/// Counts of the run before its first steps; loose bodies are counted after these.
RunCounts counts_of(const Assembly& a, double bodies, const Movers& movers) {
  RunCounts run;
  const double duration = static_cast<double>(a.steps) * a.time_step.value;
  run.steps = static_cast<double>(a.steps);
  run.bodies = bodies;
  const bool smooth = a.scene.contact.method.value != Method::nonsmooth;
  const double all = std::max(1.0, movers.all), others = movers.all - movers.polyhedra;
  run.polyhedra = bodies * (smooth ? movers.polyhedra : movers.all - movers.balls) / all;
  if (others > 0.0) run.other = movers.others / others;
  run.outputs = std::min(run.steps, std::floor(duration / a.scene.run.output_interval.value)) + 1.0;
  // solvers that sweep stop at the tolerance in about half of the sweeps they may make
  const double most = a.scene.contact.nonsmooth.number_or("iterations", 50.0);
  if (!smooth) run.sweeps = 0.5 * std::clamp(most, 1.0, 100.0);
  const World& w = a.simulation->world;
  const double e = a.scene.contact.restitution.value;  // not a number where every pair has its own
  run.falling = falling_share(height_of_bodies(w), w.gravity.norm(), duration, e >= 0.0 && e <= 1.0 ? e : 0.0);
  return run;
}

/// Number of surface points in a frame, including bodies still to come.
double drawn_points(const Assembly& a) {
  std::map<std::uint32_t, double> known;
  const auto points = [&](std::uint32_t shape) {
    const auto [at, fresh] = known.try_emplace(shape, 0.0);
    if (fresh) at->second = static_cast<double>(surface_of(*a.shapes, ShapeRef{shape}, 1.0).points.size());
    return at->second;
  };
  double sum = 0.0;
  for (const std::uint32_t shape : a.simulation->world.shape) sum += points(shape);
  for (const auto* source : a.sources)
    for (std::size_t k = source->poured(); k < source->setup().bodies.size(); ++k)
      sum += points(source->setup().bodies[k].body.shape);
  return sum;
}

/// Predicted time of a later stage: its steps cost as much as those of the first in the packed state.
PredictedTime predict_stage(RunCounts run, const FirstSteps& first, const StageCheck& stage, double speed) {
  run.steps = stage.steps;
  run.outputs = stage.outputs;
  run.falling = 0.0;
  FirstSteps lasting = first;
  lasting.start = lasting.seconds = lasting.made = 0.0;
  PredictedTime out = predict_time(run, lasting, speed);
  out.start = 0.0;
  return out;
}

std::string stages_text(const Assembly& a) {
  const auto& stages = a.scene.stages;
  if (stages.size() < 2) return "";
  const bool open = std::ranges::any_of(stages, [](const StageSpec& s) { return s.until.has_value(); });
  return fmt::format("  stages        {}: steps are those of the first stage, times those of all{}\n", stages.size(),
                     open ? "; stages that end by a condition count with at_most" : "");
}

/// Number of bodies that sources have still to add.
std::size_t waiting_bodies(const Assembly& a) {
  std::size_t waiting = 0;
  for (const PourBodies* source : a.sources)
    for (const WaitingBody& body : source->setup().bodies) waiting += a.simulation->world.slot_of(body.id) == no_slot;
  return waiting;
}

/// Number of these that come after the end of a run of one stage.
std::size_t too_late(const Assembly& a) {
  if (a.scene.stages.size() > 1) return 0;
  const double end = static_cast<double>(a.steps) * a.time_step.value;
  std::size_t late = 0;
  for (const PourBodies* source : a.sources)
    late += static_cast<std::size_t>(
        std::ranges::count_if(source->setup().bodies, [&](const WaitingBody& b) { return b.time > end; }));
  return late;
}

std::string waiting_text(std::size_t later, std::size_t late) {
  if (later == 0) return "";
  const std::string some = late > 0 ? fmt::format(", {} of them after its end", late) : "";
  return fmt::format(", {} poured in later{}", later, some);
}

/// Overlap found by the first detection, which stays in the simulation's workspace.
Overlap overlap_at_start(Assembly& a) {
  Simulation& sim = *a.simulation;
  (void)enter_simulation(a);
  if (!sim.pipeline.scheme->needs_initial_forces()) {
    sim.pipeline.broad_phase->find_pairs(sim.world, sim.work.pairs);
    sim.pipeline.narrow_phase->collide(sim.world, sim.work.pairs, sim.work.contacts);
    sim.pipeline.narrow_phase->unite(sim.world, sim.work.contacts);
  }
  return measure_overlap(sim.world, {sim.world, sim.work.contacts, sim.pipeline.contact_model.get()}, *a.shapes);
}

}  // namespace

std::string check_text(Assembly& a, const std::vector<StageCheck>& stages) {
  FirstSteps first{process_seconds()};
  Simulation& sim = *a.simulation;
  const World& w = sim.world;
  const Movers movers = movers_of(a.scene);
  std::vector<BodySpec>().swap(a.scene.bodies);  // as runs do
  std::size_t free = 0;
  for (Slot s = 0; s < w.size(); ++s) free += w.is_movable(s);
  const std::size_t later = waiting_bodies(a);
  const std::string bodies = fmt::format("  bodies        {} free, {} fixed or driven{}\n", free, w.size() - free,
                                         waiting_text(later, too_late(a)));
  const Overlap overlap = overlap_at_start(a);
  const std::string deep = deep_overlap_text(overlap.max_relative);
  std::string out = a.scene.file + (deep.empty() ? ": fine\n" : ": bodies lie in each other\n") + bodies;
  out += fmt::format(
      "  at t = 0      {} candidate pairs, {} contacts, {} pairs overlap, worst {:.3g} m ({:.2g} of the radius)\n",
      sim.work.pairs.pairs.size() + listed_spheres(sim), std::max(sim.work.contacts.size(), sim.work.report.touching),
      overlap.pairs, overlap.max, overlap.max_relative);
  if (!deep.empty()) out += "  OVERLAPS      " + deep + "\n";
  out += solids_text(a) + meshes_text(a);
  out += fmt::format("  time step     {:.6g} s: {}\n", a.time_step.value, a.time_step.reason);
  if (std::isfinite(a.time_step.limit))
    out += fmt::format("  its limit     {:.4g} s{}\n", a.time_step.limit,
                       a.time_step.limit_reason.empty() ? "" : ": " + a.time_step.limit_reason);
  out += fmt::format("  steps         {}\n", a.steps);
  RunCounts run = counts_of(a, static_cast<double>(free + later), movers);
  run.reading = add_measures(a);
  std::optional<Failure> failure;
  with_team(
      [&] { failure = time_steps(sim, a.steps, first); });  // as runs have it: threads do not go between two steps
  if (failure) return out + "  FAILS         " + failure->kind + ": " + failure->text + "\n";
  out += fmt::format("  memory        about {:.0f} MB ({} B per body, {} B per contact)\n",
                     1e-6 * predicted_memory(a, free + later, later, movers.polyhedra > 0.0), a.plan.memory.body,
                     a.plan.memory.contact);
  const double gone = static_cast<double>(sim.bodies_removed());
  const double staying = std::max(1.0, run.bodies - gone);
  run.polyhedra *= staying / std::max(1.0, run.bodies);
  run.bodies = staying;
  run.points = drawn_points(a);
  run.loose = share_to_come(sim, run.bodies);
  first.present = (static_cast<double>(free) - gone) / run.bodies;
  const double speed = machine_speed();
  PredictedTime time = predict_time(run, first, speed);
  for (const StageCheck& stage : stages) {
    const PredictedTime more = predict_stage(run, first, stage, speed);
    time.steps += more.steps;
    time.output += more.output;
  }
  out += time_text(time, run, first.present) + stages_text(a);
  return out;
}

}  // namespace epafi
