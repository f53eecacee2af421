/// @file read_start.cpp  [start]: bodies of an earlier run come before those of this scene, in their order. A body or
/// fill of this scene with the same name redefines them; position and velocity are those of the run.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <numeric>

#include "engine/units/nearest.h"
#include "scenes/reader/parts.h"
#include "scenes/start_run.h"

namespace epafi {
namespace {

/// Path relative to the scene file, else to the working directory.
std::string find_run(Reading& reading, const std::string& name, const Place& place) {
  const std::string beside = resolve_path(name, place, reading.main_file);
  return std::filesystem::exists(beside) ? beside : name;
}

/// Imports the bodies of the run into this scene.
struct Import {
  Draft& draft;
  const MadeRun& made;
  StartSpec& start;
  std::vector<std::size_t> material{};  ///< here, of materials there
  std::size_t shapes = 0;               ///< shapes here before those of the run

  const Scene& there() const { return made.assembly->scene; }
  const World& world() const { return made.assembly->simulation->world; }

  void materials() {
    auto& all = draft.scene.materials;
    for (const MaterialSpec& m : there().materials) {
      auto found = std::ranges::find(all, m.material.name, [](const MaterialSpec& s) { return s.material.name; });
      if (found == all.end()) found = all.insert(all.end(), m);
      material.push_back(static_cast<std::size_t>(found - all.begin()));
    }
  }

  /// Adds the shapes of the run; names used in this scene stay with its own shapes.
  void shapes_of_run() {
    shapes = draft.scene.shapes.size();
    for (ShapeSpec shape : there().shapes) {
      const auto taken = [&](const ShapeSpec& s) { return !s.name.empty() && s.name == shape.name; };
      if (std::ranges::any_of(draft.scene.shapes, taken)) shape.name.clear();
      draft.scene.shapes.push_back(std::move(shape));
    }
  }

  /// Moves axes that are fixed in space along with the bodies.
  std::vector<Motion> moved(std::vector<Motion> parts) const {
    for (Motion& part : parts)
      if (part.rotation_about) *part.rotation_about += start.move;
    return parts;
  }

  /// Adds a body by its specification in the run's scene.
  void add(BodySpec body, BodyId id, std::size_t group) {
    const World& w = world();
    const Slot s = w.slot_of(id);
    body.group = group;
    body.shape += shapes;
    body.material = material[body.material];
    body.absent = s == no_slot;
    const double passed = w.clock;
    const auto age = [&](Since since) { return Since{0, made.assembly->elapsed(since) + passed}; };
    if (body.motion) body.motion = MotionSpec{moved(body.motion->parts), age(body.motion->since)};
    if (body.servo) body.servo = ServoSpec{body.servo->servo, age(body.servo->since)};
    if (body.load) body.load = TimedLoad{body.load->force, body.load->torque, age(body.load->since)};
    if (body.remove_at) body.remove_at = Removal{body.remove_at->time, age(body.remove_at->since)};
    if (start.at_rest && (body.motion || body.servo)) {
      body.motion = {};
      body.servo = {};
      body.fixed = true;
    }
    if (s != no_slot) {
      body.position = w.position[s];
      body.velocity = start.at_rest ? Vec3(Vec3::Zero()) : w.velocity[s];
      if (w.rotates()) body.angular_velocity = start.at_rest ? Vec3(Vec3::Zero()) : w.angular_velocity[s];
      if (w.has_orientation()) body.orientation = w.orientation[s];
    }
    draft.scene.bodies.push_back(std::move(body));
    ++start.bodies;
    ++draft.scene.groups.back().count;
  }

  void begin_group(const GroupSpec& like, std::optional<std::size_t> from) {
    GroupSpec group = like;
    group.first = draft.scene.bodies.size();
    group.count = 0;
    group.stage = 0;
    group.from = from ? from : there().groups.size();  // of a fill: no group there
    draft.scene.groups.push_back(std::move(group));
  }

  void group(std::size_t g) {
    const GroupSpec& old = there().groups[g];
    begin_group(old, g);
    for (std::size_t k = old.first; k < old.first + old.count; ++k)
      add(there().bodies[k], made.assembly->id_of(k), draft.scene.groups.size() - 1);
  }

