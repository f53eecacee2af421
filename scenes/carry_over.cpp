#include "scenes/carry_over.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "detection/narrow/polyhedra/resting_patch.h"
#include "scenes/contact_setup.h"
#include "scenes/start_run.h"

namespace epafi {

namespace {

/// Columns of a state, by name.
class ColumnStore {
 public:
  struct Column {
    std::size_t element = 0;
    std::vector<std::byte> bytes;
  };

  /// Stores all columns that are visited.
  struct Saver final : StateVisitor {
    explicit Saver(ColumnStore& to) : to(to) {}
    ColumnStore& to;
    std::size_t bytes_of(std::string_view, std::size_t, std::size_t current) override { return current; }
    void exchange(std::string_view name, std::size_t element, std::byte* data, std::size_t bytes) override {
      to.columns_[std::string(name)] = {element, {data, data + bytes}};
    }
  };
  /// Fills visited columns with stored ones of the same name and type; leaves the others as they are.
  struct Giver final : StateVisitor {
    explicit Giver(const ColumnStore& from) : from(from) {}
    const ColumnStore& from;
    std::size_t bytes_of(std::string_view name, std::size_t element, std::size_t current) override {
      const Column* found = from.find(name, element);
      return found ? found->bytes.size() : current;
    }
    void exchange(std::string_view name, std::size_t element, std::byte* data, std::size_t bytes) override {
      const Column* found = from.find(name, element);
      if (found && found->bytes.size() == bytes && bytes > 0) std::memcpy(data, found->bytes.data(), bytes);
    }
  };

