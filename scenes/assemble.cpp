#include "scenes/assemble.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "detection/broad/all_broad_phases.h"
#include "detection/broad/periodic_pairs.h"
#include "detection/continuous/sweep_guard.h"
#include "detection/narrow/narrow_phase.h"
#include "engine/schemes/all_schemes.h"
#include "scenes/contact_setup.h"
#include "scenes/generators.h"
#include "scenes/peak_memory.h"
#include "scenes/periodic_scene.h"
#include "scenes/railway/on_rails.h"
#include "scenes/railway/rolling.h"
#include "scenes/sphere_split.h"
#include "scenes/stability_watch.h"
#include "scenes/time_step.h"
#include "viz_export/measures/all_measures.h"

namespace epafi {

namespace {

double density(const Scene& scene, std::size_t material, const Place& place) {
  const Material& m = scene.materials[material].material;
  if (!(m.density > 0)) throw SceneError("a free body needs the density of material '" + m.name + "' (kg/m^3)", place);
  return m.density;
}

/// The body of a shape that may do what it is asked to.
Body make_body(const Assembly& a, const BuiltShape& shape, const BodySpec& spec, const Place& place) {
  Body body;
  body.position = spec.position, body.velocity = spec.velocity, body.angular_velocity = spec.angular_velocity;
  body.shape = shape.ref.packed, body.material = static_cast<std::uint16_t>(spec.material);
  body.orientation = spec.orientation * shape.frame.orientation;
  if (spec.force) body.external_force = *spec.force;
  if (!spec.moves()) return body;
  const double rho = shape.mass > 0 ? 1.0 : density(a.scene, spec.material, place);
  body.mass = shape.mass > 0 ? shape.mass : rho * shape.volume, body.inertia = rho * shape.frame.moments;
  return body;
}

BodyId add_body(Assembly& a, const BuiltShape& shape, const BodySpec& spec, const Place& place) {
  const BodyId id = a.simulation->world.add(make_body(a, shape, spec, place));
  auto& events = a.simulation->events;
  if (spec.motion) events.push_back(std::make_unique<DriveBody>(id, *spec.motion, spec.position));
  if (spec.servo) events.push_back(std::make_unique<ServoWall>(id, *spec.servo));
  return id;
}

void add_bodies(Assembly& a, ShapeBuilder& builder) {
  const auto& bodies = a.scene.bodies;
  a.simulation->world.reserve(bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const BodySpec& b = bodies[k];
    const Place& place = a.scene.groups[b.group].place;
    const BuiltShape shape = builder.build(b.shape, b.size);
    if (b.moves() && !shape.is_solid)
      throw SceneError(fmt::format("body '{}': shape '{}' has no volume of its own; make it fixed or give it a motion",
                                   body_name(a.scene, k), a.scene.shapes[b.shape].type),
                       place);
    [[maybe_unused]] const BodyId id = add_body(a, shape, b, place);
    EPAFI_REQUIRE(id == Assembly::body_id(k), "the bodies of a scene come first");
    if (k % many_bodies == many_bodies - 1) a.simulation->world.rest_forces();  // 48 bytes each
  }
}

void add_removals(Assembly& a) {
  std::map<double, std::vector<BodyId>> by_time;
  for (std::size_t i = 0; i < a.scene.bodies.size(); ++i)
    if (a.scene.bodies[i].remove_at) by_time[*a.scene.bodies[i].remove_at].push_back(Assembly::body_id(i));
  for (auto& [time, bodies] : by_time) a.simulation->events.push_back(std::make_unique<RemoveBodies>(bodies, time));
}

/// What a source pours: each body at its time.
struct Stream {
  PourBodies::Setup setup;
  double time = 0.0;
};

void add_fill(Assembly& a, ShapeBuilder& builder, const FillSpec& fill) {
  std::vector<FillShape> shapes;
  for (std::size_t s : fill.shapes) {
    const BuiltShape b = builder.build(s);
    if (!b.is_solid) throw SceneError("shape '" + a.scene.shapes[s].type + "' cannot fill a region", fill.place);
    shapes.push_back(
        {b.radius, b.mass > 0 ? b.mass : density(a.scene, fill.material, fill.place) * b.volume, b.is_sphere});
  }
  const FillResult result = generate(fill, shapes);
  if (!result.shortfall.empty())
    throw SceneError("[[fill]]: " + result.shortfall + "; enlarge the region or ask for less", fill.place);
  Stream stream{{fill.name, {}, fill.region.min, fill.region.max, fill.seed, {}}, fill.from};
  auto& ids = a.fill_ids.emplace_back();
  ids.reserve(result.bodies.size());
  if (fill.method != FillSpec::Method::pour)
    a.simulation->world.reserve(a.simulation->world.size() + result.bodies.size());
  for (std::size_t k = 0; k < result.bodies.size(); ++k) {
    const FillBody& f = result.bodies[k];
    BodySpec spec;
    spec.shape = fill.shapes[f.shape], spec.material = fill.material;
    spec.position = f.position, spec.orientation = f.orientation;
    spec.velocity = fill.velocity + f.velocity;
    const BuiltShape shape = builder.build(spec.shape, f.size);
    if (fill.method != FillSpec::Method::pour) {
      ids.push_back(add_body(a, shape, spec, fill.place));
      continue;
    }
    if (((fill.region.max - fill.region.min).array() < 2 * shape.radius).any())
      throw SceneError("[[fill]]: a body is larger than the region it is poured into", fill.place);
    ids.push_back(a.simulation->world.reserve());
    const Body body = make_body(a, shape, spec, fill.place);
    stream.setup.bodies.push_back({body, ids.back(), stream.time, shape.radius});
    stream.time += fill.rate > 0 ? 1.0 / fill.rate : body.mass / fill.mass_rate;
  }
  if (stream.setup.bodies.empty()) return;
  stream.setup.radius = [store = a.shapes](std::uint32_t shape) { return store->bounding_radius({shape}); };
  auto source = std::make_unique<PourBodies>(std::move(stream.setup));
  a.sources.push_back(source.get());
  a.simulation->events.push_back(std::move(source));
}

void add_outlets(Assembly& a) {
  for (const auto& o : a.scene.outlets)
    a.simulation->events.push_back(std::make_unique<Outlet>(o.name, o.region.min, o.region.max));
}

BroadSetup broad_setup(const Assembly& a) {
  BroadSetup setup;
  setup.shapes = a.shapes.get();
  setup.reach = a.plan.reach;
  for (const auto& row : pair_table())
    for (const auto& cell : row) setup.filter.has_cell.push_back(cell.batch != nullptr);
  setup.spheres.wanted = a.plan.fused_spheres;
  if (a.plan.fused_spheres)
    for (const auto& b : a.scene.bodies) setup.spheres.fixed.push_back(b.fixed);
  return setup;
}

void set_broad_phase(Assembly& a) {
  const BroadSetup setup = broad_setup(a);
  const World& world = a.simulation->world;
  std::string name = a.scene.detection.broad_phase.value;
  a.plan.broad_phase_reason = "named in the scene";
  if (name == "auto" && !a.sources.empty()) {
    name = "spatial-hash", a.plan.broad_phase_reason = "bodies are poured in";
  } else if (name == "auto") {
    const BroadChoice choice = choose_broad_phase(world, setup);
    name = choice.name, a.plan.broad_phase_reason = choice.reason;
  }
  a.plan.broad_phase = name;
  std::unique_ptr<BroadPhase> broad_phase;
  if (world.cell) {
    BroadSetup inner = setup;
    inner.spheres.wanted = false;
    broad_phase = std::make_unique<PeriodicPairs>(setup, make_broad_phase(name, inner, world));
  } else {
    broad_phase = make_broad_phase(name, setup, world);
    auto* list = dynamic_cast<ListBroadPhase*>(broad_phase.get());
    if (list && a.plan.fused_spheres) {
      static_cast<void>(broad_phase.release());  // `list` has it
      broad_phase = std::make_unique<WornPairs>(std::unique_ptr<ListBroadPhase>(list), a.simulation->pipeline);
    }
  }
  a.simulation->pipeline.broad_phase = std::move(broad_phase);
}

/// Watches the bodies that are `continuous`; null where there are none.
std::unique_ptr<MotionGuard> make_guard(const Assembly& a) {
  std::vector<BodyId> flagged;
  for (std::size_t i = 0; i < a.scene.bodies.size(); ++i)
    if (a.scene.bodies[i].continuous) flagged.push_back(Assembly::body_id(i));
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
    const Slot s = world.slot_of(Assembly::body_id(k));
    if (!(world.inverse_mass[s] > 0.0)) continue;
    smallest = std::min(smallest, a.shapes->bounding_radius({world.shape[s]}));
    const double distance = world.position[s].cwiseAbs().maxCoeff();
    if (distance > farthest) farthest = distance, place = a.scene.groups[a.scene.bodies[k].group].place;
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
  for (const auto& [first, count] : named.bodies) out.add(body_id(first), count);
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
/// Refuses numbers of bodies before they take what is not there.
void require_memory(const Scene& scene, const StepPlan& plan) {
  double bodies = static_cast<double>(scene.bodies.size());
  for (const FillSpec& fill : scene.fills) {
    bodies += static_cast<double>(fill.count.value_or(0));
    const double bytes = bodies * static_cast<double>(plan.memory.body + sizeof(FillBody));
    if (const auto there = static_cast<double>(memory_there()); bytes > there)
      throw SceneError(fmt::format("[[fill]] '{}': {:g} bodies take {:.3g} GB at least; {:.3g} GB are there", fill.name,
                                   bodies, 1e-9 * bytes, 1e-9 * there),
                       fill.place);
  }
}

/// Of the whole duration, one at least.
std::uint64_t count_steps(const RunSettings& run, double time_step) {
  constexpr double most = 1e15;  // counted exactly, times too
  const double steps = std::ceil(run.duration.value / time_step * (1 - 1e-9));
  if (!(steps <= most))
    throw SceneError(fmt::format("[run] duration = {:g} s is {:.3g} time steps of {:g} s; at most {:g} can be counted",
                                 run.duration.value, steps, time_step, most),
                     run.duration.place);
  return static_cast<std::uint64_t>(std::max(1.0, steps));
}
}  // namespace

std::unique_ptr<Assembly> assemble(Scene scene) {
  auto a = std::make_unique<Assembly>();
  a->scene = std::move(scene);
  a->shapes = std::make_shared<ShapeStore>();
  ShapeBuilder builder(a->scene, *a->shapes);
  std::vector<BuiltShape> shapes;
  for (std::size_t s = 0; s < a->scene.shapes.size(); ++s) shapes.push_back(builder.build(s));
  a->plan = plan(a->scene, shapes);
  require_memory(a->scene, a->plan);
  a->simulation = std::make_unique<Simulation>(World(a->plan.columns), make_pipeline(*a), 0.0);
  Simulation& sim = *a->simulation;
  sim.world.gravity = a->scene.gravity;
  sim.work.contacts.with_curvature = a->plan.needs.curvature;
  sim.work.contacts.with_area = a->plan.needs.area;
  sim.work.contacts.with_moment = a->plan.needs.contact_moment;
  if (a->scene.domain) sim.domain = a->scene.domain->value;
  if (a->scene.cell) sim.world.cell = a->scene.cell->cell;
  add_bodies(*a, builder);
  place_on_rails(*a);
  for (const auto& f : a->scene.fills) add_fill(*a, builder, f);
  add_outlets(*a);
  if (a->scene.cell) add_cell(*a);
  sim.pipeline.guard = make_guard(*a);
  add_rolling(*a);
  add_springs(*a);
  add_removals(*a);
  a->warnings = builder.warnings();
  warn_of_distance(*a);
  set_broad_phase(*a);
  a->time_step = choose_time_step(*a);
  sim.time_step = a->time_step.value;
  if (a->plan.resting_reach < a->plan.reach) a->narrow_phase->follow_motion(sim.time_step, a->plan.resting_reach);
  sim.parts_of_step = a->time_step.parts;
  sim.step_watch = make_stability_watch(*a);
  a->steps = count_steps(a->scene.run, sim.time_step);
  return a;
}

std::string body_name(const Assembly& a, BodyId id) {
  const auto k = static_cast<std::size_t>(id);
  for (const GroupSpec& group : a.scene.groups)
    if (!group.name.empty() && k >= group.first && k < group.first + group.count)  // ids are given in this order
      return body_name(group, k - group.first);
  for (std::size_t f = 0; f < a.fill_ids.size(); ++f) {  // consecutive ids, in the order of the table
    const auto& ids = a.fill_ids[f];
    if (!ids.empty() && ids.front() <= id && id <= ids.back())
      return fmt::format("{}[{}]", a.scene.fills[f].name, k - static_cast<std::size_t>(ids.front()));
  }
  return fmt::format("body {}", k);
}

}  // namespace epafi