  /// Number of bodies after the last one poured: a snapshot does not hold the state of the source.
  std::size_t not_poured(const PourBodies& source) const {
    const auto& bodies = source.setup().bodies;
    if (!start.time) return bodies.size() - source.poured();
    const auto last = std::find_if(bodies.rbegin(), bodies.rend(),
                                   [&](const WaitingBody& b) { return world().slot_of(b.id) != no_slot; });
    return static_cast<std::size_t>(last - bodies.rbegin());
  }

  void fill(std::size_t f) {
    const FillSpec& fill = there().fills[f];
    const auto& ids = made.assembly->fill_ids[f];
    begin_group({fill.name, 0, 0, fill.place, {ids.size()}, fill.group}, {});
    std::size_t waiting = 0;
    for (std::size_t k = 0; k < ids.size(); ++k) {
      const FillBody& b = made.assembly->fill_bodies[f][k];
      BodySpec body;
      body.shape = fill.shapes[b.shape];
      body.size = b.size;
      body.material = fill.material;
      for (const BodyChange& change : fill.changes)
        if (!change.one || *change.one == k) apply(change, body);
      add(std::move(body), ids[k], draft.scene.groups.size() - 1);
    }
    for (const PourBodies* source : made.assembly->sources)
      if (source->setup().name == fill.name) waiting = not_poured(*source);
    if (waiting > 0)
      start.dropped.push_back(fmt::format("{} bodies of '{}' that had not been poured yet", waiting, fill.name));
  }

  /// Adds all bodies in the order of their ids.
  void all() {
    struct Part {
      BodyId first;
      bool is_fill;
      std::size_t index;
    };
    std::vector<Part> parts;
    const Assembly& a = *made.assembly;
    for (std::size_t g = 0; g < there().groups.size(); ++g)
      if (there().groups[g].count > 0) parts.push_back({a.id_of(there().groups[g].first), false, g});
    for (std::size_t f = 0; f < there().fills.size(); ++f)
      if (!a.fill_ids[f].empty()) parts.push_back({a.fill_ids[f].front(), true, f});
    std::ranges::sort(parts, {}, &Part::first);
    for (const Part& p : parts) p.is_fill ? fill(p.index) : group(p.index);
  }
};

/// A group of the run that is left out as a whole: its name is free for this scene.
void leave_out_groups(Scene& scene, const std::vector<char>& left_out) {
  for (GroupSpec& group : scene.groups) {
    const auto begin = left_out.begin() + static_cast<std::ptrdiff_t>(group.first);
    const auto end = begin + static_cast<std::ptrdiff_t>(group.count);
    group.is_left_out = group.count > 0 && std::find(begin, end, char{0}) == end;
    if (group.is_left_out) group.name.clear();
  }
}

/// Removes bodies that are not named or not in the region; the others keep names and numbers.
void select(Draft& draft, const TableValues& v) {
  auto& bodies = draft.scene.bodies;
  std::vector<char> keep(bodies.size(), v.has("bodies") ? 0 : 1);
  if (v.has("bodies"))
    for (const std::string& name : v.texts("bodies"))
      for (const auto& [first, count] : find_bodies(draft, name, v.place_of("bodies"), "[start] bodies").bodies) {
        const bool gone = std::all_of(bodies.begin() + static_cast<std::ptrdiff_t>(first),
                                      bodies.begin() + static_cast<std::ptrdiff_t>(first + count),
                                      [](const BodySpec& b) { return b.absent; });
        if (gone)
          draft.reading.error(v.place_of("bodies"), "[start] bodies: '" + name + "' is gone; the run has taken it out");
        std::fill_n(keep.begin() + static_cast<std::ptrdiff_t>(first), count, char{1});
      }
  if (v.has("region.box.min") && v.has("region.box.max")) {
    const Vec3 low = v.vec3("region.box.min"), high = v.vec3("region.box.max");
    if (!check_box(draft.reading, low, high, v.place_of("region.box"), "[start] region")) return;
    const bool any = std::ranges::any_of(bodies, [&](const BodySpec& b) {
      return !b.absent && (b.position.array() >= low.array()).all() && (b.position.array() <= high.array()).all();
    });
    if (!any) draft.reading.error(v.place_of("region.box"), "[start] region: no body of the run has its centre in it");
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      const Vec3& x = bodies[k].position;
      if ((x.array() < low.array()).any() || (x.array() > high.array()).any()) keep[k] = 0;
    }
  }
  std::vector<char> left_out(bodies.size(), 0);
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    left_out[k] = !keep[k] && !bodies[k].absent;
    if (left_out[k]) bodies[k].absent = true;
  }
  leave_out_groups(draft.scene, left_out);
  const bool any = std::ranges::find(left_out, 1) != left_out.end();
  if (any && draft.stage == 0) draft.scene.changes_bodies = true;
}

