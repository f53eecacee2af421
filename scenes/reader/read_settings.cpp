/// @file read_settings.cpp  [run], [world], [material.*], [detection].
#include <cmath>

#include "engine/units/nearest.h"
#include "scenes/reader/parts.h"

namespace epafi {
namespace {

void read_scheme(Draft& draft, const TableValues& run) {
  Reading& reading = draft.reading;
  auto& scheme = draft.scene.run.scheme;
  scheme = run.placed_text("scheme");
  // the method decides; its errors are reported later, with [contact]
  const Node* contact = reading.root.find("contact");
  const Node* method = contact ? contact->find("method") : nullptr;
  const bool nonsmooth = method && method->text == "nonsmooth";
  const auto& fitting = nonsmooth ? reading.registry.nonsmooth_schemes : reading.registry.smooth_schemes;
  const std::string of_method = fitting.empty() ? "" : fitting.front();
  if (!scheme.written()) {
    scheme.value = of_method;
  } else if (!scheme.value.empty() && std::ranges::find(fitting, scheme.value) == fitting.end()) {
    // a scene may hold keys of both methods, so this is no error
    reading.warning(scheme.place, "[run] scheme '" + scheme.value + "' is not used by method '" +
                                      (nonsmooth ? "nonsmooth" : "smooth") + "', which takes '" + of_method + "'");
    scheme.value = of_method;
  }
}

/// E from G where the scene gives the shear modulus: E = 2 G (1 + nu).
void read_moduli(Reading& reading, const TableValues& values, Material& material, const std::string& label) {
  material.youngs_modulus = values.number_or("youngs_modulus", material.youngs_modulus);
  material.poissons_ratio = values.number_or("poissons_ratio", material.poissons_ratio);
  if (!values.has("shear_modulus")) return;
  const Place place = values.place_of("shear_modulus");
  if (values.has("youngs_modulus"))
    return reading.error(place, label + ": youngs_modulus and shear_modulus are both given; write one");
  if (!values.has("poissons_ratio"))
    return reading.error(place, label + ": shear_modulus needs poissons_ratio beside it");
  material.youngs_modulus = 2.0 * values.number("shear_modulus") * (1.0 + material.poissons_ratio);
}

}  // namespace

void read_run(Draft& draft) {
  Reading& reading = draft.reading;
  if (!reading.root.find("run"))
    return reading.error({reading.main_file, 1, 1}, "missing table [run] with the duration");
  const Node* table = find_table(reading, "run");
  if (!table) return;
  const TableValues values = read_table(*table, "[run]", reading.schema.at("run").fields, reading);
  RunSettings& run = draft.scene.run;
  run.duration = values.placed_number("duration");
  run.time_step.place = values.place_of("time_step");
  if (values.has("time_step") && std::holds_alternative<double>(values.all().at("time_step")))
    run.time_step.value = values.number("time_step");
  run.adaptive = values.has("time_step") && !run.time_step.value && values.text("time_step") == "adaptive";
  run.allow_unstable = values.has("allow_unstable") && values.boolean("allow_unstable");
  run.output_interval = values.placed_number("output_interval", run.duration.value / 100.0);
  run.checkpoint_interval = values.optional_number("checkpoint_interval");
  run.seed = static_cast<std::uint64_t>(values.number_or("seed", 1.0));
  read_scheme(draft, values);
}

namespace {

/// Reads the periodic cell of the domain; the domain has no faces along periodic axes.
void read_cell(Draft& draft, const TableValues& v, Domain& domain) {
  Reading& reading = draft.reading;
  const std::string label = "[world] domain";
  const bool rate = v.has("domain.strain_rate"), pressure = v.has("domain.pressure");
  if (!v.has("domain.periodic")) {
    for (const char* key : {"domain.strain_rate", "domain.pressure", "domain.rate_limit", "domain.first_pressure"})
      if (v.written(key))
        reading.error(v.place_of(key), label + ": only a periodic domain deforms; write periodic = [...]");
    return;
  }
  CellSpec spec;
  spec.place = v.place_of("domain.periodic");
  spec.cell.low = domain.min;
  spec.cell.size = domain.max - domain.min;
  for (const std::string& axis : v.texts("domain.periodic"))
    spec.cell.repeats[static_cast<std::size_t>(axis[0] - 'x')] = true;
  if (rate && pressure)
    reading.error(v.place_of("domain.pressure"), label + ": write strain_rate or pressure, not both");
  for (const char* key : {"rate_limit", "first_pressure", "pressure_time"})
    if (const std::string path = std::string("domain.") + key; v.written(path) && !pressure)
      reading.error(v.place_of(path), label + " " + key + " goes with pressure");
  if (v.written("domain.first_pressure") != v.written("domain.pressure_time"))
    reading.error(v.place_of("domain.pressure"), label + ": write first_pressure and pressure_time together");
  if (rate) spec.control.strain_rate = v.vec3("domain.strain_rate");
  if (pressure) spec.control.pressure = v.number("domain.pressure");
  spec.control.first_pressure = v.number_or("domain.first_pressure", 0.0);
  spec.control.pressure_time = v.number_or("domain.pressure_time", 0.0);
  spec.control.rate_limit = v.number_or("domain.rate_limit", 0.0);
  spec.deforms = rate || pressure;
  bool all = true;
  for (int k = 0; k < 3; ++k) {
    const bool repeats = spec.cell.repeats[static_cast<std::size_t>(k)];
    all = all && repeats;
    if (repeats) {
      domain.min[k] = -infinity;
      domain.max[k] = infinity;
    }
    if (!repeats && spec.control.strain_rate[k] != 0.0)
      reading.error(v.place_of("domain.strain_rate"),
                    label + " strain_rate: the domain is not periodic along " + "xyz"[k]);
    if (repeats && spec.deforms && draft.scene.gravity[k] != 0.0)
      reading.error(spec.place, label + ": a cell that deforms along " + "xyz"[k] + " takes no gravity along it");
  }
  if (pressure && !all)
    reading.error(v.place_of("domain.pressure"), label + " pressure needs periodic = [\"x\", \"y\", \"z\"]");
  draft.scene.cell = spec;
}

}  // namespace

void read_world(Draft& draft) {
  Reading& reading = draft.reading;
  const TableValues values =
      read_table(table_or_empty(reading, "world"), "[world]", reading.schema.at("world").fields, reading);
  if (values.has("gravity")) draft.scene.gravity = values.vec3("gravity");
  const Node* gravity = table_or_empty(reading, "world").find("gravity");
  if (gravity && follows_time(reading, *gravity)) {
    const TimedVector read = read_time_vector(reading, *gravity, "m/s^2", "[world] gravity");
    draft.scene.gravity = read.steady;
    draft.scene.loose_gravity = read.loose;
    draft.scene.gravity_since.stage = draft.stage_of_gravity;
  }
  if (!values.has("domain.min") || !values.has("domain.max") || !values.has("domain.outside")) return;
  Placed<Domain> domain{{values.vec3("domain.min"), values.vec3("domain.max"), Domain::Outside::error},
                        values.place_of("domain")};
  if (values.text("domain.outside") == "delete") domain.value.outside = Domain::Outside::remove;
  if (!check_box(reading, domain.value.min, domain.value.max, domain.place, "[world] domain")) return;
  read_cell(draft, values, domain.value);
  draft.scene.domain = domain;
}

void read_materials(Draft& draft) {
  Reading& reading = draft.reading;
  for (const auto& [name, place, node] : table_or_empty(reading, "material").members) {
    const std::string label = "[material." + name + "]";
    MaterialSpec spec;
    spec.material.name = name;
    spec.place = node.place;
    if (node.type != Node::Type::table) {
      reading.error(node.place, label + ": expected a table, found " + type_name(node.type));
    } else {
      const TableValues values = read_table(node, label, reading.schema.at("material").fields, reading);
      spec.material.density = values.number_or("density", spec.material.density);
      read_moduli(reading, values, spec.material, label);
    }
    draft.scene.materials.push_back(spec);  // a wrong one too, so that its name is known
  }
}

std::optional<std::size_t> find_material(Draft& draft, const std::string& name, const Place& place,
                                         const std::string& label) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < draft.scene.materials.size(); ++k) {
    if (draft.scene.materials[k].material.name == name) return k;
    names.push_back(draft.scene.materials[k].material.name);
  }
  draft.reading.error(
      place, "unknown material '" + name + "' in " + label +
                 (names.empty() ? "; there is no [material." + name + "]" : suggestion(name, names, "materials")));
  return std::nullopt;
}

void read_detection(Draft& draft) {
  Reading& reading = draft.reading;
  const auto& entries = reading.registry.broad_phases;
  const TableValues values =
      read_table(table_or_empty(reading, "detection"), "[detection]", reading.schema.at("detection").fields, reading);
  auto& detection = draft.scene.detection;
  detection.broad_phase = values.placed_text("broad_phase");
  const Entry* chosen = find_entry(entries, detection.broad_phase.value);
  for (const auto& field : united_fields(entries, detection.broad_phase.value)) {
    const bool used = chosen && std::any_of(chosen->fields.begin(), chosen->fields.end(),
                                            [&](const Field& f) { return f.name == field.name; });
    if (used && values.has(field.name)) detection.parameters.set(field.name, values.all().at(field.name));
    if (!used && values.written(field.name)) {
      reading.warning(values.place_of(field.name), "[detection] " + field.name + " is not used by broad_phase '" +
                                                       detection.broad_phase.value + "'");
    }
  }
}

}  // namespace epafi
