#include "scenes/placing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "detection/broad/all_broad_phases.h"
#include "engine/step/drive_lead.h"
#include "engine/step/servo_event.h"
#include "laws/nonsmooth/nonsmooth_contact.h"
#include "scenes/generators.h"
#include "scenes/held_probe.h"
#include "scenes/peak_memory.h"

namespace epafi {

namespace {

double density(const Scene& scene, std::size_t material, const Place& place) {
  const Material& m = scene.materials[material].material;
  if (!(m.density > 0)) throw SceneError("a free body needs the density of material '" + m.name + "' (kg/m^3)", place);
  return m.density;
}

/// A body moved by forces needs a mass and moments of inertia with finite inverses.
void check_inertia(const Body& body, const std::string& type, const Place& place) {
  if (body.mass > 0.0 && std::isfinite(body.mass) && std::isfinite(1.0 / body.mass) && body.inertia.allFinite() &&
      body.inertia.minCoeff() > 0.0 && body.inertia.cwiseInverse().allFinite())
    return;
  throw SceneError(
      fmt::format("a free {} has a mass of {:.3g} kg and moments of inertia of {:.3g}, {:.3g}, {:.3g} kg m^2; expected "
                  "positive numbers: its lengths or its density are beyond measure",
                  type, body.mass, body.inertia.x(), body.inertia.y(), body.inertia.z()),
      place);
}

/// The body of a shape, checked for the motion it is given.
Body make_body(const Assembly& a, const BuiltShape& shape, const BodySpec& spec, const Place& place) {
  Body body;
  body.position = spec.position;
  body.velocity = spec.velocity;
  body.angular_velocity = spec.angular_velocity;
  body.shape = shape.ref.packed;
  body.material = static_cast<std::uint16_t>(spec.material);
  body.orientation = spec.orientation * shape.frame.orientation;
  if (spec.as_drawn) body.position += spec.orientation * shape.frame.centre;
  if (spec.force) body.external_force = *spec.force;
  if (!spec.moves()) return body;
  const double rho = shape.mass > 0 ? 1.0 : density(a.scene, spec.material, place);
  body.mass = shape.mass > 0 ? shape.mass : rho * shape.volume;
  body.inertia = rho * shape.frame.moments;
  check_inertia(body, a.scene.shapes[spec.shape].type, place);
  return body;
}

/// True for a motion of changing velocity.
bool accelerates(const Motion& m) {
  return m.table != nullptr || (m.oscillation_amplitude != 0.0 && m.oscillation_frequency != 0.0);
}

/// position: of the body's centre [m]
void drive(Assembly& a, BodyId id, const BodySpec& spec, const Vec3& position) {
  auto& events = a.simulation->events;
  if (spec.motion) {
    a.drives.push_back({id, spec.motion->since});
    events.push_back(
        std::make_unique<DriveBody>(id, spec.motion->parts, position, a.elapsed(spec.motion->since), !spec.servo));
    const bool predicts = a.simulation->pipeline.scheme->velocity_lag() > 0.0;
    if (a.scene.contact.method.value == Method::smooth && predicts &&
        std::ranges::any_of(spec.motion->parts, accelerates))
      events.push_back(std::make_unique<DriveLead>(id, a.simulation->ledger));
  }
  if (!spec.servo) return;
  if (const Servo& s = spec.servo->servo; !(s.mass > 0.0 && s.max_speed > 0.0 && s.direction.squaredNorm() > 0.0))
    throw SceneError("motion servo of a body of a fill: write direction, mass and max_speed");
  const double elapsed = a.elapsed(spec.servo->since);
  if (a.scene.contact.method.value == Method::smooth) {
    events.push_back(std::make_unique<ServoEvent>(id, spec.servo->servo, elapsed, a.simulation->ledger));
    return;
  }
  const auto wall = std::make_shared<NonsmoothServo>(NonsmoothServo{id, spec.servo->servo});
  add_nonsmooth_servo(*a.simulation->pipeline.contact_model, wall);
  events.push_back(std::make_unique<NonsmoothServoEvent>(wall, elapsed));
}

BodyId add_body(Assembly& a, const BuiltShape& shape, const BodySpec& spec, const Place& place) {
  const Body body = make_body(a, shape, spec, place);
  const BodyId id = a.simulation->world.add(body);
  drive(a, id, spec, body.position);
  return id;
}

/// Reports free bodies outside the domain at the start: the first step would fail or remove them.
void look_for_outsiders(Assembly& a, const std::string& table, const std::vector<BodyId>& ids, const Place& where) {
  const World& world = a.simulation->world;
  std::size_t outside = 0;
  if (!a.simulation->domain) return;
  for (const BodyId id : ids) {
    const Slot s = world.slot_of(id);
    outside += s != no_slot && world.is_movable(s) && !a.simulation->domain->contains(world.position[s]);
  }
  if (outside == 0) return;
  const std::string text = fmt::format("{}: {} of {} bodies stand outside [world] domain", table, outside, ids.size());
  if (a.simulation->domain->outside == Domain::Outside::error)
    throw SceneError(text + ", where outside = \"error\" ends the run; move them or enlarge the domain", where);
  const std::string warning = text + ", where outside = \"delete\" takes them out at once";
  a.warnings.push_back({Problem::Level::warning, where, warning});
  a.simulation->warnings.add(
      {.kind = "outside " + table, .text = warning, .value = static_cast<double>(outside), .times = 1});
}

void look_for_outsiders(Assembly& a, const GroupSpec& group) {
  if (!a.simulation->domain) return;
  std::vector<BodyId> ids;
  for (std::size_t k = 0; k < group.count; ++k) ids.push_back(a.id_of(group.first + k));
  look_for_outsiders(a, "[[body]] '" + group.name + "'", ids, group.place);
}

/// Reserves a number without a body.
BodyId leave_out(Assembly& a) { return a.simulation->world.reserve(); }

/// Diameter of the smallest free body [m]; 0 where there is none.
double smallest_diameter(const Scene& scene, ShapeBuilder& builder) {
  double radius = infinity;
  for (const BodySpec& b : scene.bodies)
    if (b.moves()) radius = std::min(radius, builder.build(b.shape, b.size).radius);
  for (const FillSpec& fill : scene.fills)
    for (const std::size_t shape : fill.shapes)
      radius = std::min(radius, builder.build(shape, fill.size ? fill.size->min : 1.0).radius);
  return std::isfinite(radius) ? 2.0 * radius : 0.0;
}

/// Mass that the body would have if it were free [kg].
double own_mass(const Assembly& a, const BodySpec& spec, ShapeBuilder& builder, const Place& place) {
  const BuiltShape shape = builder.build(spec.shape, spec.size);
  if (shape.mass > 0.0) return shape.mass;
  if (!(shape.volume > 0.0))
    throw SceneError("motion servo: write mass, the inertia of the wall; a " + a.scene.shapes[spec.shape].type +
                         " has none of its own",
                     place);
  return shape.volume * density(a.scene, spec.material, place);
}

}  // namespace

void complete_servos(Assembly& a, ShapeBuilder& builder) {
  for (BodySpec& b : a.scene.bodies) {
    if (!b.servo || b.absent) continue;
    ServoSpec spec = *b.servo;
    Servo& s = spec.servo;
    const Place& place = a.scene.groups[b.group].place;
    if (s.direction.isZero(0.0)) s.direction = a.scene.gravity.normalized();
    if (s.direction.isZero(0.0))
      throw SceneError("motion servo: write direction; there is no constant gravity to press along", place);
    const bool asks_mass = !(s.mass > 0.0) || (s.has_gains() && !(s.max_speed > 0.0));
    const double mass = asks_mass ? own_mass(a, b, builder, place) : s.mass;
    if (!(s.mass > 0.0)) s.mass = mass;
    if (!(s.max_speed > 0.0)) {
      const double diameter = smallest_diameter(a.scene, builder);
      if (!(diameter > 0.0))
        throw SceneError("motion servo: write max_speed; there is no free body that it could follow from", place);
      s.max_speed = std::sqrt(s.force * diameter / mass);
    }
    b.servo = spec;
  }
}

namespace {

constexpr double deep = 0.1;        // of a radius: no state that a run exports has such overlaps
constexpr double less_deep = 0.25;  // of that, where the other reading is the right one
constexpr std::size_t enough = 10;  // overlapping pairs: fewer may lie deep by chance

/// True for a row of a file whose shape is not in its principal axes.
bool may_have_old_axes(const Scene& scene, const BodySpec& b, ShapeBuilder& builder) {
  const GroupSpec& group = scene.groups[b.group];
  const bool is_row = group.repeat == std::vector<std::size_t>{1} && group.count > 1 && group.stage == 0;
  if (!is_row || !b.moves() || b.absent || b.as_drawn || scene.shapes[b.shape].type == "sphere") return false;
  return builder.build(b.shape, b.size).frame.orientation.vec().squaredNorm() > 0.0;
}

/// Overlap of all bodies at the start. principal: orientations in such rows are those of the principal axes.
Overlap overlap_of_reading(const Assembly& a, ShapeBuilder& builder, bool principal) {
  World world(a.plan.columns);
  if (a.scene.cell) world.cell = a.scene.cell->cell;
  for (const BodySpec& b : a.scene.bodies) {
    if (b.absent || a.scene.groups[b.group].stage > 0) continue;
    const BuiltShape shape = builder.build(b.shape, b.size);
    Body body = make_body(a, shape, b, a.scene.groups[b.group].place);
    if (principal && may_have_old_axes(a.scene, b, builder)) body.orientation = b.orientation;
    world.add(body);
  }
  BroadSetup setup;
  setup.shapes = a.shapes.get();
  for (const auto& row : pair_table())
    for (const auto& cell : row) setup.filter.has_cell.push_back(cell.batch != nullptr);
  PairList pairs;
  ContactSet contacts;
  make_broad_phase("spatial-hash", setup, world)->find_pairs(world, pairs);
  BatchNarrowPhase(*a.shapes, 0.0, false).collide(world, pairs, contacts);
  return measure_overlap(world, {world, contacts}, *a.shapes);
}

}  // namespace

void read_principal_axes(Assembly& a, ShapeBuilder& builder) {
  auto& bodies = a.scene.bodies;
  const auto first =
      std::ranges::find_if(bodies, [&](const BodySpec& b) { return may_have_old_axes(a.scene, b, builder); });
  if (first == bodies.end()) return;
  const Overlap written = overlap_of_reading(a, builder, false);
  if (written.max_relative < deep || written.pairs < enough) return;
  const Overlap principal = overlap_of_reading(a, builder, true);
  if (principal.max_relative > less_deep * written.max_relative) return;
  a.warnings.push_back(
      {Problem::Level::warning, a.scene.groups[first->group].place,
       fmt::format(
           "[[bodies]]: the orientations are read as those of principal axes, as exports of older versions "
           "have them: the bodies overlap by up to {:.2g} of their radius so, by {:.2g} where they are those of "
           "the axes of the shape; export the run anew to be rid of this",
           principal.max_relative, written.max_relative)});
  for (BodySpec& b : bodies)
    if (may_have_old_axes(a.scene, b, builder))
      b.orientation = b.orientation * builder.build(b.shape, b.size).frame.orientation.conjugate();
}

void add_bodies(Assembly& a, ShapeBuilder& builder, std::size_t stage) {
  const auto& bodies = a.scene.bodies;
  a.simulation->world.reserve(bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const BodySpec& b = bodies[k];
    const GroupSpec& group = a.scene.groups[b.group];
    if (group.stage != stage) continue;
    BodyId id{};
    if (b.absent) {
      id = leave_out(a);
    } else {
      const BuiltShape shape = builder.build(b.shape, b.size);
      if (b.moves() && !shape.is_solid)
        throw SceneError(
            fmt::format("body '{}': shape '{}' has no volume of its own; make it fixed or give it a motion",
                        body_name(a.scene, k), a.scene.shapes[b.shape].type),
            group.place);
      id = add_body(a, shape, b, group.place);
    }
    if (a.body_ids.empty() && id != static_cast<BodyId>(k)) {
      a.body_ids.resize(bodies.size());
      for (std::size_t j = 0; j < k; ++j) a.body_ids[j] = static_cast<BodyId>(j);
    }
    if (!a.body_ids.empty()) a.body_ids[k] = id;
  }
  if (stage != a.scene.stage || a.scene.start) return;  // those of before stand elsewhere by now
  for (const GroupSpec& g : a.scene.groups)
    if (g.stage == stage) look_for_outsiders(a, g);
}

namespace {

/// Bodies that a source pours, each at its time.
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

/// Refuses a fill that needs more memory than there is.
void require_memory(const Assembly& a, const FillSpec& fill, const std::vector<FillShape>& shapes) {
  const double bodies = static_cast<double>(a.simulation->world.ids_given()) + most_bodies_of(fill, shapes);
  const double bytes = bodies * static_cast<double>(a.plan.memory.body + sizeof(FillBody));
  if (const auto there = static_cast<double>(memory_there()); bytes > there)
    throw SceneError(fmt::format("[[fill]] '{}': {:.3g} bodies take {:.3g} GB at least; {:.3g} GB are there", fill.name,
                                 bodies, 1e-9 * bytes, 1e-9 * there),
                     fill.place);
}

BodySpec spec_of(const FillSpec& fill, const FillBody& f, std::size_t k) {
  BodySpec spec;
  spec.shape = fill.shapes[f.shape];
  spec.size = f.size;
  spec.material = fill.material;
  spec.position = f.position;
  spec.orientation = f.orientation;
  spec.velocity = fill.velocity + f.velocity;
  for (const BodyChange& change : fill.changes)
    if (!change.one || *change.one == k) apply(change, spec);
  if (spec.load || spec.force)
    throw SceneError("[[fill]] '" + fill.name + "': force and torque are for bodies of [[body]] and [[bodies]]",
                     fill.place);
  return spec;
}

/// True where the region spans the cell along a periodic axis: bodies may touch images of each other.
bool meets_images(const Scene& scene, const FillSpec& fill) {
  for (int k = 0; scene.cell && k < 3; ++k)
    if (scene.cell->cell.repeats[static_cast<std::size_t>(k)] &&
        fill.region.max[k] - fill.region.min[k] > scene.cell->cell.size[k] * (1 + 1e-12))
      return true;
  return false;
}

/// Space occupied so far, for the fills in the order of the scene.
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
          make_body(a, builder.build(fill.shapes[f.shape], f.size), spec_of(fill, f, 0), fill.place));
    };
  FillResult result = generate(fill, shapes, obstacles);
  placing.occupied = std::move(obstacles.occupied);
  return result;
}