/// Reports keys that would be ignored.
void check_keys(Reading& reading, const Node* table, const Node* from, const TableValues& v) {
  if (from && from->type == Node::Type::table)
    for (const Member& m : table->members)
      if (m.key != "from")
        reading.error(m.place, "[start] " + m.key + " stands beside from = { ... }; write it in there");
  if (v.written("run") && v.written("from"))
    reading.error(v.place_of("run"), "[start] run and from both name a run; leave one out");
}

}  // namespace

void read_start(Draft& draft) {
  Reading& reading = draft.reading;
  const Node* table = find_table(reading, "start");
  if (!table && draft.start_run.empty()) return;
  const Node* from = table ? table->find("from") : nullptr;
  const Node& keys = from && from->type == Node::Type::table ? *from : table_or_empty(reading, "start");
  const std::size_t errors = reading.errors();
  const TableValues v = read_table(keys, "[start]", reading.schema.at("start").fields, reading);
  check_keys(reading, table, from, v);
  const bool named = v.has("run") || v.has("from");
  if (!named && draft.start_run.empty() && reading.errors() == errors)
    reading.error(from ? from->place : table->place,
                  std::string("missing key '") + (from ? "run" : "from") + "' in [start] (folder of a run, no unit)");
  if (reading.errors() != errors) return;
  StartSpec start;
  start.place = table ? table->place : Place{};
  start.goes_on = !draft.start_run.empty();
  const std::string key = v.has("run") ? "run" : "from";
  start.run = start.goes_on ? draft.start_run : find_run(reading, v.text(key), v.place_of(key));
  start.at_rest = v.boolean("at_rest");
  start.move = v.vec3("move");
  start.time = v.optional_number("time");
  const Vec3 angle = v.vec3("euler_deg") * (std::numbers::pi / 180.0);
  start.turned = !angle.isZero(0.0);
  const auto about = [&](int axis) { return Eigen::AngleAxisd(angle[axis], Vec3::Unit(axis)); };
  start.turn = Quat(about(2) * about(1) * about(0));
  try {
    auto& made = *draft.made;
    if (!made) made = start.time ? open_made_run_at(start.run, *start.time) : open_made_run(start.run);
    start.made = made;
  } catch (const SceneError& e) {
    const Place place = v.has(key) ? v.place_of(key) : start.place;
    for (const Problem& p : e.problems()) reading.error(place, "[start] from '" + start.run + "': " + p.text);
    return;
  } catch (const std::runtime_error& e) {
    const Place place = v.has(key) ? v.place_of(key) : start.place;
    return reading.error(place, "[start] from '" + start.run + "': " + e.what());
  }
  start.hash = start.made->hash;
  draft.scene.text += "start " + start.hash + "\n";
  Import import{draft, *start.made, start};
  import.materials();
  import.shapes_of_run();
  import.all();
  select(draft, v);
  if (draft.stage == 0 && (start.at_rest || start.turned || start.time)) draft.scene.changes_bodies = true;
  if (!start.made->assembly->scene.springs.empty())
    start.dropped.push_back("springs, but for those that this scene has under the same names");
  draft.scene.start = std::move(start);
}

