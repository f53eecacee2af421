#include "scenes/assemble.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "detection/broad/all_broad_phases.h"
#include "detection/continuous/sweep_guard.h"
#include "detection/narrow/narrow_phase.h"
#include "engine/schemes/all_schemes.h"
#include "scenes/carry_over.h"
#include "scenes/contact_setup.h"
#include "scenes/law_potential.h"
#include "scenes/load_poles.h"
#include "scenes/periodic_scene.h"
#include "scenes/placing.h"
#include "scenes/railway/on_rails.h"
#include "scenes/railway/rolling.h"
#include "scenes/sphere_split.h"
#include "scenes/stability_watch.h"
#include "scenes/start_run.h"
#include "scenes/time_step.h"
#include "viz_export/measures/all_measures.h"

namespace epafi {

namespace {

void add_removals(Assembly& a) {
  std::map<std::pair<double, double>, std::vector<BodyId>> by_time;
  for (std::size_t i = 0; i < a.scene.bodies.size(); ++i)
    if (const auto& removal = a.scene.bodies[i].remove_at)
      by_time[{removal->time, a.elapsed(removal->since)}].push_back(a.id_of(i));
  for (auto& [time, bodies] : by_time)
    a.simulation->events.push_back(std::make_unique<RemoveBodies>(bodies, time.first, time.second));
}

/// Gravity, forces and torques that follow time, and constant torques.
void add_loads(Assembly& a) {
  std::vector<BodyLoad> loads;
  for (std::size_t i = 0; i < a.scene.bodies.size(); ++i) {
    const BodySpec& b = a.scene.bodies[i];
    if (!b.load || b.absent) continue;
    loads.push_back(
        {a.id_of(i), b.load->force, b.load->torque, a.elapsed(b.load->since), b.force ? *b.force : Vec3(Vec3::Zero())});
  }
  if (loads.empty() && !a.scene.loose_gravity) return;
  check_loads(a);
  a.simulation->loads =
      std::make_unique<Loads>(Loads::Gravity{a.scene.loose_gravity, a.scene.gravity, a.elapsed(a.scene.gravity_since)},
                              std::move(loads), a.scene.contact.method.value == Method::smooth);
}

void add_outlets(Assembly& a) {
  // non-smooth steps are about 100 times as long as smooth ones, and cost more
  const int steps = a.scene.contact.method.value == Method::smooth ? 50 : 1;
  for (const auto& o : a.scene.outlets)
    a.simulation->events.push_back(std::make_unique<Outlet>(o.name, o.region.min, o.region.max, steps));
}

BroadSetup broad_setup(const Assembly& a) {
  BroadSetup setup;
  setup.shapes = a.shapes.get();
  setup.reach = a.plan.reach;
  for (const auto& row : pair_table())
    for (const auto& cell : row) setup.filter.has_cell.push_back(cell.batch != nullptr);
  setup.spheres.wanted = a.plan.fused_spheres;
  setup.spheres.held = a.plan.fused_held;
  if (a.plan.fused_spheres)
    for (std::size_t k = 0; k < a.scene.bodies.size(); ++k) {
      const auto at = static_cast<std::size_t>(a.id_of(k));
      if (setup.spheres.fixed.size() <= at) setup.spheres.fixed.resize(at + 1);
      setup.spheres.fixed[at] = a.scene.bodies[k].fixed;
    }
  return setup;
}

void set_broad_phase(Assembly& a) {
  const BroadSetup setup = broad_setup(a);
  const World& world = a.simulation->world;
  std::string name = a.scene.detection.broad_phase.value;
  a.plan.broad_phase_reason = "named in the scene";
  if (name == "auto" && !a.sources.empty()) {
    name = "spatial-hash";
    a.plan.broad_phase_reason = "bodies are poured in";
  } else if (name == "auto") {
    const BroadChoice choice = choose_broad_phase(world, setup);
    name = choice.name;
    a.plan.broad_phase_reason = choice.reason;
  }
  a.plan.broad_phase = name;
  std::unique_ptr<BroadPhase> broad_phase = make_broad_phase(name, setup, world);
  auto* list = dynamic_cast<ListBroadPhase*>(broad_phase.get());
  if (list && a.plan.fused_spheres) {
    static_cast<void>(broad_phase.release());  // `list` has it
    broad_phase = std::make_unique<BlockBoundPairs>(std::unique_ptr<ListBroadPhase>(list), a.simulation->pipeline);
  }
  a.simulation->pipeline.broad_phase = std::move(broad_phase);
}

/// Watches the bodies that are `continuous`; null where there are none.
std::unique_ptr<MotionGuard> make_guard(const Assembly& a) {
  std::vector<BodyId> flagged;
  for (std::size_t i = 0; i < a.scene.bodies.size(); ++i)
    if (a.scene.bodies[i].continuous && !a.scene.bodies[i].absent) flagged.push_back(a.id_of(i));
  if (flagged.empty()) return nullptr;
  return std::make_unique<SweepGuard>(*a.shapes, std::move(flagged));
}

Pipeline make_pipeline(Assembly& a) {
  Pipeline p;
  const auto& schemes = all_schemes();
  const auto scheme = std::find_if(schemes.begin(), schemes.end(),
                                   [&](const auto& s) { return s.entry.name == a.scene.run.scheme.value; });
  p.scheme = scheme->make();
  auto narrow_phase =
      std::make_unique<BatchNarrowPhase>(*a.shapes, a.plan.reach, a.plan.needs.curvature, a.plan.needs.area);
  if (!a.plan.needs.area) narrow_phase->join_walls();  // volumes of overlap add up over a seam
  a.narrow_phase = narrow_phase.get();
  p.narrow_phase = std::move(narrow_phase);
  if (a.plan.fused_spheres) {
    auto model = make_fused_spheres(smooth_setup(a.scene), a.plan.reach);
    p.narrow_phase =
        std::make_unique<SphereSplit>(*a.shapes, std::move(p.narrow_phase), *model, broad_setup(a).spheres);
    p.contact_model = std::move(model);
  } else {
    p.contact_model = make_contact_model(a.scene);
  }
  return p;
}

/// Far from the origin positions have few digits left for gaps (case B10).
void warn_of_distance(Assembly& a) {
  const World& world = a.simulation->world;
  double smallest = infinity, farthest = 0.0;
  Place place;
  for (std::size_t k = 0; k < a.scene.bodies.size(); ++k) {
    const Slot s = world.slot_of(a.id_of(k));
    if (s == no_slot || !(world.inverse_mass[s] > 0.0)) continue;
    smallest = std::min(smallest, a.shapes->bounding_radius({world.shape[s]}));
    const double distance = world.position[s].cwiseAbs().maxCoeff();
    if (distance > farthest) {
      farthest = distance;
      place = a.scene.groups[a.scene.bodies[k].group].place;
    }
  }
  const double known = std::nextafter(farthest, infinity) - farthest;
  constexpr double enough = 1e-11;  // of the radius: bodies at rest overlap by 1e-6 and more of it
  if (!(known > enough * smallest)) return;
  a.warnings.push_back(
      {Problem::Level::warning, place,
       fmt::format(
           "bodies stand {:.3g} m from the origin, where positions are known to {:.2g} m: {:.1g} of the smallest "
           "radius, which gaps and contact forces cannot be better than; move the scene to the origin",
           farthest, known, known / smallest)});
}

}  // namespace

BodyIds Assembly::ids(const NamedBodies& named) const {
  BodyIds out;
  for (const auto& [first, count] : named.bodies) {
    if (body_ids.empty()) out.add(id_of(first), count);
    for (std::size_t k = first; !body_ids.empty() && k < first + count; ++k) out.add(id_of(k));
  }
  for (const auto& [fill, one] : named.fills) {
    const auto& all = fill_ids[fill];
    if (!one)
      for (const BodyId body : all) out.add(body);
    else if (*one < all.size())
      out.add(all[*one]);
    else
      throw SceneError(
          fmt::format("'{}[{}]' is not there: the fill has {} bodies", scene.fills[fill].name, *one, all.size()),
          scene.fills[fill].place);
  }
  return out;
}

std::unique_ptr<Measure> Assembly::measure(const MeasureSpec& spec) const {
  MeasureSetup setup{spec.name, spec.parameters, {}, shapes.get(), spec.interval, nullptr};
  for (const auto& bodies : spec.bodies) setup.bodies.push_back(ids(bodies));
  for (const auto& event : simulation->events)
    if (const auto* outlet = dynamic_cast<const Outlet*>(event.get()))
      if (spec.parameters.has("outlet") && outlet->name() == spec.parameters.text("outlet"))
        setup.tally = &outlet->tally();
  const auto entry = std::ranges::find(all_measures(), spec.kind, [](const MeasureEntry& e) { return e.entry.name; });
  EPAFI_REQUIRE(entry != all_measures().end(), "kinds of measures are looked up when a scene is read");
  return entry->make(std::move(setup));
}

namespace {
/// Shapes that some body or fill has; what nothing uses is not built.
std::vector<BuiltShape> build_used(const Scene& scene, ShapeBuilder& builder) {
  std::vector<char> used(scene.shapes.size(), 0);
  for (const BodySpec& b : scene.bodies) used[b.shape] = 1;
  for (const FillSpec& f : scene.fills)
    for (const std::size_t s : f.shapes) used[s] = 1;
  std::vector<BuiltShape> shapes(scene.shapes.size());
  for (std::size_t s = 0; s < shapes.size(); ++s)
    if (used[s] != 0) shapes[s] = builder.build(s);
  return shapes;
}

/// True where all stages run the loop over spheres: friction springs are kept from stage to stage only within one loop.
bool fuses_in_all_stages(const Scene& scene) {
  for (std::size_t k = 0; scene.stage_of && k < scene.stages.size(); ++k) {
    if (k == scene.stage) continue;
    const Scene other = scene.stage_of(k);
    ShapeStore store;
    ShapeBuilder builder(other, store);
    std::vector<BuiltShape> shapes;
    for (std::size_t s = 0; s < other.shapes.size(); ++s) shapes.push_back(builder.build(s));
    if (!plan(other, shapes).fused_spheres) return false;
  }
  return true;
}

/// Number of steps of the whole duration, at least 1.
std::uint64_t count_steps(const RunSettings& run, double time_step) {
  constexpr double most = 1e15;  // counted exactly, times too
  const double steps = std::ceil(run.duration.value / time_step * (1 - 1e-9));
  if (!(steps <= most))
    throw SceneError(fmt::format("[run] duration = {:g} s is {:.3g} time steps of {:g} s; at most {:g} can be counted",
                                 run.duration.value, steps, time_step, most),
                     run.duration.place);
  return static_cast<std::uint64_t>(std::max(1.0, steps));
}
/// Warns of a step longer than the duration: a run makes whole steps.
void warn_of_long_step(Assembly& a) {
  const double duration = a.scene.run.duration.value, step = a.time_step.value;
  const auto& written = a.scene.run.time_step;
  if (!written.value || step <= duration * (1 + 1e-9)) return;
  const std::string warning = fmt::format(
      "[run] time_step = {:g} s is longer than the {:g} s that it is to run: one step is made", step, duration);
  a.warnings.push_back({Problem::Level::warning, written.place, warning});
  a.simulation->warnings.add({.kind = "long step", .text = warning, .value = step, .times = 1});
}

}  // namespace

double Assembly::elapsed(const Since& since) const {
  double all = since.passed;
  for (std::size_t k = since.stage; k < scene.stage && k < clocks.size(); ++k) all += clocks[k];
  return all;
}

namespace {

/// Places all bodies, those of earlier stages first: numbers of bodies do not depend on later stages.
void place_all(Assembly& a, ShapeBuilder& builder, const AssembleOptions& options) {
  a.fill_ids.resize(a.scene.fills.size());
  if (options.keep_fill_bodies || a.scene.stages.size() > 1) a.fill_bodies.resize(a.scene.fills.size());
  const KnownFills known = known_fills(a.scene, options);
  if (!options.place && !a.scene.start) read_principal_axes(a, builder);
  for (std::size_t stage = 0; stage < a.scene.stage; ++stage) {
    add_bodies(a, builder, stage);
    add_known_fills(a, builder, stage, known);
  }
  if (a.scene.stage > 0 && options.place) options.place(a);
  add_bodies(a, builder, a.scene.stage);
  if (a.scene.stage == 0) {
    place_on_rails(a);
    if (options.place)
      options.place(a);
    else if (a.scene.start)
      carry_bodies(carry_of_start(a.scene), a);
  }
  add_fills(a, builder, known, options.places_known);
}

}  // namespace

std::unique_ptr<Assembly> assemble(Scene scene, const AssembleOptions& options) {
  auto a = std::make_unique<Assembly>();
  a->scene = std::move(scene);
  a->clocks = options.clocks;
  a->shapes = std::make_shared<ShapeStore>();
  ShapeBuilder builder(a->scene, *a->shapes);
  a->plan = plan(a->scene, build_used(a->scene, builder), options.may_fuse);
  if (a->plan.fused_spheres && !fuses_in_all_stages(a->scene)) {
    a->plan = plan(a->scene, build_used(a->scene, builder), false);
    a->plan.without_fused_spheres = "stages whose contacts it does not take";
  }
  a->simulation = std::make_unique<Simulation>(World(a->plan.columns), make_pipeline(*a), 0.0);
  Simulation& sim = *a->simulation;
  sim.world.gravity = a->scene.gravity;
  sim.work.contacts.with_curvature = a->plan.needs.curvature;
  sim.work.contacts.with_area = a->plan.needs.area;
  sim.work.contacts.with_moment = a->plan.needs.contact_moment;
  if (a->scene.domain) sim.domain = a->scene.domain->value;
  if (a->scene.cell) sim.world.cell = a->scene.cell->cell;
  const bool starts = a->scene.start && a->scene.stage == 0 && !options.place;
  complete_servos(*a, builder);
  place_all(*a, builder, options);
  a->origins = builder.origins();
  add_loads(*a);
  add_outlets(*a);
  if (a->scene.cell) add_cell(*a);
  sim.pipeline.guard = make_guard(*a);
  add_rolling(*a);
  add_springs(*a);
  add_removals(*a);
  a->warnings.insert(a->warnings.begin(), builder.warnings().begin(), builder.warnings().end());
  for (const Problem& p : contact_problems(a->scene)) a->warnings.push_back(p);  // an error has ended it by now
  warn_of_distance(*a);
  refuse_missing_potential(*a);
  set_broad_phase(*a);
  const bool held = starts && same_mechanics(a->scene.start->made->assembly->scene, a->scene);
  a->time_step = options.time_step ? *options.time_step
                 : held            ? a->scene.start->made->assembly->time_step
                                   : choose_time_step(*a);
  sim.time_step = a->time_step.value;
  if (a->plan.resting_reach < a->plan.reach) a->narrow_phase->follow_motion(sim.time_step, a->plan.resting_reach);
  if (a->scene.run.adaptive)
    sim.parts_of_step = [step = a->time_step, shapes = a->shapes](const World& w) {
      return std::max(step.adaptive ? step.adaptive->parts(w) : 1, parts_by_motion(w, *shapes, step.value));
    };
  sim.step_watch = make_stability_watch(*a);
  a->steps = count_steps(a->scene.run, sim.time_step);
  warn_of_long_step(*a);
  return a;
}

std::string body_name(const Assembly& a, BodyId id) {
  auto k = static_cast<std::size_t>(id);
  if (!a.body_ids.empty())  // ascending inside each stage only
    k = static_cast<std::size_t>(std::find(a.body_ids.begin(), a.body_ids.end(), id) - a.body_ids.begin());
  const bool of_fill = k == a.body_ids.size() && !a.body_ids.empty();
  for (const GroupSpec& group : a.scene.groups)
    if (!of_fill && !group.name.empty() && k >= group.first && k < group.first + group.count)
      return body_name(group, k - group.first);
  for (std::size_t f = 0; f < a.fill_ids.size(); ++f) {  // consecutive ids, in the order of the table
    const auto& ids = a.fill_ids[f];
    if (!ids.empty() && ids.front() <= id && id <= ids.back())
      return fmt::format("{}[{}]", a.scene.fills[f].name,
                         static_cast<std::size_t>(id) - static_cast<std::size_t>(ids.front()));
  }
  return fmt::format("body {}", static_cast<std::size_t>(id));
}

}  // namespace epafi