/// Adds a source of bodies.
void add_stream(Assembly& a, ShapeBuilder& builder, const FillSpec& fill, const std::vector<FillBody>& bodies,
                std::vector<BodyId>& ids) {
  Stream stream{{fill.name, {}, fill.region.min, fill.region.max, fill.seed, {}, {}, {}}, fill.from};
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const FillBody& f = bodies[k];
    const BodySpec spec = spec_of(fill, f, k);
    const BodyId id = leave_out(a);
    ids.push_back(id);
    if (spec.absent) continue;
    const BuiltShape shape = builder.build(spec.shape, f.size);
    if (((fill.region.max - fill.region.min).array() < 2 * shape.radius).any())
      throw SceneError("[[fill]] '" + fill.name + "': a body is larger than the region it is poured into", fill.place);
    const Body body = make_body(a, shape, spec, fill.place);
    drive(a, id, spec, spec.position);
    stream.setup.bodies.push_back({body, id, stream.time, shape.radius});
    stream.time += fill.rate > 0 ? 1.0 / fill.rate : body.mass / fill.mass_rate;
  }
  if (stream.setup.bodies.empty()) return;
  stream.setup.elapsed = a.elapsed({fill.stage, 0.0});
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

/// Adds the bodies of a fill, each with the number given at placing.
void put_in(Assembly& a, ShapeBuilder& builder, const FillSpec& fill, const std::vector<FillBody>& bodies) {
  const auto index = static_cast<std::size_t>(&fill - a.scene.fills.data());
  auto& ids = a.fill_ids[index];
  ids.reserve(bodies.size());
  if (!a.fill_bodies.empty()) a.fill_bodies[index] = bodies;
  if (fill.method == FillSpec::Method::pour) return add_stream(a, builder, fill, bodies, ids);
  a.simulation->world.reserve(a.simulation->world.size() + bodies.size());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const BodySpec spec = spec_of(fill, bodies[k], k);
    const bool there = !spec.absent;
    ids.push_back(there ? add_body(a, builder.build(spec.shape, spec.size), spec, fill.place) : leave_out(a));
  }
}

}  // namespace

