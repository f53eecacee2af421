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
#include "scenes/held_probe.h"
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
  if (spec.as_drawn) body.position += spec.orientation * shape.frame.centre;
  if (spec.force) body.external_force = *spec.force;
  if (!spec.moves()) return body;
  const double rho = shape.mass > 0 ? 1.0 : density(a.scene, spec.material, place);
  body.mass = shape.mass > 0 ? shape.mass : rho * shape.volume, body.inertia = rho * shape.frame.moments;
  return body;
}

BodyId add_body(Assembly& a, const BuiltShape& shape, const BodySpec& spec, const Place& place) {
  const Body body = make_body(a, shape, spec, place);
  const BodyId id = a.simulation->world.add(body);
  auto& events = a.simulation->events;
  if (spec.motion) events.push_back(std::make_unique<DriveBody>(id, *spec.motion, body.position));
  if (spec.servo) events.push_back(std::make_unique<ServoWall>(id, *spec.servo));
  return id;
}

/// Free bodies that stand outside the domain from the start are lost or taken out at once: said before it happens.
void look_for_outsiders(Assembly& a, const std::string& table, BodyId first, std::size_t count, const Place& where) {
  const World& world = a.simulation->world;
  std::size_t outside = 0;
  for (std::size_t k = 0; a.simulation->domain && k < count; ++k) {
    const Slot s = world.slot_of(static_cast<BodyId>(static_cast<std::size_t>(first) + k));
    outside += world.is_movable(s) && !a.simulation->domain->contains(world.position[s]);
  }
  if (outside == 0) return;
  const std::string text = fmt::format("{}: {} of {} bodies stand outside [world] domain", table, outside, count);
  if (a.simulation->domain->outside == Domain::Outside::error)
    throw SceneError(text + ", where outside = \"error\" ends the run; move them or enlarge the domain", where);
  const std::string told = text + ", where outside = \"delete\" takes them out at once";
  a.warnings.push_back({Problem::Level::warning, where, told});
  a.simulation->warnings.add(
      {.kind = "outside " + table, .text = told, .value = static_cast<double>(outside), .times = 1});
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
  for (const GroupSpec& g : a.scene.groups)
    look_for_outsiders(a, "[[body]] '" + g.name + "'", Assembly::body_id(g.first), g.count, g.place);
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

std::vector<FillShape> shapes_of(const Assembly& a, ShapeBuilder& builder, const FillSpec& fill) {
  std::vector<FillShape> shapes;
  for (std::size_t s : fill.shapes) {
    const BuiltShape b = builder.build(s);
    if (!b.is_solid) throw SceneError("shape '" + a.scene.shapes[s].type + "' cannot fill a region", fill.place);
    shapes.push_back(
        {b.radius, b.mass > 0 ? b.mass : density(a.scene, fill.material, fill.place) * b.volume, b.is_sphere});
  }
  return shapes;
}

/// Refuses amounts of a fill before they take memory that is not there.
void require_memory(const Assembly& a, const FillSpec& fill, const std::vector<FillShape>& shapes) {
  const double bodies = static_cast<double>(a.simulation->world.ids_given()) + most_bodies_of(fill, shapes);
  const double bytes = bodies * static_cast<double>(a.plan.memory.body + sizeof(FillBody));
  if (const auto there = static_cast<double>(memory_there()); bytes > there)
    throw SceneError(fmt::format("[[fill]] '{}': {:.3g} bodies take {:.3g} GB at least; {:.3g} GB are there", fill.name,
                                 bodies, 1e-9 * bytes, 1e-9 * there),
                     fill.place);
}

BodySpec spec_of(const FillSpec& fill, const FillBody& f) {
  BodySpec spec;
  spec.shape = fill.shapes[f.shape], spec.size = f.size, spec.material = fill.material;
  spec.position = f.position, spec.orientation = f.orientation;
  spec.velocity = fill.velocity + f.velocity;
  return spec;
}

/// The region reaches as far as the cell along a periodic axis, or further: bodies may meet images of each other.
bool meets_images(const Scene& scene, const FillSpec& fill) {
  for (int k = 0; scene.cell && k < 3; ++k)
    if (scene.cell->cell.repeats[static_cast<std::size_t>(k)] &&
        fill.region.max[k] - fill.region.min[k] > scene.cell->cell.size[k] * (1 + 1e-12))
      return true;
  return false;
}

/// What is in the world already, for the fills, which ask in the order of the scene.
struct Placing {
  Occupancy occupied;
  HeldProbe held;
  explicit Placing(const Assembly& a) : occupied(a.simulation->world.cell), held(*a.shapes) {
    if (a.scene.fills.empty()) return;
    const World& world = a.simulation->world;
    for (Slot s = 0; s < world.size(); ++s)
      if (world.is_movable(s)) occupied.add(world.position[s], a.shapes->bounding_radius({world.shape[s]}));
  }
};

FillResult place_bodies(Assembly& a, ShapeBuilder& builder, const FillSpec& fill, const std::vector<FillShape>& shapes,
                        Placing& placing) {
  Obstacles obstacles;
  obstacles.occupied = std::move(placing.occupied);
  obstacles.keep = &fill != &a.scene.fills.back() || meets_images(a.scene, fill);
  placing.held.look(a.simulation->world, fill.region.min, fill.region.max);
  if (!placing.held.sees_nothing())
    obstacles.meets_held = [&](const FillBody& f) {
      return placing.held.meets(
          make_body(a, builder.build(fill.shapes[f.shape], f.size), spec_of(fill, f), fill.place));
    };
  FillResult result = generate(fill, shapes, obstacles);
  placing.occupied = std::move(obstacles.occupied);
  return result;
}

/// Bodies that come in their time.
void add_stream(Assembly& a, ShapeBuilder& builder, const FillSpec& fill, const FillResult& result) {
  Stream stream{{fill.name, {}, fill.region.min, fill.region.max, fill.seed, {}, {}, {}}, fill.from};
  for (const FillBody& f : result.bodies) {
    const BodySpec spec = spec_of(fill, f);
    const BuiltShape shape = builder.build(spec.shape, f.size);
    if (((fill.region.max - fill.region.min).array() < 2 * shape.radius).any())
      throw SceneError("[[fill]]: a body is larger than the region it is poured into", fill.place);
    a.fill_ids.back().push_back(a.simulation->world.reserve());
    const Body body = make_body(a, shape, spec, fill.place);
    stream.setup.bodies.push_back({body, a.fill_ids.back().back(), stream.time, shape.radius});
    stream.time += fill.rate > 0 ? 1.0 / fill.rate : body.mass / fill.mass_rate;
  }
  if (stream.setup.bodies.empty()) return;
  if (const auto& domain = a.simulation->domain;
      domain && !(domain->contains(fill.region.min) && domain->contains(fill.region.max)))
    a.warnings.push_back(
        {Problem::Level::warning, fill.place,
         "[[fill]] '" + fill.name + "': the region that bodies are poured into reaches outside [world] domain"});
  stream.setup.radius = [store = a.shapes](std::uint32_t shape) { return store->bounding_radius({shape}); };
  const auto probe = std::make_shared<HeldProbe>(*a.shapes);
  stream.setup.see_held = [probe, region = fill.region](const World& world) {
    probe->look(world, region.min, region.max);
  };
  stream.setup.meets_held = [probe, store = a.shapes](const Body& body) { return probe->meets(body); };
  auto source = std::make_unique<PourBodies>(std::move(stream.setup));
  a.sources.push_back(source.get());
  a.simulation->events.push_back(std::move(source));
}

void add_fill(Assembly& a, ShapeBuilder& builder, const FillSpec& fill, Placing& placing) {
  const std::vector<FillShape> shapes = shapes_of(a, builder, fill);
  require_memory(a, fill, shapes);
  const FillResult result = place_bodies(a, builder, fill, shapes, placing);
  if (!result.shortfall.empty())
    throw SceneError("[[fill]]: " + result.shortfall + "; enlarge the region or ask for less", fill.place);
  auto& ids = a.fill_ids.emplace_back();
  ids.reserve(result.bodies.size());
  if (fill.method == FillSpec::Method::pour) return add_stream(a, builder, fill, result);
  a.simulation->world.reserve(a.simulation->world.size() + result.bodies.size());
  for (const FillBody& f : result.bodies)
    ids.push_back(add_body(a, builder.build(fill.shapes[f.shape], f.size), spec_of(fill, f), fill.place));
  if (!ids.empty()) look_for_outsiders(a, "[[fill]] '" + fill.name + "'", ids.front(), ids.size(), fill.place);
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
    inner.spheres.wanted = inner.strays = false;
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
  a->plan = plan(a->scene, build_used(a->scene, builder));
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
  Placing placing(*a);
  for (const auto& f : a->scene.fills) add_fill(*a, builder, f, placing);
  a->origins = builder.origins();
  add_outlets(*a);
  if (a->scene.cell) add_cell(*a);
  sim.pipeline.guard = make_guard(*a);
  add_rolling(*a);
  add_springs(*a);
  add_removals(*a);
  a->warnings.insert(a->warnings.begin(), builder.warnings().begin(), builder.warnings().end());
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
