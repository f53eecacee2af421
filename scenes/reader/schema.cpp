#include "scenes/reader/schema.h"

#include <algorithm>

#include "engine/units/error.h"
#include "scenes/reader/fields.h"
#include "scenes/reader/schema_acts.h"
#include "viz_export/view/camera.h"
#include "viz_export/view/fields.h"

namespace epafi {
namespace {

constexpr Range whole_positive{1, largest_integer};
constexpr Range seeds{0, largest_integer};
const Vec3 zero = Vec3::Zero();

/// The default if it is in the list, else the first of the list.
Field choice(const std::string& name, std::string help, std::vector<std::string> names, const std::string& preferred) {
  const bool listed = std::find(names.begin(), names.end(), preferred) != names.end();
  const std::string chosen = listed || names.empty() ? preferred : names.front();
  return with_default(word(name, std::move(help), std::move(names)), Value(chosen));
}

TableSchema run_table(const Registry& registry) {
  Field step =
      with_default(optional("time_step", "dt", "s", Kind::number, positive, "time step"), Value(std::string("auto")));
  step.choices = {"auto", "adaptive"};
  Field scheme = word("scheme", "time scheme; default: that of the method", names_of(registry.schemes));
  scheme.optional = true;
  return {
      "run",
      TableSchema::Form::single,
      "time: how long and in which steps",
      {required("duration", "T", "s", Kind::number, positive, "simulated time"), step, scheme,
       with_default(required("allow_unstable", "", "", Kind::boolean, {},
                             "accepts a time step above the limit, to study instability"),
                    Value(false)),
       optional("output_interval", "", "s", Kind::number, positive, "time between snapshots; default: duration / 100"),
       optional("checkpoint_interval", "", "s", Kind::number, positive,
                "time between checkpoints; default: one at the end"),
       with_default(required("seed", "", "", Kind::integer, seeds, "seed of all random numbers"), Value(1.0))}};
}

TableSchema world_table() {
  Field axes = optional("periodic", "", "", Kind::texts, {1, 3}, "axes along which the domain repeats");
  axes.choices = {"x", "y", "z"};
  std::vector<Field> domain{
      required("min", "", "m", Kind::vec3, {}, "lower corner"),
      required("max", "", "m", Kind::vec3, {}, "upper corner"),
      with_default(
          word("outside", "what happens to bodies outside; delete acts every 100th step (20th with non-smooth contact)",
               {"error", "delete"}),
          Value(std::string("error"))),
      axes,
      optional("strain_rate", "", "1/s", Kind::vec3, {}, "strain rate of the periodic axes, extension positive"),
      optional("pressure", "p", "Pa", Kind::number, positive, "the periodic axes strain towards this contact stress"),
      optional("first_pressure", "p_0", "Pa", Kind::number, positive,
               "first pressure; changes geometrically to `pressure` until pressure_time"),
      optional("pressure_time", "", "s", Kind::number, positive, "time at which `pressure` is reached"),
      optional("rate_limit", "", "1/s", Kind::number, positive,
               "largest strain rate with pressure; default: 1e-3 sqrt(p/rho)/d of the largest body")};
  return {"world",
          TableSchema::Form::single,
          "what surrounds the bodies",
          {with_default(required("gravity", "g", "m/s^2", Kind::load, {}, "acceleration of gravity"), Value(zero)),
           table("domain", "box that bodies must not leave", std::move(domain))}};
}

TableSchema material_table_schema() {
  const Range poisson{-1.0, 0.5, true, false};
  Field youngs_modulus = optional("youngs_modulus", "E", "Pa", Kind::number, positive, "Young's modulus; inf is rigid");
  youngs_modulus.may_be_infinite = true;
  return {"material",
          TableSchema::Form::named,
          "density and elastic constants",
          {optional("density", "rho", "kg/m^3", Kind::number, positive, "density"), youngs_modulus,
           optional("poissons_ratio", "nu", "", Kind::number, poisson, "Poisson's ratio"),
           optional("shear_modulus", "G", "Pa", Kind::number, positive, "shear modulus in place of Young's modulus")}};
}

void add_contact_tables(std::vector<TableSchema>& all, const Registry& registry) {
  const std::vector<Field> methods{word("method", "mechanics of contact", {"smooth", "nonsmooth"})};
  const std::vector<Field> parts{tables("smooth", "law of smooth contact"),
                                 tables("nonsmooth", "solver of non-smooth contact"),
                                 tables("wheel_rail", "laws of wheels that roll on rails, with smooth contact"),
                                 tables("pair", "values that differ for one pair of materials")};
  all.push_back(
      {"contact", TableSchema::Form::single, "how bodies act on each other", methods + pair_values() + parts});
  Field tangential =
      word("tangential", "law of friction; default: that of the normal law", names_of(registry.tangential_laws));
  Field rolling = word("rolling", "law of rolling friction; default: spring", names_of(registry.rolling_laws));
  tangential.optional = rolling.optional = true;
  Field locate = required("locate_edges", "", "", Kind::boolean, {},
                          "weights the first and last sample of a contact by the part of the time step that it covers");
  locate.default_value = Value(false);
  const Field law = choice("law", "law of the normal force", names_of(registry.normal_laws), "hertz-mindlin");
  all.push_back({"contact.smooth", TableSchema::Form::single, "law of smooth contact with its parameters",
                 std::vector<Field>{law, tangential, rolling, locate} + smooth_fields(registry)});
  all.push_back(
      {"contact.nonsmooth", TableSchema::Form::single, "solver of non-smooth contact with its parameters",
       std::vector<Field>{choice("solver", "solver of the contact problem", names_of(registry.solvers), "adaptive")} +
           as_optional(united_fields(registry.solvers))});
  all.push_back({"contact.wheel_rail", TableSchema::Form::single,
                 "normal and tangential model of wheels on rails, with smooth contact", registry.rolling_fields});
  Field between = required("between", "", "", Kind::texts, {2, 2}, "the two materials");
  all.push_back({"contact.pair", TableSchema::Form::list, "values that differ for one pair of materials",
                 std::vector<Field>{between} + pair_values() + smooth_fields(registry)});
}

TableSchema detection_table(const Registry& registry) {
  std::vector<std::string> names = names_of(registry.broad_phases);
  if (std::find(names.begin(), names.end(), "auto") == names.end()) names.insert(names.begin(), "auto");
  return {"detection", TableSchema::Form::single, "how contacts are found",
          std::vector<Field>{choice("broad_phase", "how pairs are found", std::move(names), "auto")} +
              as_optional(united_fields(registry.broad_phases))};
}

TableSchema shape_table(const Registry& registry) {
  std::vector<Field> fields;
  for (const auto& shape : registry.shapes) fields.push_back(table(shape.name, shape.summary, authoring_fields(shape)));
  fields.push_back(optional("scale_to_diameter", "d", "m", Kind::number, positive,
                            "scales the shape to this diameter of its bounding sphere"));
  fields.push_back(
      with_default(required("rounding", "", "m", Kind::number, not_negative, "radius of a sphere swept over the shape"),
                   Value(0.0)));
  return {"shape", TableSchema::Form::named, "a shape that bodies share: exactly one form", std::move(fields)};
}

std::vector<Field> servo_fields() {
  return {
      optional("force", "F", "N", Kind::number, positive, "force of the wall, or stress and area"),
      optional("stress", "", "Pa", Kind::number, positive, "stress in place of the force, with area"),
      optional("area", "", "m^2", Kind::number, positive, "area that the stress acts on"),
      optional("direction", "", "", Kind::vec3, {}, "direction of the force, any length; default: gravity"),
      optional("mass", "m", "kg", Kind::number, positive,
               "inertia of the wall; default: that of the body; not with gains"),
      optional(
          "gains", "", "", Kind::numbers, {},
          "proportional [m/(N s)] and integral [m/(N s^2)] of a PI controller, which carries the force while it moves"),
      optional("max_speed", "v", "m/s", Kind::number, positive,
               "speed without resistance; default: sqrt(F d/m), d the diameter of the smallest free body")};
}

std::vector<Field> motion_fields() {
  std::vector<Field> rotation{
      required("axis", "", "", Kind::vec3, {}, "axis, any length"),
      required("rate", "omega", "rad/s", Kind::number, {}, "angular velocity about the axis"),
      optional("about", "", "m", Kind::vec3, {}, "a point of the axis; default: the body's centre")};
  Field of = word("of", "quantity of the table", {"displacement", "velocity", "acceleration"});
  of.optional = true;
  std::vector<Field> oscillation{required("direction", "", "", Kind::vec3, {}, "direction, any length"),
                                 required("amplitude", "a", "m", Kind::number, {}, "amplitude a of a sin(2 pi f t)"),
                                 required("frequency", "f", "Hz", Kind::number, not_negative, "frequency f")};
  return std::vector<Field>{
             with_default(required("velocity", "v", "m/s", Kind::vec3, {}, "constant velocity"), Value(zero)),
             with_default(required("from", "", "s", Kind::number, not_negative, "start time"), Value(0.0)),
             optional("until", "", "s", Kind::number, positive, "end time; default: the end of the run"),
             table("rotation", "rotation about an axis", std::move(rotation)),
             table("oscillation", "oscillation along a line", std::move(oscillation)),
             table("servo", "servo wall with a given force", servo_fields()),
             of,
             with_default(word("baseline",
                               "drift that is removed, so that the path ends at its start and at rest; quadratic: its "
                               "mean displacement is also 0",
                               {"none", "linear", "quadratic"}),
                          Value(std::string("none"))),
             with_default(
                 required("repeats", "", "", Kind::number, {1, largest_integer}, "number of repetitions of the table"),
                 Value(1.0))} +
         time_table_fields();
}

Field repeat_field(const char* help) { return optional("repeat", "", "", Kind::integers, whole_positive, help); }

Field place_field() {
  return with_default(word("place",
                           "what position refers to: the centre of mass, or the origin of its file or corners; fixed "
                           "meshes and planes are always as-drawn",
                           {"centre", "as-drawn"}),
                      Value(std::string("centre")));
}

Field motion_field() {
  Field field = table("motion", "prescribed motion of a driven body, or several at once in a list", motion_fields());
  field.kind = Kind::motions;
  return field;
}

Field group_field() {
  return optional("group", "", "", Kind::text, {}, "name of a group of bodies that it belongs to");
}

TableSchema body_table() {
  return {
      "body",
      TableSchema::Form::list,
      "a body, or several with `repeat`",
      {optional("name", "", "", Kind::text, {}, "name; repeated bodies are NAME[0], NAME[1] ..."),
       repeat_field("number of copies n (index i) or [l, m, n] (indices i, j, k)"),
       required("shape", "", "", Kind::shape, {}, "a name under [shape.*] or a shape written in place"),
       text("material", "a name under [material.*]"),
       with_default(required("fixed", "", "", Kind::boolean, {}, "never moves"), Value(false)),
       with_default(required("continuous", "", "", Kind::boolean, {},
                             "cannot pass through other bodies within a step; non-smooth contact only"),
                    Value(false)),
       with_default(required("on_rails", "", "", Kind::boolean, {},
                             "a wheelset starts on the rails under its load: height and roll are found, the rest of "
                             "position and orientation is as written"),
                    Value(false)),
       with_default(required("position", "x", "m", Kind::vec3, {}, "position of the point that `place` names"),
                    Value(zero)),
       place_field(), optional("orientation", "q", "", Kind::quaternion, {}, "unit quaternion w x y z"),
       optional("euler_deg", "", "", Kind::vec3, {},
                "roll, pitch, yaw in degrees: about x, then y, then z of the world"),
       with_default(required("velocity", "v", "m/s", Kind::vec3, {}, "velocity"), Value(zero)),
       with_default(required("angular_velocity", "omega", "rad/s", Kind::vec3, {}, "angular velocity in world axes"),
                    Value(zero)),
       with_default(required("force", "F", "N", Kind::load, {}, "external force"), Value(zero)),
       with_default(required("torque", "M", "N m", Kind::load, {}, "external torque in world axes"), Value(zero)),
       motion_field(), group_field(),
       optional("remove_at", "", "s", Kind::number, not_negative, "time at which the body is removed")}};
}

TableSchema bodies_table() {
  return {
      "bodies",
      TableSchema::Form::list,
      "bodies from a file: a table with columns x,y,z[,vx,vy,vz][,qw,qx,qy,qz][,wx,wy,wz] and radius, diameter or "
      "shape "
      "[,size][,material][,group], as `epafi export --format csv` writes it, between commas, semicolons, tabs or "
      "blanks; "
      "names of others with their units (`Radius[m]`, `PosX[mm]`); three columns without names are x y z; a text "
      "export "
      "of YADE; a dump of LAMMPS or LIGGGHTS (last frame)",
      {text("file", "table (.csv, .txt, .dat, .tsv, .xyz), dump (.dump, .lammpstrj, .liggghts), .polyset or .h5"),
       group_field(),
       optional(
           "columns", "", "", Kind::texts, {},
           "names of the table's columns in their order, with units where not SI, as \"x[mm]\"; \"-\" passes one over"),
       optional("name", "", "", Kind::text, {}, "name; the bodies are NAME[0], NAME[1] ..."),
       optional("material", "", "", Kind::text, {}, "a name under [material.*] for rows that name none"),
       optional("shape", "", "", Kind::shape, {}, "shape of rows that name none"), place_field(),
       with_default(required("jitter", "", "m", Kind::number, not_negative,
                             "largest random displacement along every axis (run.seed)"),
                    Value(0.0)),
       with_default(required("fixed", "", "", Kind::boolean, {}, "never move"), Value(false))}};
}

TableSchema fill_table() {
  const std::vector<Field> size{
      word("distribution", "how sizes are distributed", {"uniform", "normal", "lognormal", "table"}),
      optional("min", "", "", Kind::number, positive, "smallest factor; default: 3 deviations below"),
      optional("max", "", "", Kind::number, positive, "largest factor; default: 3 deviations above"),
      optional("mean", "", "", Kind::number, positive, "mean of normal and lognormal; default: 1"),
      optional("deviation", "", "", Kind::number, positive, "standard deviation of normal and lognormal"),
      optional("values", "", "", Kind::numbers, positive, "table: factors"),
      optional("shares", "", "", Kind::numbers, positive, "table: relative frequency of each factor"),
      with_default(word("by", "shares of the number of bodies or of their mass", {"number", "mass"}),
                   Value(std::string("number")))};
  Field full = word("until", "fills the region", {"full"});
  full.optional = true;
  return {
      "fill",
      TableSchema::Form::list,
      "many bodies placed in a region; exactly one of count, mass, until",
      {optional("name", "", "", Kind::text, {}, "name; the bodies are NAME[0], NAME[1] ..."),
       required("shape", "", "", Kind::texts, {1, infinity}, "names under [shape.*]"),
       optional("weights", "", "", Kind::numbers, positive, "relative number of bodies of each shape"), group_field(),
       table("size", "factor of the shape's size", size), text("material", "a name under [material.*]"),
       optional("count", "n", "", Kind::integer, whole_positive, "number of bodies"),
       optional("mass", "m", "kg", Kind::number, positive, "mass of all bodies"), full,
       needed(table("region", "where the bodies are placed", region_box())),
       with_default(word("method", "how the bodies are placed", {"lattice", "random", "pour"}),
                    Value(std::string("lattice"))),
       optional("rate", "", "1/s", Kind::number, positive, "pour: bodies per second"),
       optional("mass_rate", "", "kg/s", Kind::number, positive, "pour: mass per second"),
       with_default(required("from", "", "s", Kind::number, not_negative, "pour: start time"), Value(0.0)),
       optional("seed", "", "", Kind::integer, seeds, "seed; default: that of [run]"),
       with_default(required("velocity", "v", "m/s", Kind::vec3, {}, "velocity of all bodies"), Value(zero)),
       with_default(required("velocity_deviation", "", "m/s", Kind::number, not_negative,
                             "standard deviation of each component of random velocities, with no total momentum"),
                    Value(0.0))}};
}

TableSchema outlet_table() {
  return {"outlet",
          TableSchema::Form::list,
          "removes and counts bodies whose centres enter a region",
          {optional("name", "", "", Kind::text, {}, "name; default: outlet"),
           needed(table("region", "where bodies are removed", region_box()))}};
}

TableSchema spring_table() {
  const auto vector = [](const char* name, const char* symbol, const char* unit, Range range, const char* help) {
    return with_default(required(name, symbol, unit, Kind::vec3, range, help), Value(zero));
  };
  return {"spring",
          TableSchema::Form::list,
          "spring and dashpot between two bodies, or a body and a frame that moves along the track (or along x)",
          {optional("name", "", "", Kind::text, {}, "name"),
           repeat_field("number of copies n (index i) or [l, m, n]; a body's name may be \"ball[i + 1]\""),
           text("body", "body at one end"),
           optional("to", "", "", Kind::text, {}, "body at the far end; default: a moving frame"),
           optional("speed", "V", "m/s", Kind::number, any_number, "speed of the frame along the track; default: 0"),
           vector("attachment", "", "m", any_number, "point of the body, in its axes"),
           vector("stiffness", "k", "N/m", not_negative, "along the axes of the far end"),
           vector("damping", "c", "N s/m", not_negative, "along the axes of the far end"),
           vector("preload", "F", "N", any_number, "force on the body at the start")}};
}

TableSchema measure_table(const Registry& registry) {
  return {
      "measure", TableSchema::Form::list, "a quantity written to measures.csv",
      std::vector<Field>{
          optional("name", "", "", Kind::text, {}, "name; default: the kind"),
          repeat_field("number of copies n (index i) or [l, m, n]; a body's name may be \"ball[i]\""),
          word("kind", "what is measured", names_of(registry.measures)),
          optional("interval", "", "s", Kind::number, not_negative,
                   "time between values; 0: every step; default: every step is evaluated, at most 10 000 are written"),
          optional("group", "", "", Kind::text, {}, "name of a group of bodies, in place of body")} +
          as_optional(united_fields(registry.measures))};
}

TableSchema view_table() {
  Field camera = table(
      "camera", "viewpoint: one of these words, or a table",
      {required("from", "", "m", Kind::vec3, {}, "position of the camera"),
       optional("to", "", "m", Kind::vec3, {}, "point that the camera looks at; default: the middle"),
       optional("up", "", "", Kind::vec3, {}, "upward direction of the picture; default: against gravity"),
       with_default(required("angle_deg", "", "deg", Kind::number, {1, 170}, "vertical angle of view"), Value(30.0))});
  for (const auto& [name, direction] : camera_presets()) camera.choices.push_back(name);
  Field field = word("field", "quantity that colours the bodies", view_field_names());
  field.optional = true;
  return {"view",
          TableSchema::Form::single,
          "camera and colours of `epafi view`, `render` and `report`",
          {camera, field,
           optional("range", "", "", Kind::numbers, {}, "smallest and largest value of the colours, in SI")}};
}

}  // namespace

const TableSchema& SceneSchema::at(const std::string& name) const {
  const auto found = std::find_if(tables.begin(), tables.end(), [&](const TableSchema& t) { return t.name == name; });
  EPAFI_REQUIRE(found != tables.end(), "a table of the schema");
  return *found;
}

SceneSchema make_schema(const Registry& registry) {
  using Form = TableSchema::Form;
  SceneSchema schema;
  auto& all = schema.tables;
  all.push_back(
      {"params", Form::free, "names for \"= expression\": numbers, with a unit or as expressions of each other", {}});
  all.push_back(run_table(registry));
  all.push_back(stage_table());
  all.push_back(start_table());
  all.push_back(world_table());
  all.push_back(material_table_schema());
  add_contact_tables(all, registry);
  all.push_back(detection_table(registry));
  all.push_back(shape_table(registry));
  all.push_back(body_table());
  all.push_back(bodies_table());
  all.push_back(fill_table());
  all.push_back(outlet_table());
  all.push_back(spring_table());
  all.push_back(measure_table(registry));
  all.push_back(
      {"bounds", Form::single, "watched during the run; a violation ends it with exit code 1", bound_fields(true)});
  all.push_back(bounds_measure_table());
  all.push_back({"accuracy", Form::single, "accuracy that this scene needs", bound_fields(false)});
  all.push_back({"sweep", Form::free, "key paths and lists of values for `epafi sweep`", {}});
  all.push_back(
      {"benchmark",
       Form::single,
       "the scene is also a benchmark",
       {tables("sizes", "key paths and lists of values"), text("error", "error that is printed beside the time")}});
  all.push_back({"benchmark.sizes", Form::free, "key paths and lists of values", {}});
  all.push_back(
      {"output",
       Form::single,
       "additional output",
       {table("problems", "contact problems for `epafi solve`",
              {required("every", "", "s", Kind::number, positive, "time between problems")}),
        with_default(required("orientation", "", "", Kind::boolean, {}, "also writes orientations of spheres"),
                     Value(false))}});
  all.push_back(view_table());
  return schema;
}

std::vector<Field> operator+(std::vector<Field> a, const std::vector<Field>& b) {
  for (const auto& field : b)
    if (std::none_of(a.begin(), a.end(), [&](const Field& f) { return f.name == field.name; })) a.push_back(field);
  return a;
}

std::vector<Field> time_table_fields() {
  Field rows = optional("table", "", "", Kind::rows, {}, "rows [t, x, y, z]; times rise");
  return {rows, optional("file", "", "", Kind::text, {}, "CSV file with a header: t,x,y,z or what `columns` names"),
          optional("columns", "", "", Kind::texts, {1, 4}, "names of the columns of t and of x, y, z"),
          optional("unit", "", "", Kind::text, {}, "of the values: m, mm, m/s, m/s^2, g (9.80665 m/s^2) ..."),
          with_default(required("scale", "", "", Kind::number, {}, "factor of all values"), Value(1.0))};
}

std::vector<Field> as_optional(std::vector<Field> fields) {
  for (auto& field : fields) field.optional = true;  // whether a chosen entry needs it is checked with that entry
  return fields;
}

std::vector<Field> pair_values() {
  return {optional("restitution", "e", "", Kind::number, unit_interval, "coefficient of restitution"),
          optional("friction", "mu", "", Kind::number, {0.0, 10.0}, "coefficient"),
          optional("rolling_friction", "mu_r", "", Kind::number, {0.0, 10.0}, "coefficient")};
}

std::vector<Field> smooth_fields(const Registry& registry, const LawChoice& chosen) {
  return as_optional(united_fields(registry.normal_laws, chosen.law) +
                     united_fields(registry.tangential_laws, chosen.tangential) +
                     united_fields(registry.rolling_laws, chosen.rolling));
}

std::vector<Field> united_fields(const std::vector<Entry>& entries, const std::string& chosen) {
  std::vector<Field> all;
  if (const Entry* entry = find_entry(entries, chosen)) all = entry->fields;
  for (const auto& entry : entries) all = all + entry.fields;
  return all;
}

std::vector<Field> authoring_fields(const Entry& shape) {
  const Field unit =
      with_default(text("unit", "of the numbers in the file: m, mm, cm, um, in"), Value(std::string("m")));
  if (shape.name == "mesh")
    return {text("file", "surface as STL, OBJ or PLY"), unit,
            choice("tree", "bounding boxes of its triangles; obb suits thin oblique parts", {"aabb", "obb"}, "aabb")};
  if (shape.name == "solid") return {text("file", "closed surface as STL, OBJ or PLY"), unit};
  if (shape.name != "polyhedron") return shape.fields;
  Field file = text("file", "corners from OBJ, STL or PLY; their hull is taken");
  file.optional = true;
  const Range corners{4, 1000};
  return {file, unit, optional("vertices", "", "m", Kind::vectors, {}, "corners; their hull is taken"),
          table("random", "random corners on a sphere",
                {required("vertices", "", "", Kind::integer, corners, "number of corners"),
                 with_default(required("seed", "", "", Kind::integer, seeds, "seed"), Value(1.0))})};
}

std::vector<std::string> names_of(const std::vector<Entry>& entries) {
  std::vector<std::string> names;
  for (const auto& entry : entries) names.push_back(entry.name);
  return names;
}

const Entry* find_entry(const std::vector<Entry>& entries, const std::string& name) {
  for (const auto& entry : entries)
    if (entry.name == name) return &entry;
  return nullptr;
}

}  // namespace epafi