KnownFills known_fills(const Scene& scene, const AssembleOptions& options) {
  KnownFills known = options.fill_bodies;
  known.resize(scene.fills.size());
  bool missing = false;
  for (std::size_t i = 0; i < known.size(); ++i)
    missing = missing || (scene.fills[i].stage < scene.stage && known[i].empty());
  if (!missing) return known;
  AssembleOptions first;
  first.keep_fill_bodies = true;
  const KnownFills begin = assemble(scene.stage_of(0), first)->fill_bodies;
  for (std::size_t i = 0; i < begin.size(); ++i)
    if (known[i].empty()) known[i] = begin[i];
  return known;
}

void add_known_fills(Assembly& a, ShapeBuilder& builder, std::size_t stage, const KnownFills& known) {
  for (std::size_t i = 0; i < a.scene.fills.size(); ++i) {
    const FillSpec& fill = a.scene.fills[i];
    if (fill.stage != stage) continue;
    put_in(a, builder, fill, known[i].empty() ? generate(fill, shapes_of(a, builder, fill)).bodies : known[i]);
  }
}

void add_fills(Assembly& a, ShapeBuilder& builder, const KnownFills& known, bool places_known) {
  Placing placing(a);
  for (std::size_t i = 0; i < a.scene.fills.size(); ++i) {
    const FillSpec& fill = a.scene.fills[i];
    if (fill.stage != a.scene.stage) continue;
    if (!known[i].empty()) {
      put_in(a, builder, fill, known[i]);
      continue;
    }
    const std::vector<FillShape> shapes = shapes_of(a, builder, fill);
    require_memory(a, fill, shapes);
    const FillResult result = places_known ? place_bodies(a, builder, fill, shapes, placing) : generate(fill, shapes);
    if (!result.shortfall.empty())
      throw SceneError("[[fill]] '" + fill.name + "': " + result.shortfall + "; enlarge the region or ask for less",
                       fill.place);
    put_in(a, builder, fill, result.bodies);
    if (fill.method != FillSpec::Method::pour)
      look_for_outsiders(a, "[[fill]] '" + fill.name + "'", a.fill_ids[i], fill.place);
  }
}

}  // namespace epafi