  const Column* find(std::string_view name, std::size_t element) const {
    const auto found = columns_.find(name);
    return found != columns_.end() && found->second.element == element ? &found->second : nullptr;
  }
  void drop(const std::function<bool(const std::string&)>& unwanted) {
    std::erase_if(columns_, [&](const auto& c) { return unwanted(c.first); });
  }
  bool has(std::string_view name) const { return columns_.find(name) != columns_.end(); }
  std::size_t rows(std::string_view name) const {
    const auto found = columns_.find(name);
    return found == columns_.end() || found->second.element == 0 ? 0
                                                                 : found->second.bytes.size() / found->second.element;
  }
  /// Calls f(values) on a column of T; f may change its length.
  template <class T, class F>
  void change(const std::string& name, const F& f) {
    const auto found = columns_.find(name);
    if (found == columns_.end() || found->second.element != sizeof(T)) return;
    std::vector<T> values(found->second.bytes.size() / sizeof(T));
    if (!values.empty())
      std::memcpy(static_cast<void*>(values.data()), found->second.bytes.data(), found->second.bytes.size());
    f(values);
    found->second.bytes.resize(values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(found->second.bytes.data(), values.data(), found->second.bytes.size());
  }

 private:
  std::map<std::string, Column, std::less<>> columns_;
};

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool same(const Material& a, const Material& b) {
  return same(a.density, b.density) && same(a.youngs_modulus, b.youngs_modulus) &&
         same(a.poissons_ratio, b.poissons_ratio);
}

bool same(const Parameters& a, const Parameters& b) { return a.all() == b.all(); }

bool same_materials(const Scene& a, const Scene& b) {
  const MaterialTable before = material_table(a), now = material_table(b);
  std::vector<std::size_t> place;
  for (const MaterialSpec& m : a.materials) {
    const auto found =
        std::ranges::find(b.materials, m.material.name, [](const MaterialSpec& s) { return s.material.name; });
    if (found == b.materials.end() || !same(m.material, found->material)) return false;
    place.push_back(static_cast<std::size_t>(found - b.materials.begin()));
  }
  for (std::size_t i = 0; i < place.size(); ++i)
    for (std::size_t j = 0; j < place.size(); ++j) {
      const MaterialPair& p = before.pairs[i * before.materials + j];
      const MaterialPair& q = now.pairs[place[i] * now.materials + place[j]];
      if (!same(p.restitution, q.restitution) || !same(p.friction, q.friction) ||
          !same(p.rolling_friction, q.rolling_friction) || !same(p.parameters, q.parameters))
        return false;
    }
  return true;
}

/// True where the history of contacts has the same meaning by both laws.
bool same_laws(const ContactSettings& a, const ContactSettings& b) {
  if (a.method.value != b.method.value) return false;
  if (a.method.value == Method::nonsmooth) return true;  // impulses
  return a.law.value == b.law.value && a.tangential.value == b.tangential.value && a.rolling.value == b.rolling.value;
}

bool same_contact(const ContactSettings& a, const ContactSettings& b) {
  if (!same_laws(a, b)) return false;
  const bool smooth = a.method.value == Method::smooth;
  return smooth ? a.locate_edges == b.locate_edges && same(a.wheel_rail, b.wheel_rail)
                : a.solver.value == b.solver.value && same(a.nonsmooth, b.nonsmooth);
}

/// New springs attach in the first evaluation of forces.
bool same_springs(const Scene& a, const Scene& b) {
  return std::ranges::equal(a.springs, b.springs, {}, &SpringSpec::name, &SpringSpec::name);
}

}  // namespace

bool same_mechanics(const Scene& a, const Scene& b) {
  const RunSettings &r = a.run, &s = b.run;
  const bool smooth = b.contact.method.value == Method::smooth;
  const bool gravity_goes_on = !b.loose_gravity || (b.stage > 0 && b.gravity_since.stage < b.stage);
  return !b.changes_bodies && same_contact(a.contact, b.contact) && same_materials(a, b) && a.gravity == b.gravity &&
         static_cast<bool>(a.loose_gravity) == static_cast<bool>(b.loose_gravity) && gravity_goes_on &&
         r.time_step.value == s.time_step.value && r.adaptive == s.adaptive && r.scheme.value == s.scheme.value &&
         r.allow_unstable == s.allow_unstable && same_springs(a, b) &&
         (smooth || r.output_interval.value == s.output_interval.value);
}

namespace {

/// Removes bodies that are gone in the other state, and adds those poured since.
void match_bodies(const World& there, Assembly& to) {
  World& here = to.simulation->world;
  std::vector<BodyId> gone;
  for (std::size_t k = 0; k < there.ids_given() && k < here.ids_given(); ++k) {
    const auto id = static_cast<BodyId>(k);
    if (here.slot_of(id) != no_slot && there.slot_of(id) == no_slot) gone.push_back(id);
  }
  if (!gone.empty()) here.remove(gone);
  for (const PourBodies* source : to.sources)
    for (const WaitingBody& waiting : source->setup().bodies) {
      const auto k = static_cast<std::size_t>(waiting.id);
      if (k < there.ids_given() && there.slot_of(waiting.id) != no_slot) here.add(waiting.body, waiting.id);
    }
}

/// Sorts slots: bodies of the other state in their order, then new ones.
void match_slots(const World& there, World& here) {
  std::vector<Slot> order;
  for (Slot s = 0; s < there.size(); ++s)
    if (const Slot t = here.slot_of(there.id[s]); t != no_slot) order.push_back(t);
  std::vector<char> placed(here.size(), 0);
  for (const Slot s : order) placed[s] = 1;
  for (Slot s = 0; s < here.size(); ++s)
    if (!placed[s]) order.push_back(s);
  here.reorder(order);
}

void copy_body(const CarryOver& carry, const World& there, Slot from, World& here, Slot to) {
  const bool cells = there.cell && here.cell;
  here.position[to] = cells ? there.position[from] : there.unwrapped(from);
  if (cells) here.wraps[to] = there.wraps[from];
  const bool moves = !carry.at_rest && here.is_movable(to);  // what drives the others gives them their velocity
  here.velocity[to] = moves ? there.velocity[from] : Vec3(Vec3::Zero());
  if (here.has_orientation() && there.has_orientation()) here.orientation[to] = there.orientation[from];
  if (!here.rotates()) return;
  const Vec3 spin = moves && there.rotates() ? there.angular_velocity[from] : Vec3(Vec3::Zero());
  here.set_angular_velocity(to, spin);
  if (!moves || !here.columns().anisotropy || !there.columns().anisotropy || !there.is_movable(from)) return;
  here.angular_momentum[to] = there.angular_momentum[from];
  here.angular_velocity[to] = spin;
}

void turn_and_move(const CarryOver& carry, World& here, Slot s) {
  if (carry.turned) {
    here.position[s] = carry.turn * here.position[s];
    here.velocity[s] = carry.turn * here.velocity[s];
    if (here.has_orientation()) here.orientation[s] = (carry.turn * here.orientation[s]).normalized();
    if (here.rotates()) here.set_angular_velocity(s, carry.turn * here.angular_velocity[s]);
  }
  here.position[s] += carry.move;
}

}  // namespace

void carry_bodies(const CarryOver& carry, Assembly& to) {
  const World& there = carry.from.simulation->world;
  World& here = to.simulation->world;
  if (there.cell.has_value() != here.cell.has_value() ||
      (here.cell && there.cell->repeats != here.cell->repeats && carry.goes_on))
    throw SceneError("[world] domain: a run that goes on stays periodic along the same axes",
                     to.scene.domain ? to.scene.domain->place : Place{});
  match_bodies(there, to);
  match_slots(there, here);
  if (here.cell && here.cell->repeats == there.cell->repeats) here.cell = there.cell;
  for (Slot s = 0; s < there.size(); ++s) {
    const Slot t = here.slot_of(there.id[s]);
    if (t == no_slot) continue;
    copy_body(carry, there, s, here, t);
    if (carry.turned || !carry.move.isZero(0.0)) turn_and_move(carry, here, t);
  }
  if (!carry.goes_on) return;
  here.time = there.time;
  here.fallen = there.fallen;
}

namespace {

/// True where the present stage, or the scene that starts from a run, defines the motion.
bool is_fresh(const DriveBody& drive, const Assembly& to) {
  const auto& known = to.drives;
  const auto found = std::ranges::find(known, drive.body(), &Assembly::Drive::body);
  return found == known.end() || (found->since.passed == 0.0 && found->since.stage == to.scene.stage);
}

/// Lets motions of the stage begin at the present positions of their bodies.
void begin_motions(Assembly& to, const CarryOver& carry) {
  const World& here = to.simulation->world;
  for (auto& event : to.simulation->events) {
    auto* drive = dynamic_cast<DriveBody*>(event.get());
    if (!drive || here.slot_of(drive->body()) == no_slot) continue;
    const bool fresh = is_fresh(*drive, to);
    if (fresh) drive->begin_at(here.position[here.slot_of(drive->body())]);
    if (!fresh && !carry.move.isZero(0.0)) drive->begin_at(drive->start() + carry.move);
    if (!fresh && carry.turned)
      throw SceneError(
          "[start]: bodies that are driven in the run cannot be turned; write at_rest = true or a motion here",
          to.scene.start ? to.scene.start->place : Place{});
  }
}

/// Springs keep their state by name and number among those of that name; new ones attach in the first step.
void carry_springs(const Assembly& from, const Assembly& to, ColumnStore& store) {
  const auto key = [](const Assembly& a, std::size_t k) {
    const SpringSpec& s = a.scene.springs[k];
    std::size_t same = 0;
    for (std::size_t j = 0; j < k; ++j) same += a.scene.springs[j].name == s.name;
    return std::tuple(s.name, same, a.id_of(s.body), s.to ? a.id_of(*s.to) : BodyId{~0u});
  };
  std::vector<std::size_t> old(to.scene.springs.size(), ~std::size_t{0});
  for (std::size_t k = 0; k < old.size(); ++k)
    for (std::size_t j = 0; j < from.scene.springs.size(); ++j)
      if (key(from, j) == key(to, k)) old[k] = j;
  const double clock = from.simulation->world.clock;
  const auto pick = [&](auto& values, auto none) {
    std::remove_reference_t<decltype(values)> picked;
    for (const std::size_t j : old) picked.push_back(j < values.size() ? values[j] : none);
    values.swap(picked);
  };
  store.change<Vec3>("springs/relaxed", [&](std::vector<Vec3>& v) {
    pick(v, Vec3(Vec3::Constant(std::numeric_limits<double>::quiet_NaN())));
  });
  store.change<double>("springs/start", [&](std::vector<double>& v) {
    for (std::size_t j = 0; j < v.size() && j < from.scene.springs.size(); ++j)
      v[j] += from.scene.springs[j].speed * clock;
    pick(v, 0.0);
  });
}

template <class Shape>
bool equal(const Shape&, const Shape&) {
  return false;  // no resting patch belongs to it
}
bool equal(const Box& a, const Box& b) { return a.half == b.half; }
bool equal(const ConvexHull& a, const ConvexHull& b) {
  return a.vertices == b.vertices && a.face_begin == b.face_begin && a.face_vertices == b.face_vertices &&
         a.sweep == b.sweep;
}

/// True where two bodies have the same polyhedron, whatever its number in their scenes.
bool same_polyhedron(const Assembly& from, Slot there, const Assembly& to, Slot here) {
  const ShapeRef old{from.simulation->world.shape[there]}, now{to.simulation->world.shape[here]};
  if (old.type() != now.type()) return false;
  return from.shapes->with(old, [&]<class S>(const S& a) { return equal(a, to.shapes->of<S>()[now.index()]); });
}

/// Resting patches belong to pairs of slots and of shapes (BatchNarrowPhase::Known, column narrow_phase/pair). Slots
/// and shapes have other numbers in the other scene; patches of bodies that are gone or have another shape are dropped.
/// The order of slots is that of before (match_slots), so pairs stay sorted.
void rename_resting(const Assembly& from, const Assembly& to, const Reordering& change, ColumnStore& store) {
  struct Known {
    Pair pair;
    std::uint32_t shape_a, shape_b;
  };
  std::vector<char> keep;
  store.change<Known>("narrow_phase/pair", [&](std::vector<Known>& pairs) {
    std::vector<Known> kept;
    for (Known known : pairs) {
      const Slot a = change.new_slot[known.pair.a], b = change.new_slot[known.pair.b];
      keep.push_back(a != no_slot && b != no_slot && same_polyhedron(from, known.pair.a, to, a) &&
                     same_polyhedron(from, known.pair.b, to, b));
      if (keep.back() == 0) continue;
      known.pair.a = a;
      known.pair.b = b;
      known.shape_a = to.simulation->world.shape[a];
      known.shape_b = to.simulation->world.shape[b];
      kept.push_back(known);
    }
    pairs.swap(kept);
  });
  store.change<RestingPatch>("narrow_phase/resting", [&](std::vector<RestingPatch>& patches) {
    std::size_t k = 0;
    std::erase_if(patches, [&](const RestingPatch&) { return keep.at(k++) == 0; });
  });
}

/// The history of contacts, with slots and shapes renumbered.
ColumnStore memory_of(const Assembly& to, Assembly& from) {
  ColumnStore store;
  ColumnStore::Saver saver(store);
  Simulation& sim = *from.simulation;
  sim.pipeline.narrow_phase->visit(saver);
  const World &there = sim.world, &here = to.simulation->world;
  Reordering change{std::vector<Slot>(there.size(), no_slot)};
  bool moved = false;
  for (Slot s = 0; s < there.size(); ++s) {
    change.new_slot[s] = here.slot_of(there.id[s]);
    moved = moved || change.new_slot[s] != s;
  }
  rename_resting(from, to, change, store);
  if (moved) sim.pipeline.contact_model->reorder(change);
  sim.pipeline.contact_model->visit(saver);
  return store;
}

/// Notes springs that have lost a body.
void note_lost_springs(const Assembly& from, const Assembly& to, std::vector<std::string>& notes) {
  const auto holds = [&](const World& world, const SpringSpec& s) {
    const auto is_there = [&](std::size_t body) { return world.slot_of(from.id_of(body)) != no_slot; };
    return is_there(s.body) && (!s.to || is_there(*s.to));
  };
  const auto lost = std::ranges::count_if(from.scene.springs, [&](const SpringSpec& s) {
    return holds(from.simulation->world, s) && !holds(to.simulation->world, s);
  });
  if (lost > 0)
    notes.push_back(fmt::format("{} of {} springs: a body that they hold is gone", lost, from.scene.springs.size()));
}

bool starts_with(const std::string& text, const char* begin) { return text.rfind(begin, 0) == 0; }

/// Drops columns without a meaning in the other scene, and notes it.
void drop_foreign(const Assembly& from, const Assembly& to, ColumnStore& store, std::vector<std::string>& notes) {
  const ContactSettings &a = from.scene.contact, &b = to.scene.contact;
  const std::size_t springs =
      std::max(store.rows("smooth/contact/a") + store.rows("spheres/springs"), store.rows("warm_start/impulse"));
  const bool to_other_loop = a.method.value == Method::smooth && from.plan.fused_spheres != to.plan.fused_spheres;
  if (!same_laws(a, b) || to_other_loop) {
    store.drop(
        [](const std::string& name) { return !starts_with(name, "springs/") && !starts_with(name, "rolling/"); });
    if (springs == 0) return;
    const char* what = a.method.value == Method::smooth ? "friction springs" : "impulses";
    const char* why = a.method.value != b.method.value ? "the method changes"
                      : to_other_loop                  ? "spheres go to another loop"
                                                       : "the law changes";
    notes.push_back(fmt::format("{} of {} contacts: {}", what, springs, why));
    return;
  }
  if (a.method.value == Method::nonsmooth && a.solver.value != b.solver.value)
    store.drop([](const std::string& name) { return starts_with(name, "newton/") || starts_with(name, "auto/"); });
}

void carry_forces(const World& there, World& here) {
  if (!here.columns().force || !there.columns().force) return;
  for (Slot s = 0; s < there.size(); ++s) {
    const Slot t = here.slot_of(there.id[s]);
    if (t == no_slot) continue;
    here.force[t] = there.force[s];
    if (here.rotates() && there.rotates()) here.torque[t] = there.torque[s];
  }
}

/// Number of bodies that the new stage removes.
std::uint64_t taken_out(const World& there, const World& here) {
  return static_cast<std::uint64_t>(
      std::ranges::count_if(there.id, [&](BodyId id) { return here.slot_of(id) == no_slot; }));
}

/// Continues ledger, counts and warnings of the same run.
void go_on(const Simulation& old, Simulation& sim) {
  sim.ledger = old.ledger;
  sim.work.report = old.work.report;
  sim.continue_at(old.steps(), old.steps_before());
  sim.add_removed(old.bodies_removed() + taken_out(old.world, sim.world));
  sim.take_leaving(old.leaving());
  Warnings all = old.warnings;
  for (const Warning& own : sim.warnings.all()) all.add(own);
  sim.warnings = all;
}

}  // namespace

CarryOver carry_of_start(const Scene& scene) {
  const StartSpec& s = *scene.start;
  return {*s.made->assembly, s.goes_on, s.at_rest, s.keeps_memory(), s.move, s.turn, s.turned};
}

std::vector<std::string> enter_simulation(Assembly& a) {
  if (!a.scene.start || a.scene.stage > 0) {
    a.simulation->start();
    return {};
  }
  const std::shared_ptr<MadeRun> made = a.scene.start->made;
  auto notes = carry_memory(carry_of_start(a.scene), *made->assembly, a, {}, {});
  notes.insert(notes.end(), a.scene.start->dropped.begin(), a.scene.start->dropped.end());
  a.scene.start->made.reset();
  return notes;
}

namespace {

/// Springs that have gone on under another law are cut to what it bears before time goes on: an evaluation over no time
/// leaves them as they were, and the next step would count once more what that takes from them.
void settle_springs(const Scene& before, Simulation& sim, const Scene& now) {
  constexpr double instant = 1e-30;  // [s]: nothing moves
  if (!sim.pipeline.scheme->needs_initial_forces()) return;
  if (same_contact(before.contact, now.contact) && same_materials(before, now)) return;
  sim.pipeline.contact_model->act(sim.world, sim.work.contacts, {instant, 0.0}, sim.work.report);
}

}  // namespace

std::vector<std::string> carry_memory(const CarryOver& carry, Assembly& from, Assembly& to,
                                      const std::function<void(StateVisitor&)>& own_state_there,
                                      const std::function<void(StateVisitor&)>& own_state_here) {
  std::vector<std::string> notes;
  Simulation &old = *from.simulation, &sim = *to.simulation;
  const bool hold = same_mechanics(from.scene, to.scene) && carry.keeps_memory && !carry.at_rest;
  Simulation::Entry entry;
  entry.forces_hold = hold;
  entry.new_ledger = !carry.goes_on;
  old.ledger.measure(old.world);
  entry.stored_before = old.ledger.stored(old.world);
  const bool to_impulses = from.scene.contact.method.value != to.scene.contact.method.value &&
                           to.scene.contact.method.value == Method::nonsmooth;
  entry.elastic = to_impulses ? 0.0 : old.work.report.elastic;

  ColumnStore store = memory_of(to, from);
  drop_foreign(from, to, store, notes);
  if (!carry.keeps_memory) {
    const std::size_t contacts =
        std::max(store.rows("smooth/contact/a") + store.rows("spheres/springs"), store.rows("warm_start/impulse"));
    store.drop([](const std::string&) { return true; });
    if (contacts > 0)
      notes.push_back(fmt::format("memory of {} contacts: it does not belong to these places", contacts));
  }
  carry_springs(from, to, store);
  if (carry.goes_on) note_lost_springs(from, to, notes);
  ColumnStore::Saver saver(store);
  for (auto& event : old.events) event->visit(saver);
  if (own_state_there) own_state_there(saver);
  ColumnStore::Giver giver(store);
  sim.pipeline.narrow_phase->visit(giver);
  sim.pipeline.contact_model->visit(giver);
  for (auto& event : sim.events) {
    const auto* drive = dynamic_cast<DriveBody*>(event.get());
    if (!drive || !is_fresh(*drive, to)) event->visit(giver);
  }
  begin_motions(to, carry);
  if (own_state_here) own_state_here(giver);
  if (carry.goes_on && hold && old.step_watch && sim.step_watch) {
    old.step_watch->visit(saver);
    sim.step_watch->visit(giver);
  }

  if (hold) carry_forces(old.world, sim.world);
  if (carry.goes_on)
    go_on(old, sim);
  else
    sim.continue_at(0, old.steps() + old.steps_before());
  sim.enter(entry);
  settle_springs(from.scene, sim, to.scene);
  return notes;
}

}  // namespace epafi
