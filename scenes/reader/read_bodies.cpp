/// @file read_bodies.cpp  [[body]] with `repeat` unrolled, and names of bodies.
#include <fmt/format.h>
#include <numbers>

#include <algorithm>

#include "engine/units/nearest.h"
#include "scenes/reader/parts.h"
#include "scenes/reader/repeat.h"

namespace epafi {
namespace {

Quat read_orientation(Reading& reading, const TableValues& v, const std::string& label) {
  if (v.has("orientation") && v.has("euler_deg")) {
    reading.error(v.place_of("euler_deg"), label + ": orientation and euler_deg are both given; write one");
  }
  if (v.has("orientation")) {
    const auto& q = v.numbers("orientation");
    return Quat(q[0], q[1], q[2], q[3]);
  }
  if (!v.has("euler_deg")) return Quat(1, 0, 0, 0);
  const Vec3 angle = v.vec3("euler_deg") * (std::numbers::pi / 180.0);
  const auto about = [&](int axis) { return Eigen::AngleAxisd(angle[axis], Vec3::Unit(axis)); };
  return Quat(about(2) * about(1) * about(0));  // about x first, then y, then z of the world
}

/// Values whose shape and material are resolved.
struct BodyTable {
  const Node& item;
  std::string label;
  std::size_t group;
  std::optional<MotionSpec> motion{};
  std::optional<ServoSpec> servo{};
  BodySpec loads{};  ///< its force and load
};

/// Reads keys that are not plain values; for a copy, only those that contain its index.
void read_moves(Reading& reading, const TableValues& v, BodyTable& table) {
  const Since since{table.item.stage, 0.0};
  table.motion = {};
  table.servo = {};
  table.loads = {};
  if (const Node* motion = table.item.find("motion")) {
    MotionsRead read = read_motions(reading, *motion, table.label);
    if (!read.parts.empty()) table.motion = MotionSpec{std::move(read.parts), since};
    if (read.servo) table.servo = ServoSpec{*read.servo, since};
  }
  read_body_loads(reading, table.item, v, table.label, since, table.loads);
}

std::optional<BodySpec> make_body(Draft& draft, const BodyTable& table, const TableValues& v,
                                  std::optional<std::size_t> shape) {
  Reading& reading = draft.reading;
  if (!v.has("material")) return std::nullopt;
  const auto material = find_material(draft, v.text("material"), v.place_of("material"), table.label);
  if (!shape || !material) return std::nullopt;
  BodySpec body;
  body.group = table.group;
  body.shape = *shape;
  body.material = *material;
  const auto vec3 = [&](const char* key) { return v.has(key) ? v.vec3(key) : Vec3(Vec3::Zero()); };
  body.fixed = v.has("fixed") && v.boolean("fixed");
  body.continuous = v.has("continuous") && v.boolean("continuous");
  body.on_rails = v.has("on_rails") && v.boolean("on_rails");
  body.as_drawn = v.has("place") && v.text("place") == "as-drawn";
  body.position = vec3("position");
  body.velocity = vec3("velocity");
  body.angular_velocity = vec3("angular_velocity");
  body.orientation = read_orientation(reading, v, table.label);
  if (v.written("angular_velocity")) body.spin_place = v.place_of("angular_velocity");
  body.motion = table.motion;
  body.servo = table.servo;
  body.force = table.loads.force;
  body.load = table.loads.load;
  if (const auto time = v.optional_number("remove_at")) body.remove_at = Removal{*time, {table.item.stage, 0.0}};
  return body;
}

/// Reports keys that exclude each other, once per table.
void check_body(Draft& draft, const BodySpec& body, const TableValues& v, const std::string& label) {
  Reading& reading = draft.reading;
  if (body.fixed && (body.motion || body.servo))
    reading.error(v.place_of("motion"), label + ": a fixed body has no motion; leave out fixed");
  if (body.continuous && !body.moves())
    reading.error(v.place_of("continuous"), label + ": continuous is for free bodies; this one is " +
                                                (body.fixed ? "fixed" : "driven by its motion"));
  if (body.moves()) let_move(draft, body.shape);
  const std::string& form = draft.scene.shapes[body.shape].type;
  if (body.moves() && is_only_wall(form)) {
    reading.error(v.place, label + ": a " + form + " cannot move freely; write fixed = true or give it a motion");
  }
  if (body.on_rails && form != "wheel_profile")
    reading.error(v.place_of("on_rails"), label + ": on_rails is for a wheel_profile, not for a " + form);
  if (!body.fixed && form == "rail_profile")
    reading.error(v.place, label + ": a rail_profile is a track; write fixed = true");
  if (body.moves() && form == "wheel_profile" && !draft.scene.shapes[body.shape].parameters.has("mass"))
    reading.error(v.place, label + ": a wheelset that moves freely needs mass and inertia in its wheel_profile");
  for (const char* key : {"velocity", "angular_velocity", "force"}) {
    if (!body.moves() && v.written(key)) {
      reading.warning(v.place_of(key), label + ": " + key + " is not used: the body is " +
                                           (body.fixed ? "fixed" : "driven by its motion"));
    }
  }
}

/// Reads the whole table once, then per copy only keys with an index: 10^5 bodies take a fraction of a second.
void read_body(Draft& draft, const Node& item) {
  Reading& reading = draft.reading;
  const std::string label = item_label("body", item);
  const auto& fields = reading.schema.at("body").fields;
  const std::size_t errors = reading.errors();
  const auto counts = read_repeat(reading, item, label, fields);
  if (reading.errors() != errors) return;
  Index3 size{1, 1, 1};
  std::copy(counts.begin(), counts.end(), size.begin());
  set_indices(reading, {0, 0, 0}, counts.size());

  std::vector<Field> varying_fields, other_fields;
  const Node varying = part_of(item, [](const Member& m) { return uses_index(m.value); });
  for (const auto& field : fields) {
    if (field.name != "repeat") other_fields.push_back(field);
    if (varying.find(field.name)) varying_fields.push_back(field);
  }
  TableValues values =
      read_table(part_of(item, [](const Member& m) { return m.key != "repeat"; }), label, other_fields, reading);
  const Node* shape_node = item.find("shape");
  std::optional<std::size_t> shape = shape_node ? read_shape_value(draft, *shape_node, label) : std::nullopt;
  const std::string name = values.has("name") ? values.text("name") : "";
  check_group_name(draft, name, values.place_of("name"));
  Scene& scene = draft.scene;
  scene.groups.push_back({name, scene.bodies.size(), 0, item.place, {counts.begin(), counts.end()}});
  scene.groups.back().group = values.has("group") ? values.text("group") : "";
  scene.groups.back().stage = item.stage;
  BodyTable table{item, label, scene.groups.size() - 1};
  read_moves(reading, values, table);
  const bool moves_vary = varying.find("motion") || varying.find("force") || varying.find("torque");
  scene.bodies.reserve(scene.bodies.size() + size[0] * size[1] * size[2]);
  Index3 at{};
  for (at[0] = 0; at[0] < size[0]; ++at[0])
    for (at[1] = 0; at[1] < size[1]; ++at[1])
      for (at[2] = 0; at[2] < size[2]; ++at[2]) {
        const bool first = at == Index3{};
        if (!first && !varying.members.empty()) {
          set_indices(reading, at, counts.size());
          const TableValues own = read_table(varying, label, varying_fields, reading);
          for (const auto& [key, value] : own.all()) values.set(key, value);
          if (moves_vary) read_moves(reading, values, table);
          if (shape_node && uses_index(*shape_node)) shape = read_shape_value(draft, *shape_node, label);
        }
        auto body = make_body(draft, table, values, shape);
        if (body && first && reading.errors() == errors) check_body(draft, *body, values, label);
        if (!body || reading.errors() != errors) return reading.indices.clear();
        scene.bodies.push_back(std::move(*body));
        ++scene.groups.back().count;
      }
  reading.indices.clear();
  settle_imported(draft);
}

}  // namespace

void read_bodies(Draft& draft) {
  each_item(draft.reading, "body", [&](const Node& item) { read_body(draft, item); });
}

void check_group_name(Draft& draft, const std::string& name, const Place& place) {
  if (name.empty()) return;
  Place other;
  for (const auto& group : draft.scene.groups)
    if (group.name == name && !group.from) other = group.place;
  for (const auto& fill : draft.scene.fills)
    if (fill.name == name) other = fill.place;
  if (!other.file.empty())
    draft.reading.error(place, "the name '" + name + "' is given twice; first in line " + std::to_string(other.line));
}

namespace {

/// k of "NAME[k]".
std::optional<std::size_t> index_in(const std::string& name, const std::string& group) {
  if (name.size() < group.size() + 3 || name.compare(0, group.size() + 1, group + "[") != 0 || name.back() != ']')
    return std::nullopt;
  const std::string digits = name.substr(group.size() + 1, name.size() - group.size() - 2);
  if (digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  return std::stoul(digits);
}

/// Adds the body of that name; in a table repeated by two or three counts NAME[n] is its n-th body, in the order of the
/// file.
void add_copy(NamedBodies& found, const GroupSpec& group, const std::string& name) {
  for (std::size_t k = 0; k < group.count; ++k)
    if (body_name(group, k) == name) return found.bodies.push_back({group.first + k, 1});
  const auto number = index_in(name, group.name);
  if (number && group.repeat.size() > 1 && *number < group.count) found.bodies.push_back({group.first + *number, 1});
}

/// Text such as "stack[0] to stack[9]" for a wrong name of a body of that group.
std::string names_of_copies(const Scene& scene, const std::string& name) {
  for (const GroupSpec& group : scene.groups)
    if (!group.name.empty() && group.count > 0 && name.starts_with(group.name + "[") && !group.repeat.empty())
      return "; its bodies are " + body_name(group, 0) + " to " + body_name(group, group.count - 1);
  return {};
}

/// True where a table of that name was reported as wrong: its use is not a second error.
bool is_written(const Reading& reading, const std::string& name) {
  const std::string plain = name.substr(0, name.find('['));
  for (const char* list : {"body", "bodies", "fill"}) {
    const Node* tables = reading.root.find(list);
    if (tables == nullptr) continue;
    for (const Node& item : tables->items) {
      const Node* own = item.find("name");
      if (own != nullptr && own->type == Node::Type::text && (own->text == name || own->text == plain)) return true;
    }
  }
  return false;
}

}  // namespace

NamedBodies find_bodies(Draft& draft, const std::string& name, const Place& place, const std::string& label) {
  NamedBodies found;
  std::vector<std::string> names;
  for (const auto& group : draft.scene.groups) {
    const bool whole = group.name == name, maybe_one = !group.name.empty() && name.rfind(group.name + "[", 0) == 0;
    if (whole && group.count > 0) found.bodies.push_back({group.first, group.count});
    if (maybe_one) add_copy(found, group, name);
    if (!group.name.empty()) names.push_back(group.name);
    if (whole || group.group != name || name.empty()) continue;
    if (group.count > 0) found.bodies.push_back({group.first, group.count});
  }
  for (const auto& group : draft.scene.groups)
    if (!group.group.empty() && std::find(names.begin(), names.end(), group.group) == names.end())
      names.push_back(group.group);
  for (std::size_t f = 0; f < draft.scene.fills.size(); ++f) {
    const auto& fill = draft.scene.fills[f];
    const auto one = index_in(name, fill.name);
    if (fill.name == name || one || (fill.group == name && !name.empty())) found.fills.push_back({f, one});
    names.push_back(fill.name);
    if (!fill.group.empty()) names.push_back(fill.group);
  }
  const bool reported = draft.reading.errors() > 0 && is_written(draft.reading, name);
  if (found.bodies.empty() && found.fills.empty() && !reported) {
    const std::string copies = names_of_copies(draft.scene, name);
    draft.reading.error(place, "unknown body '" + name + "' in " + label +
                                   (copies.empty() ? suggestion(name, names, "bodies") : copies));
  }
  return found;
}

}  // namespace epafi
