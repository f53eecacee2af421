/// @file read_outputs.cpp  [[measure]], [bounds], [accuracy], [sweep], [benchmark], [output].
#include <algorithm>

#include "engine/units/nearest.h"
#include "scenes/reader/parts.h"
#include "scenes/reader/repeat.h"

namespace epafi {
namespace {

bool takes(const Entry& entry, const std::string& name) {
  return std::any_of(entry.fields.begin(), entry.fields.end(), [&](const Field& f) { return f.name == name; });
}

/// Keeps the fields of the kind; reports missing ones, warns of unused ones.
void keep_fields(Reading& reading, const TableValues& values, const Entry& entry, const std::string& label,
                 Parameters& out) {
  const auto belongs = [](const std::string& key, const std::string& name) {
    return key == name || key.compare(0, name.size() + 1, name + ".") == 0;
  };
  for (const auto& field : entry.fields) {
    for (const auto& [key, value] : values.all())
      if (belongs(key, field.name)) out.set(key, value);
    if (!field.optional && !field.default_value && !values.meant(field.name)) {
      reading.error(values.place,
                    "missing key '" + field.name + "' in " + label + ": kind '" + entry.name + "' needs it");
    }
  }
  for (const auto& [key, place] : values.places) {
    if (key == "name" || key == "kind" || key == "interval" || key.find('.') != std::string::npos) continue;
    if (key == "group" && takes(entry, "body")) continue;
    const bool used =
        std::any_of(entry.fields.begin(), entry.fields.end(), [&, &k = key](const Field& f) { return f.name == k; });
    if (!used) reading.warning(place, label + ": " + key + " is not used by kind '" + entry.name + "'");
  }
}

/// True where the scene has a periodic domain that was left out after an error.
bool has_unread_cell(const Draft& draft) {
  const Node* world = draft.reading.root.find("world");
  const Node* domain = world ? world->find("domain") : nullptr;
  return !draft.scene.cell && draft.reading.errors() > 0 && domain && domain->find("periodic");
}

/// Checks that the region of a measure is given and its outlet exists.
void check_places(Draft& draft, const TableValues& values, const Entry& entry, const Parameters& p,
                  const std::string& label) {
  Reading& reading = draft.reading;
  if (p.has("region.box.min") && p.has("region.box.max"))
    check_box(reading, p.vec3("region.box.min"), p.vec3("region.box.max"), values.place_of("region.box"),
              label + " region");
  const bool takes_region =
      std::any_of(entry.fields.begin(), entry.fields.end(), [](const Field& f) { return f.name == "region"; });
  const auto& cell = draft.scene.cell;
  const bool endless = cell && cell->cell.repeats == std::array{true, true, true};
  const bool may_do_without = takes(entry, "plane");  // it counts everywhere
  const bool told = values.meant("region") || has_unread_cell(draft);
  if (takes_region && !p.has("region.box.min") && !endless && !may_do_without && !told)
    reading.error(values.place, "missing key 'region' in " + label + ": kind '" + entry.name + "' needs it");
  if (p.has("outlet")) {
    std::vector<std::string> names;
    for (const auto& o : draft.scene.outlets) names.push_back(o.name);
    if (std::find(names.begin(), names.end(), p.text("outlet")) == names.end())
      reading.error(values.place_of("outlet"), "unknown outlet '" + p.text("outlet") + "' in " + label +
                                                   suggestion(p.text("outlet"), names, "outlets"));
  }
}

/// The body whose frame a measure uses; exactly one, with an orientation.
NamedBodies read_reference(Draft& draft, const TableValues& values, const std::string& label) {
  const std::string& name = values.text("relative_to");
  const Place place = values.place_of("relative_to");
  const std::size_t errors = draft.reading.errors();
  NamedBodies found = find_bodies(draft, name, place, label);
  const bool one = found.fills.empty() && found.bodies.size() == 1 && found.bodies[0].count == 1;
  const std::string what = label + " relative_to: '" + name + "' ";
  if (draft.reading.errors() != errors) return found;
  if (!one)
    draft.reading.error(place, what + "is not one body; name one of [[body]]");
  else if (draft.scene.shapes[draft.scene.bodies[found.bodies[0].first].shape].type == "sphere")
    draft.reading.error(place, what + "is a sphere, whose turns are not followed; name a body of another shape");
  return found;
}

/// True where all are fixed or driven.
bool are_held(const Scene& scene, const NamedBodies& named) {
  return named.fills.empty() && std::ranges::all_of(named.bodies, [&](const NamedBodies::Range& range) {
           const auto begin = scene.bodies.begin() + static_cast<std::ptrdiff_t>(range.first);
           return std::all_of(begin, begin + static_cast<std::ptrdiff_t>(range.count), [&](const BodySpec& b) {
             return (b.fixed || b.motion || b.servo) && scene.shapes[b.shape].type != "wheel_profile";
           });
         });
}

/// Checks a measure between two: a body has no contact with itself, held bodies have none with each other.
void check_two(Draft& draft, const TableValues& values, const MeasureSpec& measure, const std::string& label) {
  const auto one = [](const NamedBodies& n) {
    return n.fills.empty() && n.bodies.size() == 1 && n.bodies[0].count == 1;
  };
  const NamedBodies &a = measure.bodies[0], &b = measure.bodies[1];
  if (one(a) && one(b) && a.bodies[0].first == b.bodies[0].first)
    draft.reading.error(values.place_of("between"), label + " between: '" + values.texts("between")[0] +
                                                        "' is one body and is named twice; name two bodies or groups");
  else if (are_held(draft.scene, a) && are_held(draft.scene, b))
    draft.reading.warning(values.place_of("between"),
                          label + " between: fixed and driven bodies have no contacts with each other: it stays 0");
}

void read_measure(Draft& draft, const Node& item) {
  Reading& reading = draft.reading;
  const std::string label = item_label("measure", item);
  const Node* kind = item.find("kind");
  const auto& entries = reading.registry.measures;
  const auto all = reading.schema.at("measure").fields;
  const std::vector<Field> common(all.begin(), all.begin() + 5);  // name, repeat, kind, interval, group
  TableValues values =
      read_table(item, label, common + as_optional(united_fields(entries, kind ? kind->text : "")), reading,
                 common + (kind && find_entry(entries, kind->text) ? find_entry(entries, kind->text)->fields
                                                                   : united_fields(entries)));
  const Entry* entry = values.has("kind") ? find_entry(entries, values.text("kind")) : nullptr;
  if (!entry) return;
  MeasureSpec measure{values.has("name") ? values.text("name") : entry->name,
                      entry->name,
                      values.number_or("interval", 0.0),
                      !values.written("interval"),
                      {},
                      {},
                      item.place};
  const bool by_group = values.written("group") && takes(*entry, "body");
  const std::string name_written = by_group ? "group" : "body";
  if (by_group && values.written("body"))
    reading.error(values.place_of("group"), label + ": body and group are both given; write one");
  if (by_group && values.has("group")) {
    values.set("body", Value(values.text("group")));
    values.places["body"] = values.place_of("group");
  }
  keep_fields(reading, values, *entry, label, measure.parameters);
  auto& p = measure.parameters;
  if (p.has("plane.normal")) {
    const auto normal =
        unit_vector(reading, p.vec3("plane.normal"), values.place_of("plane.normal"), label + " plane normal");
    if (normal) p.set("plane.normal", *normal);
  }
  if (p.has("body")) measure.bodies.push_back(find_bodies(draft, p.text("body"), values.place_of(name_written), label));
  if (p.has("relative_to")) measure.bodies.push_back(read_reference(draft, values, label));
  check_places(draft, values, *entry, p, label);
  if (p.has("between")) {
    for (const auto& name : p.texts("between"))
      measure.bodies.push_back(find_bodies(draft, name, values.place_of("between"), label));
    check_two(draft, values, measure, label);
  }
  for (const auto& other : draft.scene.measures) {
    if (other.name != measure.name) continue;
    reading.error(
        values.written("name") ? values.place_of("name") : item.place,
        "the measure '" + measure.name + "' is given twice; first in line " + std::to_string(other.place.line));
  }
  draft.scene.measures.push_back(std::move(measure));
}

/// `body` or `group`, whichever is written: both take names of bodies and of groups.
std::string name_key(Draft& draft, const TableValues& values, const std::string& prefix, const std::string& label) {
  const bool body = values.written(prefix + "body"), group = values.written(prefix + "group");
  if (body == group && values.written(prefix.substr(0, prefix.size() - 1)))
    draft.reading.error(body ? values.place_of(prefix + "group") : values.place_of(prefix.substr(0, prefix.size() - 1)),
                        body ? label + ": body and group are both given; write one"
                             : "missing key 'body' in " + label + " (name of the body or bodies, no unit)");
  return prefix + (group ? "group" : "body");
}

/// [[bounds.measure]]
void read_measure_bounds(Draft& draft, std::vector<BoundSpec>& bounds) {
  Reading& reading = draft.reading;
  const std::string label = "[[bounds.measure]]";
  each_item(reading, "bounds.measure", [&](const Node& item) {
    const TableValues v = read_table(item, label, reading.schema.at("bounds.measure").fields, reading);
    BoundSpec bound;
    bound.quantity = "measure";
    bound.place = item.place;
    bound.stops = v.has("then") && v.text("then") == "stop";
    bound.after = v.number_or("after", 0.0);
    bound.broken = read_condition(reading, v, "", label);
    bound.limit = bound.broken.limit;
    check_condition(draft, bound.broken, v.place_of("measure"), label);
    bound.broken.above = !bound.broken.above;  // left where it does not stay above, or below
    bound.body = bound.broken.measure + "." + bound.broken.component;
    bounds.push_back(std::move(bound));
  });
}

std::vector<BoundSpec> read_bound_table(Draft& draft, const std::string& name) {
  Reading& reading = draft.reading;
  std::vector<BoundSpec> bounds;
  const std::string label = "[" + name + "]";
  const auto& fields = reading.schema.at(name).fields;
  const TableValues values = read_table(table_or_empty(reading, name), label, fields, reading);
  for (const auto& field : fields) {
    BoundSpec bound;
    bound.quantity = field.name;
    bound.place = values.place_of(field.name);
    if (field.kind == Kind::tables) continue;  // of measures
    if (field.kind == Kind::bound) {
      if (!values.has(field.name)) continue;
      bound.limit = values.number(field.name);
      if (const Node* own = table_or_empty(reading, name).find(field.name); own->type == Node::Type::table)
        bound.stops = read_table(*own, label + " " + field.name, number_bound_fields(), reading).text("then") == "stop";
    } else {
      const std::string key = name_key(draft, values, field.name + ".", label + " " + field.name);
      if (!values.has(key) || !values.has(field.name + ".below")) continue;
      bound.limit = values.number(field.name + ".below");
      bound.body = values.text(key);
      bound.after = values.number_or(field.name + ".after", 0.0);
      bound.stops = values.has(field.name + ".then") && values.text(field.name + ".then") == "stop";
      bound.bodies = find_bodies(draft, bound.body, values.place_of(key), label + " " + field.name);
    }
    const bool has_solver = draft.scene.contact.method.value == Method::nonsmooth;
    if (field.name == "residual" && !has_solver)
      reading.warning(bound.place, label + " residual is not used by method 'smooth'");
    bounds.push_back(std::move(bound));
  }
  return bounds;
}

/// Checks a key path as of --set: its first part is a table of the scene, a parameter exists.
void check_path(Reading& reading, const std::string& path, const Place& place) {
  const std::size_t dot = path.find('.');
  const std::string first = path.substr(0, dot);
  std::vector<std::string> tables;
  for (const auto& table : reading.schema.tables)
    if (table.name.find('.') == std::string::npos) tables.push_back(table.name);
  if (dot == std::string::npos || dot + 1 == path.size())
    return reading.error(place, "expected a key path like \"params.n\", found '" + path + "'");
  if (std::find(tables.begin(), tables.end(), first) == tables.end())
    return reading.error(place, "unknown table '" + first + "' in the key path '" + path + "'" +
                                    suggestion(first, tables, "known tables"));
  if (first != "params") return;
  const Node* params = reading.root.find("params");
  std::vector<std::string> names;
  for (const auto& member : params ? params->members : std::vector<Member>{}) names.push_back(member.key);
  const std::string name = path.substr(dot + 1);
  if (std::find(names.begin(), names.end(), name) == names.end())
    reading.error(place, "unknown parameter '" + name + "' in the key path '" + path + "'" +
                             suggestion(name, names, "parameters"));
}

/// Bare dotted keys are nested tables in TOML: params.n = [..] reads as params = { n = [..] }.
void collect_variations(Reading& reading, const std::string& label, const std::string& prefix, const Node& table,
                        std::vector<Variation>& out) {
  for (const auto& [key, place, value] : table.members) {
    const std::string path = prefix.empty() ? key : prefix + "." + key;
    if (value.type == Node::Type::table) {
      collect_variations(reading, label, path, value, out);
      continue;
    }
    if (value.type != Node::Type::array || value.items.empty()) {
      reading.error(value.place, label + " '" + path + "': expected a list of values, found " +
                                     (value.type == Node::Type::array ? "an empty list" : type_name(value.type)));
      continue;
    }
    check_path(reading, path, place);
    Variation variation{path, {}, value.place};
    for (const auto& item : value.items) variation.values.push_back(to_toml(item));
    out.push_back(std::move(variation));
  }
}

}  // namespace

void read_outlets(Draft& draft) {
  Reading& reading = draft.reading;
  each_item(reading, "outlet", [&](const Node& item) {
    const std::string label = item_label("outlet", item);
    const TableValues values = read_table(item, label, reading.schema.at("outlet").fields, reading);
    if (!values.has("region.box.min") || !values.has("region.box.max")) return;
    OutletSpec outlet{values.has("name") ? values.text("name") : "outlet",
                      {values.vec3("region.box.min"), values.vec3("region.box.max")},
                      item.place};
    check_box(reading, outlet.region.min, outlet.region.max, values.place_of("region.box"), label + " region");
    for (const auto& other : draft.scene.outlets)
      if (other.name == outlet.name)
        reading.error(item.place, "the outlet '" + outlet.name + "' is given twice; first in line " +
                                      std::to_string(other.place.line));
    draft.scene.outlets.push_back(std::move(outlet));
  });
}

void read_measures(Draft& draft) {
  Reading& reading = draft.reading;
  each_item(reading, "measure", [&](const Node& item) {
    const Node* kind = item.find("kind");
    each_copy(reading, item, item_label("measure", item), reading.schema.at("measure").fields,
              kind ? kind->text : "measure", [&](const Node& copy) { read_measure(draft, copy); });
  });
}

void read_bounds(Draft& draft) {
  draft.scene.bounds = read_bound_table(draft, "bounds");
  read_measure_bounds(draft, draft.scene.bounds);
  draft.scene.accuracy = read_bound_table(draft, "accuracy");
}

void read_studies(Draft& draft) {
  Reading& reading = draft.reading;
  collect_variations(reading, "[sweep]", "", table_or_empty(reading, "sweep"), draft.scene.sweep);
  if (const Node* table = find_table(reading, "benchmark")) {
    const TableValues values = read_table(*table, "[benchmark]", reading.schema.at("benchmark").fields, reading);
    BenchmarkSpec benchmark{{}, values.has("error") ? values.text("error") : "", table->place};
    if (const Node* sizes = find_table(reading, "benchmark.sizes"))
      collect_variations(reading, "[benchmark] sizes", "", *sizes, benchmark.sizes);
    draft.scene.benchmark = std::move(benchmark);
  }
  const TableValues output =
      read_table(table_or_empty(reading, "output"), "[output]", reading.schema.at("output").fields, reading);
  draft.scene.output.orientation = {output.boolean("orientation"), output.place_of("orientation")};
  if (!output.has("problems.every")) return;
  draft.scene.output.problems_every = output.placed_number("problems.every");
  if (draft.scene.contact.method.value == Method::smooth)
    reading.warning(output.place_of("problems"), "[output] problems is not used by method 'smooth'");
}

}  // namespace epafi
