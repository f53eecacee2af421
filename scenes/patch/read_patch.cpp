#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "detection/shapes/rail_profile.h"
#include "detection/shapes/wheel_profile.h"
#include "engine/units/nearest.h"
#include "laws/material.h"
#include "laws/wheel_rail/normal_models.h"
#include "laws/wheel_rail/tangential_models.h"
#include "scenes/full_registry.h"
#include "scenes/patch/patch_case.h"
#include "scenes/patch/patch_schema.h"
#include "scenes/railway/plausible.h"
#include "scenes/railway/profiles.h"
#include "scenes/reader/file_kind.h"
#include "scenes/reader/parts.h"
#include "viz_export/files/side_file.h"

namespace epafi {
namespace {

const char* kind_of(const Node& node) { return type_name(node.type); }

/// The tables a case may have.
void check_tables(Reading& reading) {
  const std::vector<std::string> known{"title", "include", "params", "material", "contact", "shape", "patch"};
  for (const auto& [key, place, value] : reading.root.members) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    reading.error(place, "unknown table or key '" + key + "' in a patch case" + suggestion(key, known, "known"));
  }
}

struct NamedMaterial {
  Material material;
  std::optional<double> yield;
};

std::vector<NamedMaterial> read_patch_materials(Reading& reading) {
  std::vector<NamedMaterial> all;
  for (const auto& [name, place, node] : table_or_empty(reading, "material").members) {
    const std::string label = "[material." + name + "]";
    if (node.type != Node::Type::table) {
      reading.error(node.place, label + ": expected a table, found " + kind_of(node));
      continue;
    }
    const TableValues v = read_table(node, label, patch_material_fields(), reading);
    NamedMaterial m;
    m.material.name = name;
    m.yield = v.optional_number("shear_yield");
    m.material.poissons_ratio = v.number_or("poissons_ratio", m.material.poissons_ratio);
    if (v.has("youngs_modulus") == v.has("shear_modulus") && reading.errors() == 0)
      reading.error(node.place, label + ": write one of youngs_modulus and shear_modulus");
    m.material.youngs_modulus = v.has("youngs_modulus")
                                    ? v.number("youngs_modulus")
                                    : 2.0 * v.number_or("shear_modulus", NAN) * (1.0 + m.material.poissons_ratio);
    all.push_back(m);
  }
  if (all.empty()) reading.error({reading.main_file, 1, 1}, "missing table [material.NAME] with the elastic constants");
  return all;
}

const NamedMaterial* material_named(Reading& reading, const std::vector<NamedMaterial>& all, const std::string& name,
                                    const Place& place) {
  std::vector<std::string> names;
  for (const auto& m : all) {
    if (m.material.name == name) return &m;
    names.push_back(m.material.name);
  }
  reading.error(place, "unknown material '" + name + "' in [patch] materials" + suggestion(name, names, "materials"));
  return nullptr;
}

void set_materials(Reading& reading, const TableValues& patch, PatchCase& out) {
  const auto all = read_patch_materials(reading);
  if (all.empty()) return;
  const NamedMaterial *a = &all.front(), *b = a;
  if (patch.has("materials")) {
    const auto& names = patch.texts("materials");
    a = material_named(reading, all, names[0], patch.place_of("materials"));
    b = material_named(reading, all, names[1], patch.place_of("materials"));
    if (!a || !b) return;
  } else if (all.size() > 1) {
    reading.warning(patch.place, "several materials; both bodies are of '" + a->material.name +
                                     "' unless [patch] materials names two");
  }
  out.elastic = elastic_pair(a->material, b->material);
  if (a->yield || b->yield) out.yield = std::min(a->yield.value_or(INFINITY), b->yield.value_or(INFINITY));
}

/// A profile by file or by name; reports what is wrong with either.
std::optional<Profile> read_profile_keys(Reading& reading, TableValues v, const std::string& label, bool is_wheel,
                                         std::vector<std::string>& doubts) {
  if (v.has("file")) v.set("file", resolve_path(v.text("file"), v.place_of("file"), reading.main_file));
  Built<Profile> built = build_profile(v, is_wheel, label);
  if (!built.value)
    reading.error(!built.place.file.empty() ? built.place
                  : built.key.empty()       ? v.place
                                            : v.place_of(built.key),
                  built.problem);
  for (std::string& text : built.doubts) {
    reading.warning(v.place, text);
    doubts.push_back(std::move(text));
  }
  return std::move(built.value);
}

/// Warns of dimensions that no track has, nor a scale model: millimetres written as metres.
void check_dimensions(Reading& reading, const TableValues& patch, ProfileCase& c) {
  constexpr double largest = 3.0;
  const std::pair<const char*, double> all[] = {{"wheel radius", c.track.radius},
                                                {"gauge", c.track.gauge},
                                                {"flange_back", c.track.flange_back},
                                                {"rolling_radius", c.rolling_radius.value_or(0.0)},
                                                {"lateral_shift", std::abs(c.position.lateral_shift)}};
  for (const auto& [name, value] : all) {
    if (value <= largest) continue;
    const std::string text =
        fmt::format("[patch] {} = {:.4g} m: is it in millimetres? write \"{:.4g} mm\"", name, value, value);
    reading.warning(patch.place, text);
    c.doubts.push_back(text);
  }
  // wheels have a width of 1/4 of their radius, rails of 1/20 of the gauge; inches read as mm give 1/25 of that
  const std::pair<const char*, std::string> widths[] = {
      {"wheel_profile", scale_remark(c.wheel.y_max() - c.wheel.y_min(), c.track.radius, 0.03)},
      {"rail_profile", scale_remark(c.rail.y_max() - c.rail.y_min(), c.track.gauge, 0.008)}};
  for (const auto& [name, remark] : widths) {
    if (remark.empty()) continue;
    reading.warning(patch.place, fmt::format("[patch] {}: {}", name, remark));
    c.doubts.push_back(fmt::format("{}: {}", name, remark));
  }
}

/// For a rail without a gauge face, the gauge of the case is taken at its last points.
void check_gauge(Reading& reading, const TableValues& patch, const ProfileCase& c) {
  const std::string face = gauge_face_problem(c.rail, c.track, "[patch] gauge");
  if (face.empty()) return;
  if (patch.written("gauge"))
    reading.warning(patch.place_of("gauge"), face);
  else
    reading.error(patch.place, face);
}

/// The wheel and rail of [shape.*]; places and track come from [patch].
void set_profiles(Reading& reading, const TableValues& patch, PatchCase& out) {
  std::optional<Profile> wheel, rail;
  ProfileCase c;
  for (const auto& [name, place, node] : table_or_empty(reading, "shape").members) {
    const std::string label = "[shape." + name + "]";
    const Node* w = node.find("wheel_profile");
    const Node* r = node.find("rail_profile");
    if (node.type != Node::Type::table || (w != nullptr) == (r != nullptr) || node.members.size() != 1) {
      reading.error(node.place,
                    label + ": in a patch case a shape is one wheel_profile = { ... } or one rail_profile = { ... }");
      continue;
    }
    const TableValues v = read_table(w ? *w : *r, label + (w ? " wheel_profile" : " rail_profile"),
                                     w ? WheelProfile::entry().fields : RailProfile::entry().fields, reading);
    auto profile = read_profile_keys(reading, v, label, w != nullptr, c.doubts);
    if (!profile) continue;
    if ((w ? wheel : rail).has_value()) reading.error(node.place, label + ": a second profile of its kind");
    if (w) c.track.radius = v.number_or("radius", c.track.radius);
    (w ? wheel : rail) = std::move(profile);
  }
  if (!wheel || !rail) {
    if (reading.errors() == 0)
      reading.error(patch.place,
                    "[patch] without radii and semi_axes needs a wheel_profile and a rail_profile under [shape.*]");
    return;
  }
  c.wheel = std::move(*wheel);
  c.rail = std::move(*rail);
  c.track.gauge = patch.number("gauge");
  c.track.flange_back = patch.number("flange_back");
  c.track.tape_circle = patch.number("tape_circle");
  c.position.lateral_shift = patch.number_or("lateral_shift", 0.0);
  c.position.yaw = patch.number_or("yaw", 0.0);
  c.position.roll = patch.number_or("roll", 0.0);
  c.roll_given = patch.has("roll");
  c.rolling_radius = patch.optional_number("rolling_radius");
  c.right = patch.text("side") == "right";
  c.creepage_given = patch.written("creepage");
  check_gauge(reading, patch, c);
  check_dimensions(reading, patch, c);
  out.profiles = std::move(c);
}

/// Requires exactly one description of the geometry.
void set_geometry(Reading& reading, const TableValues& v, PatchCase& out) {
  if (v.written("radii") && v.written("semi_axes"))
    return reading.error(v.place, "[patch]: write one of radii = { x1, x2, y1, y2 } and semi_axes = { a, b }");
  if (!v.written("radii") && !v.written("semi_axes")) return set_profiles(reading, v, out);
  for (const char* key :
       {"lateral_shift", "yaw", "roll", "gauge", "flange_back", "tape_circle", "rolling_radius", "side"})
    if (v.written(key)) reading.warning(v.place_of(key), std::string(key) + " is not used without profiles");
  if (v.has("semi_axes.a") && v.has("semi_axes.b"))
    out.ellipse = Ellipse{v.number("semi_axes.a"), v.number("semi_axes.b")};
  if (!v.written("radii")) return;
  const auto curvature = [&](const char* one, const char* two) {
    const double r1 = v.number_or(one, NAN), r2 = v.number_or(two, NAN);
    if (r1 == 0.0 || r2 == 0.0)
      reading.error(v.place_of("radii"), "[patch] radii: a radius of 0 is an edge; inf is flat, negative is concave");
    return 1.0 / r1 + 1.0 / r2;
  };
  out.radii = PatchCase::Radii{v.number_or("radii.x1", NAN), v.number_or("radii.x2", NAN), v.number_or("radii.y1", NAN),
                               v.number_or("radii.y2", NAN)};
  const double x = curvature("radii.x1", "radii.x2"), y = curvature("radii.y1", "radii.y2");
  out.length = v.optional_number("length");
  if (x < 0.0 || y < 0.0)
    reading.error(v.place_of("radii"),
                  "[patch] radii: the surfaces cross away from the point (1/x1 + 1/x2 = " + format_number(x) +
                      ", 1/y1 + 1/y2 = " + format_number(y) + " per m); both must be positive");
  else if (x == 0.0 && y == 0.0)
    reading.error(v.place_of("radii"), "[patch] radii: two flat surfaces have no contact point");
  else if ((x == 0.0 || y == 0.0) && !out.length)
    reading.error(v.place_of("radii"), "[patch] radii: a line contact needs its length (m)");
  if (!out.length || x == 0.0 || y == 0.0) return;
  reading.warning(v.place_of("length"), "[patch] length is not used: these radii touch in an ellipse");
  out.length.reset();
}

void set_load(Reading& reading, const TableValues& v, PatchCase& out) {
  if (v.meant("load") == v.meant("approach"))
    return reading.error(v.place, "[patch]: write one of load (N) and approach (m)");
  out.target = {v.written("load"), v.written("load") ? v.number_or("load", 0.0) : v.number_or("approach", 0.0)};
  const bool line = out.radii && out.length;
  if (line && !out.target.by_force)
    reading.error(v.place_of("approach"),
                  "[patch] a line contact needs a load; the approach of two long bodies is not theirs alone");
  if (out.ellipse && !out.target.by_force)
    reading.error(v.place_of("approach"), "[patch] semi_axes need a load; the approach follows");
}

void set_friction(Reading& reading, bool needed, PatchCase& out) {
  const Node& table = table_or_empty(reading, "contact");
  const TableValues v = read_table(table, "[contact]", patch_contact_fields(), reading);
  if (!v.has("friction")) {
    if (needed && !v.meant("friction"))
      reading.error({reading.main_file, 1, 1}, "missing key 'friction' in [contact]: a tangential model needs it");
    return;
  }
  out.friction = v.number("friction");
  out.falling = {v.number_or("friction_limit", 1.0), v.number_or("friction_decay", 0.0), v.number_or("speed", 0.0)};
  constexpr std::array keys{"friction_limit", "friction_decay", "speed"};
  const bool falls = out.falling.limit < 1.0 && out.falling.decay > 0.0 && out.falling.speed > 0.0;
  for (const char* key : keys)
    if (v.written(key) && !falls)
      reading.warning(v.place_of(key), std::string("[contact] ") + key +
                                           " has no effect: friction falls with slip where friction_limit < 1, "
                                           "friction_decay > 0 and speed > 0 are all written");
}

PatchReading read_document(Document document, const std::string& file) {
  PatchReading result;
  Reading reading(full_registry(), document.root, file);
  reading.problems = std::move(document.problems);
  const bool whole = reading.problems.empty();
  if (!document.failed && !report_other_kind(reading, FileKind::patch_case)) {
    PatchCase out;
    out.file = file;
    if (const Node* title = reading.root.find("title")) {
      if (title->type != Node::Type::text)
        reading.error(title->place, std::string("title: expected a text, found ") + kind_of(*title));
      out.title = title->text;
    }
    check_tables(reading);
    reading.check_params();
    if (const Node* table = find_table(reading, "patch")) {
      const TableValues v = read_table(*table, "[patch]", patch_fields(), reading);
      out.creepage = {v.number_or("creepage.longitudinal", 0.0), v.number_or("creepage.lateral", 0.0),
                      v.number_or("creepage.spin", 0.0)};
      if (v.has("normal")) out.normal = v.texts("normal");
      if (v.has("tangential")) out.tangential = v.texts("tangential");
      out.dx = v.number_or("grid.dx", 0.0);
      out.dy = v.number_or("grid.dy", 0.0);
      out.influence = {v.number_or("influence.full", out.influence.full),
                       v.number_or("influence.none", out.influence.none)};
      out.penalty = v.number_or("penalty", out.penalty);
      out.distance = v.number_or("distance", 0.0);
      if (out.influence.none < out.influence.full)
        reading.error(v.place_of("influence"), "[patch] influence: none must not be smaller than full");
      set_materials(reading, v, out);
      set_geometry(reading, v, out);
      set_load(reading, v, out);
      set_friction(reading, !out.tangential.empty(), out);
    } else {
      reading.error({file, 1, 1}, "missing table [patch]");
    }
    if (whole && reading.errors() == 0) result.patch = std::move(out);
  }
  result.problems = std::move(reading.problems);
  return result;
}

}  // namespace

bool is_patch_case(const Document& document) { return document.root.find("patch") != nullptr; }

PatchReading read_patch(const std::string& path, const std::vector<std::string>& overrides) {
  return read_document(load_document(path, overrides), path);
}

PatchReading read_patch_text(const std::string& text, const std::string& file,
                             const std::vector<std::string>& overrides) {
  return read_document(parse_document(text, file, overrides), file);
}

}  // namespace epafi