namespace {

bool same_place(const BodySpec& a, const BodySpec& b) {
  return a.position == b.position && a.orientation.coeffs() == b.orientation.coeffs() && a.size == b.size;
}

/// The imported group that a table of this scene redefines: of the same name, or, where neither has one, of the same
/// shape at the same positions.
std::optional<std::size_t> imported_like(const Draft& draft, std::size_t own) {
  const Scene& scene = draft.scene;
  const GroupSpec& group = scene.groups[own];
  const Scene& there = scene.start->made->assembly->scene;
  for (std::size_t g = 0; g < own; ++g) {
    const GroupSpec& other = scene.groups[g];
    if (!other.from || other.is_left_out) continue;
    if (!group.name.empty() || !other.name.empty()) {
      if (group.name == other.name) return g;
      continue;
    }
    if (other.count != group.count || *other.from >= there.groups.size()) continue;
    bool same = true;
    for (std::size_t k = 0; k < group.count && same; ++k) {
      const BodySpec& old = there.bodies[there.groups[*other.from].first + k];
      const BodySpec& now = scene.bodies[group.first + k];
      same = same_place(old, now) && there.shapes[old.shape].type == scene.shapes[now.shape].type;
    }
    if (same) return g;
  }
  return std::nullopt;
}

/// What this scene says about a body of the run and the run overrules.
void tell_overruled(Draft& draft, const GroupSpec& own, const GroupSpec& old) {
  const Scene& there = draft.scene.start->made->assembly->scene;
  if (*old.from >= there.groups.size()) return;
  bool moved = false, reshaped = false;
  for (std::size_t k = 0; k < own.count; ++k) {
    const BodySpec& now = draft.scene.bodies[own.first + k];
    const BodySpec& then = there.bodies[there.groups[*old.from].first + k];
    moved = moved || !same_place(now, then) || now.velocity != then.velocity ||
            now.angular_velocity != then.angular_velocity;
    reshaped = reshaped || draft.scene.shapes[now.shape].type != there.shapes[then.shape].type;
  }
  const std::string of_run = "[[body]] '" + own.name + "' is a body of the run that the scene starts from";
  if (moved)
    draft.reading.warning(own.place, of_run + ": place and velocity are those of there, not the ones written here");
  if (reshaped)
    draft.reading.warning(own.place, of_run +
                                         ", with another shape: it stands where that one stood; give it another "
                                         "name, and leave that one out by [start] bodies or region, to place it");
}

}  // namespace

void settle_imported(Draft& draft) {
  Scene& scene = draft.scene;
  const std::size_t own = scene.groups.size() - 1;
  const bool new_now = scene.groups[own].stage == draft.stage;
  if (!scene.start || scene.groups[own].stage > 0) {
    scene.changes_bodies = scene.changes_bodies || (draft.stage > 0 && new_now);
    return;
  }
  const auto like = imported_like(draft, own);
  const GroupSpec group = scene.groups[own];
  const bool changed = scene.changes_bodies;
  scene.changes_bodies = changed || new_now;
  if (!like) return;
  const GroupSpec& old = scene.groups[*like];
  if (old.count != group.count)
    return draft.reading.error(
        group.place, fmt::format("'{}' has {} bodies in the run that the scene starts from, here {}", group.name,
                                 old.count, group.count));
  tell_overruled(draft, group, old);
  bool differs = false;
  for (std::size_t k = 0; k < group.count; ++k) {
    BodySpec now = std::move(scene.bodies[group.first + k]);
    BodySpec& before = scene.bodies[old.first + k];
    differs = differs || now.fixed != before.fixed || now.material != before.material || now.motion || before.motion ||
              now.servo || before.servo || now.load || before.load || now.force.has_value() != before.force.has_value();
    now.group = *like;
    now.absent = before.absent;
    now.position = before.position;
    now.orientation = before.orientation;
    now.velocity = before.velocity;
    now.angular_velocity = before.angular_velocity;
    before = std::move(now);
  }
  scene.changes_bodies = changed || (differs && new_now);
  scene.groups[*like].group = group.group;
  scene.bodies.resize(group.first);
  scene.groups.pop_back();
}

}  // namespace epafi
