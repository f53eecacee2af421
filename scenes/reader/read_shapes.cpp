/// @file read_shapes.cpp  [shape.*] and shapes written in place.
#include <filesystem>

#include "detection/shapes/clump.h"
#include "engine/units/nearest.h"
#include "engine/units/units.h"
#include "scenes/railway/profiles.h"
#include "scenes/reader/parts.h"

namespace epafi {
namespace {

/// The form of the table, as "sphere"; reported if there is none or more than one.
const Entry* find_form(Reading& reading, const Node& table, const TableValues& values, const std::string& label) {
  const Entry* form = nullptr;
  for (const auto& entry : reading.registry.shapes) {
    if (!values.written(entry.name)) continue;
    if (form) {
      reading.error(values.place_of(entry.name),
                    label + " is a " + form->name + " and a " + entry.name + "; a shape has one form");
      return nullptr;
    }
    form = &entry;
  }
  if (!form)
    reading.error(table.place,
                  label + " has no form" + suggestion("", names_of(reading.registry.shapes), "write one of"));
  return form;
}

/// Makes file names relative to the working directory; reports a missing file.
void resolve_file(Reading& reading, ShapeSpec& shape, const Place& place, const std::string& label) {
  if (!shape.parameters.has("file")) return;
  const std::string path = resolve_path(shape.parameters.text("file"), place, reading.main_file);
  std::error_code failure;
  if (!std::filesystem::is_regular_file(path, failure))
    reading.error(place, label + " file: there is no file '" + path + "'");
  shape.parameters.set("file", path);
  reading.files.push_back(path);
}

/// Checks the unit ("mm", "in" ...) of the numbers in the shape's file.
void check_unit(Reading& reading, const ShapeSpec& shape, const Place& place, const std::string& label) {
  if (!shape.parameters.has("unit")) return;
  const std::string& text = shape.parameters.text("unit");
  const UnitResult unit = parse_unit(text);
  if (unit.unit && unit.unit->dimension == Dimension{1}) return;
  reading.error(place, label + " unit: '" + text + "' is no unit of length; write m, mm, cm, um or in");
}

void check_polyhedron(Reading& reading, const ShapeSpec& shape, const std::string& label) {
  const auto& p = shape.parameters;
  const int ways = p.has("file") + p.has("vertices") + p.has("random.vertices");
  if (ways != 1) reading.error(shape.place, label + ": write exactly one of file, vertices, random");
  if (p.has("vertices") && p.vectors("vertices").size() < 4) {
    reading.error(shape.place, label + " vertices: a polyhedron has at least 4, found " +
                                   std::to_string(p.vectors("vertices").size()));
  }
}

void check_cone(Reading& reading, const ShapeSpec& shape, const Place& place, const std::string& label) {
  const auto& radii = shape.parameters.numbers("radii");
  if (radii.size() != 2)
    reading.error(place,
                  label + " radii: two numbers, [at its start, at its end], found " + std::to_string(radii.size()));
  else if (!(radii[0] > 0.0 || radii[1] > 0.0))
    reading.error(place, label + " radii: one of them is positive, found [0, 0]");
}

void check_clump(Reading& reading, const ShapeSpec& shape, const std::string& label) {
  const auto& p = shape.parameters;
  const auto& balls = p.numbers("spheres");
  if (balls.empty() || balls.size() > 4 * Clump::most_parts)
    reading.error(shape.place, label + " spheres: 1 to " + std::to_string(Clump::most_parts) + " balls, found " +
                                   std::to_string(balls.size() / 4));
  for (std::size_t k = 3; k < balls.size(); k += 4)
    if (!(balls[k] > 0)) reading.error(shape.place, label + " spheres: every radius is positive");
  if (p.has("mass") != p.has("inertia") || (p.has("centre") && !p.has("mass")))
    reading.error(shape.place, label + ": mass and inertia are given together, centre with them, or none of them");
}

/// Replaces a clump of one ball at the origin by a sphere, so that it has the same results and the loop over spheres.
void simplify_clump(ShapeSpec& shape) {
  const Parameters& p = shape.parameters;
  if (!p.has("spheres") || p.numbers("spheres").size() != 4 || p.has("mass")) return;
  const std::vector<double> ball = p.numbers("spheres");
  if (ball[0] != 0.0 || ball[1] != 0.0 || ball[2] != 0.0) return;
  shape.type = "sphere";
  shape.parameters = {};
  shape.parameters.set("radius", ball[3]);
}

/// Checks a profile or a track, and reports wrong keys.
void check_railway(Reading& reading, ShapeSpec& shape, const TableValues& values, const std::string& label) {
  const std::string prefix = shape.type + ".";
  for (const char* key : {"file", "irregularity.file"}) {
    if (!shape.parameters.has(key)) continue;
    const std::string path = resolve_path(shape.parameters.text(key), values.place_of(prefix + key), reading.main_file);
    shape.parameters.set(key, path);
    reading.files.push_back(path);
  }
  const auto report = [&](const auto& built) {
    if (built.value) return;
    const bool known = !built.key.empty() && values.written(prefix + built.key);
    reading.error(!built.place.file.empty() ? built.place
                  : known                   ? values.place_of(prefix + built.key)
                                            : shape.place,
                  built.problem);
  };
  const auto warn = [&](const std::vector<std::string>& doubts) {
    for (const std::string& text : doubts) reading.warning(shape.place, text);
  };
  if (shape.type == "wheel_profile") {
    const Built<Wheelset> wheels = build_wheelset(shape.parameters, label);
    report(wheels);
    return warn(wheels.doubts);
  }
  const Built<Track> track = build_track(shape.parameters, label);
  report(track);
  warn(track.doubts);
  if (!track.value) return;
  const std::string face = gauge_face_problem(track.value->rail, track.value->geometry, label);
  if (face.empty()) return;
  if (values.written(prefix + "gauge"))
    reading.warning(values.place_of(prefix + "gauge"), face);
  else
    reading.error(shape.place, face);
}

void check_size(Reading& reading, const TableValues& values, const Entry& form, const std::string& label) {
  if (values.written("scale_to_diameter") && form.name != "polyhedron" && form.name != "sphere" &&
      form.name != "solid") {
    reading.error(values.place_of("scale_to_diameter"),
                  label + ": scale_to_diameter is for a polyhedron, a solid or a sphere, not for a " + form.name);
  }
  if (values.number_or("rounding", 0.0) > 0.0 && form.name != "polyhedron") {
    reading.error(values.place_of("rounding"), label + ": rounding is for a polyhedron, not for a " + form.name);
  }
}

}  // namespace

std::optional<std::size_t> add_shape(Draft& draft, const Node& table, const std::string& name,
                                     const std::string& label) {
  Reading& reading = draft.reading;
  const std::size_t errors = reading.errors();
  const TableValues values = read_table(table, label, reading.schema.at("shape").fields, reading);
  const Entry* form = reading.errors() == errors ? find_form(reading, table, values, label) : nullptr;
  ShapeSpec shape;
  shape.name = name;
  shape.place = table.place;
  if (form) {
    shape.type = form->name;
    const std::string prefix = form->name + ".";
    for (const auto& [key, value] : values.all())
      if (key.compare(0, prefix.size(), prefix) == 0) shape.parameters.set(key.substr(prefix.size()), value);
    shape.scale_to_diameter = values.optional_number("scale_to_diameter");
    shape.rounding = values.number_or("rounding", 0.0);
    const bool railway = form->name == "wheel_profile" || form->name == "rail_profile";
    if (railway && reading.errors() == errors)
      check_railway(reading, shape, values, label + " " + form->name);
    else if (!railway)
      resolve_file(reading, shape, values.place_of(prefix + "file"), label + " " + form->name);
    check_unit(reading, shape, values.place_of(prefix + "unit"), label + " " + form->name);
    if (form->name == "polyhedron") check_polyhedron(reading, shape, label + " polyhedron");
    if (form->name == "cone" && shape.parameters.has("radii"))
      check_cone(reading, shape, values.place_of(prefix + "radii"), label + " cone");
    if (form->name == "clump" && shape.parameters.has("spheres")) check_clump(reading, shape, label + " clump");
    if (shape.parameters.has("normal")) {
      const auto normal = unit_vector(reading, shape.parameters.vec3("normal"), values.place_of(prefix + "normal"),
                                      label + " " + form->name + " normal");
      if (normal) shape.parameters.set("normal", *normal);
    }
    check_size(reading, values, *form, label);
    if (form->name == "clump" && reading.errors() == errors) simplify_clump(shape);
  }
  draft.scene.shapes.push_back(std::move(shape));  // a wrong one too, so that its name is known
  if (reading.errors() != errors) return std::nullopt;
  return draft.scene.shapes.size() - 1;
}

void read_shapes(Draft& draft) {
  for (const auto& [name, place, node] : table_or_empty(draft.reading, "shape").members) {
    const std::string label = "[shape." + name + "]";
    if (node.type == Node::Type::table)
      add_shape(draft, node, name, label);
    else
      draft.reading.error(node.place, label + ": expected a table, found " + type_name(node.type));
  }
}

std::optional<std::size_t> find_shape(Draft& draft, const std::string& name, const Place& place,
                                      const std::string& label) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < draft.scene.shapes.size(); ++k) {
    if (draft.scene.shapes[k].name == name) return k;
    if (!draft.scene.shapes[k].name.empty()) names.push_back(draft.scene.shapes[k].name);
  }
  draft.reading.error(place,
                      "unknown shape '" + name + "' in " + label +
                          (names.empty() ? "; there is no [shape." + name + "]" : suggestion(name, names, "shapes")));
  return std::nullopt;
}

void let_move(Draft& draft, std::size_t shape) {
  std::string& form = draft.scene.shapes[shape].type;
  if (form == "mesh") form = "solid";
}

bool is_only_wall(const std::string& form) { return form == "half_space" || form == "tube" || form == "cone"; }

std::optional<std::size_t> read_shape_value(Draft& draft, const Node& node, const std::string& label) {
  if (node.type == Node::Type::text) return find_shape(draft, node.text, node.place, label);
  if (node.type == Node::Type::table) return add_shape(draft, node, "", label + " shape");
  draft.reading.error(node.place, label + " shape: expected a name or a table, found " + type_name(node.type));
  return std::nullopt;
}

}  // namespace epafi
