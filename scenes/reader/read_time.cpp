/// @file read_time.cpp  Values that follow time: motions of driven bodies, gravity, forces and torques; tables of
/// either in the scene or in a CSV file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "engine/units/nearest.h"
#include "engine/units/units.h"
#include "scenes/reader/parts.h"
#include "scenes/reader/text_cells.h"

namespace epafi {
namespace {

const std::vector<std::string> row_axes{"t", "x", "y", "z"};
constexpr double standard_gravity = 9.80665;  // [m/s^2]: accelerograms come in g

/// Index of the columns t, x, y, z in a row; none where a column is missing.
using Columns4 = std::array<std::optional<std::size_t>, 4>;

/// Names of the columns to read; empty where the scene gives none.
std::vector<std::string> wanted_columns(const TableValues& v, const std::string& prefix) {
  return v.has(prefix + "columns") ? v.texts(prefix + "columns") : std::vector<std::string>{};
}

/// Index in t, x, y, z of each name; by position where some name is none of these.
std::vector<std::size_t> axes_of(const std::vector<std::string>& names) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto at = std::find(row_axes.begin(), row_axes.end(), names[k]);
    if (at == row_axes.end()) {
      out.clear();
      for (std::size_t j = 0; j < names.size(); ++j) out.push_back(std::min<std::size_t>(j, 3));
      return out;
    }
    out.push_back(static_cast<std::size_t>(at - row_axes.begin()));
  }
  return out;
}

struct RowReader {
  Reading& reading;
  std::string label;
  MotionTable::Rows rows{};

  void add(const std::array<double, 4>& row, const Place& place) {
    if (!rows.time.empty() && !(row[0] > rows.time.back()))
      return reading.error(place, label + fmt::format(": time {} s does not come after {} s of the row before",
                                                      format_number(row[0]), format_number(rows.time.back())));
    rows.time.push_back(row[0]);
    rows.value.emplace_back(row[1], row[2], row[3]);
  }
};

/// Rows written in the scene.
void read_written_rows(RowReader& out, const Node& table, const std::vector<std::string>& columns) {
  if (table.type != Node::Type::array)
    return out.reading.error(table.place,
                             out.label + " table: expected a list of [t, x, y, z], found " + type_name(table.type));
  const std::size_t width = columns.empty() ? 4 : columns.size();
  const auto axis = axes_of(columns.empty() ? row_axes : columns);
  const std::size_t first = table.items.empty() ? 0 : table.items.front().items.size();
  for (const Node& item : table.items) {
    const bool fits = item.type == Node::Type::array &&
                      (columns.empty() ? item.items.size() >= 2 && item.items.size() <= 4 : item.items.size() == width);
    if (!fits)
      return out.reading.error(item.place, out.label + fmt::format(" table: expected rows of {} numbers",
                                                                   columns.empty() ? "2 to 4" : std::to_string(width)));
    if (item.items.size() != first)
      return out.reading.error(item.place, out.label + fmt::format(" table: this row has {} numbers, the first has {}",
                                                                   item.items.size(), first));
    std::array<double, 4> row{};
    const std::size_t errors = out.reading.errors();
    for (std::size_t k = 0; k < item.items.size(); ++k)
      row[axis[k]] = out.reading.number(item.items[k], std::string(any_unit), out.label + " table").value_or(0.0);
    if (out.reading.errors() != errors) return;
    out.add(row, item.place);
    if (out.reading.errors() != errors) return;
  }
}

/// Finds the columns by the header; t is required, unless columns are chosen by name.
std::optional<Columns4> find_columns(RowReader& out, const std::vector<TextCell>& cells,
                                     const std::vector<std::string>& columns, const Place& place) {
  std::vector<std::string> header;
  for (const TextCell& cell : cells) header.push_back(cell.text);
  Columns4 at;
  const auto& names = columns.empty() ? row_axes : columns;
  const auto axis = axes_of(names);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto found = std::find(header.begin(), header.end(), names[k]);
    if (std::count(header.begin(), header.end(), names[k]) > 1) {
      out.reading.error(place, out.label + ": the file has two columns '" + names[k] + "'");
      return std::nullopt;
    }
    if (found != header.end()) {
      at[axis[k]] = static_cast<std::size_t>(found - header.begin());
    } else if (!columns.empty() || k == 0) {
      out.reading.error(place, out.label + ": there is no column '" + names[k] + "'" +
                                   suggestion(names[k], header, "columns of the file"));
      return std::nullopt;
    }
  }
  if (at[1] || at[2] || at[3]) return at;
  out.reading.error(place, out.label + ": the file has none of the columns x, y, z; name them with columns = [...]");
  return std::nullopt;
}

void read_file_rows(RowReader& out, const std::string& path, const Place& from,
                    const std::vector<std::string>& columns) {
  std::ifstream in(path);
  out.reading.files.push_back(path);
  if (!in) return out.reading.error(from, out.label + ": the file '" + path + "' does not exist or cannot be read");
  std::optional<Columns4> at;
  std::size_t width = 0;
  std::string line;
  for (int number = 0; next_text_line(in, line, number);) {
    if (line.find_first_not_of(" \t") == std::string::npos || line[0] == '#') continue;
    const auto cells = cells_of_line(line);
    const Place place{path, number, 1};
    if (!at) {
      at = find_columns(out, cells, columns, place);
      if (!at) return;
      width = cells.size();
      continue;
    }
    if (cells.size() > width)
      return out.reading.error(
          place, out.label + fmt::format(": expected {} columns, found {} (numbers have a decimal point, no comma)",
                                         width, cells.size()));
    std::array<double, 4> row{};
    for (std::size_t k = 0; k < 4; ++k) {
      if (!(*at)[k]) continue;
      const std::string cell = *(*at)[k] < cells.size() ? cells[*(*at)[k]].text : "";
      const auto read = read_number(cell);
      if (cell.empty())
        return out.reading.error(place, out.label + ": the row has no value in column '" + row_axes[k] + "'");
      if (!read)
        return out.reading.error(
            place, out.label + ": expected a finite number in column '" + row_axes[k] + "', found '" + cell + "'");
      row[k] = *read;
    }
    const std::size_t errors = out.reading.errors();
    out.add(row, place);
    if (out.reading.errors() != errors) return;
  }
}

/// Factor to SI of the unit of the rows.
std::optional<double> unit_factor(Reading& reading, const TableValues& v, const std::string& prefix,
                                  const std::string& unit, const std::string& label) {
  if (!v.has(prefix + "unit")) return 1.0;
  const std::string& written = v.text(prefix + "unit");
  if (written == "g" && unit == "m/s^2") return standard_gravity;
  const auto read = read_quantity("1 " + written, unit);
  if (read.value) return read.value;
  reading.error(v.place_of(prefix + "unit"), label + " unit: " + read.problem);
  return std::nullopt;
}

}  // namespace

std::optional<MotionTable::Rows> read_time_rows(Reading& reading, const Node& item, const TableValues& v,
                                                const std::string& unit, const std::string& label) {
  const std::size_t errors = reading.errors();
  const Node *table = item.find("table"), *file = item.find("file");
  if ((table != nullptr) == (file != nullptr)) {
    reading.error(item.place, label + ": write table = [[t, x, y, z], ...] or file = \"....csv\"");
    return std::nullopt;
  }
  RowReader out{reading, label};
  const auto columns = wanted_columns(v, "");
  if (columns.size() == 1 || columns.size() > 4)
    reading.error(v.place_of("columns"), label + " columns: expected the names of t and of x, y, z");
  const auto factor = unit_factor(reading, v, "", unit, label);
  if (reading.errors() != errors) return std::nullopt;
  if (table)
    read_written_rows(out, *table, columns);
  else if (v.has("file"))
    read_file_rows(out, resolve_path(v.text("file"), v.place_of("file"), reading.main_file), v.place_of("file"),
                   columns);
  if (reading.errors() != errors) return std::nullopt;
  if (out.rows.time.size() < 2) {
    reading.error(item.place, label + ": a table needs two rows at least");
    return std::nullopt;
  }
  double longest = 0.0;
  std::vector<double> lengths;
  for (std::size_t k = 0; k + 1 < out.rows.time.size(); ++k) lengths.push_back(out.rows.time[k + 1] - out.rows.time[k]);
  longest = *std::max_element(lengths.begin(), lengths.end());
  std::nth_element(lengths.begin(), lengths.begin() + std::ssize(lengths) / 2, lengths.end());
  constexpr double most = 10.0;  // records are even; written tables of few rows need not be
  if (file && lengths.size() >= 10 && longest > most * lengths[lengths.size() / 2])
    reading.warning(v.place_of("file"),
                    label + fmt::format(": rows are {:.4g} s apart, but {:.4g} s at a gap; it is bridged by a line",
                                        lengths[lengths.size() / 2], longest));
  const double scale = *factor * v.number_or("scale", 1.0);
  for (Vec3& x : out.rows.value) x *= scale;
  return out.rows;
}

namespace {

std::shared_ptr<const MotionTable> read_motion_table(Reading& reading, const Node& node, const TableValues& v,
                                                     const std::string& label) {
  for (const char* key : {"of", "columns", "unit", "scale", "baseline", "repeats"})
    if (v.written(key) && !v.written("table") && !v.written("file"))
      reading.error(v.place_of(key), label + " " + key + " goes with table or file");
  if (!v.written("table") && !v.written("file")) return nullptr;
  if (!v.has("of")) {
    reading.error(node.place,
                  label + ": say what the table is of: of = \"displacement\", \"velocity\" or \"acceleration\"");
    return nullptr;
  }
  const std::string& of = v.text("of");
  const bool x = of == "displacement", speed = of == "velocity";
  auto rows = read_time_rows(reading, node, v, x ? "m" : speed ? "m/s" : "m/s^2", label);
  if (!rows) return nullptr;
  if (rows->time.front() < 0.0) {
    reading.error(node.place, label + ": the table begins at " + format_number(rows->time.front()) +
                                  " s; times count from the beginning of the motion, the first is 0 or later");
    return nullptr;
  }
  const std::string baseline = v.has("baseline") ? v.text("baseline") : "none";
  const auto kind = x       ? MotionTable::Of::displacement
                    : speed ? MotionTable::Of::velocity
                            : MotionTable::Of::acceleration;
  const auto correction = baseline == "linear"      ? MotionTable::Baseline::linear
                          : baseline == "quadratic" ? MotionTable::Baseline::quadratic
                                                    : MotionTable::Baseline::none;
  double fastest = 0.0;
  auto table = std::make_shared<const MotionTable>(std::move(*rows), kind, correction, v.number_or("repeats", 1.0));
  for (double t = table->begin(); t < table->end(); t += (table->end() - table->begin()) / 1000)
    fastest = std::max(fastest, table->velocity(t).norm());
  if (const double last = table->last_velocity().norm(); last > std::max(1e-3 * fastest, 1e-12))
    reading.warning(node.place,
                    label + fmt::format(": the table ends at {:.3g} m/s, where the body stops; add rows, or "
                                        "take the drift out with baseline = \"linear\"",
                                        last));
  return table;
}

std::optional<Servo> read_servo_of(Reading& reading, const TableValues& v, const std::string& label) {
  const Place place = v.place_of("servo");
  const bool force = v.has("servo.force"), stress = v.has("servo.stress");
  if (force == stress || stress != v.has("servo.area"))
    reading.error(place, label + " motion servo: write force, or stress with area");
  Servo servo;
  if (v.written("servo.gains") && v.written("servo.mass"))
    reading.error(
        v.place_of("servo.mass"),
        label + " motion servo: a wall with gains has no mass; write mass or gains = [proportional, integral]");
  if (v.has("servo.gains")) {
    const auto& gains = v.numbers("servo.gains");
    if (gains.size() != 2 || gains[0] < 0.0 || gains[1] < 0.0 || gains[0] + gains[1] <= 0.0)
      reading.error(v.place_of("servo.gains"),
                    label + " motion servo gains: expected [proportional, integral], not negative");
    else {
      servo.proportional = gains[0];
      servo.integral = gains[1];
    }
  }
  servo.force = force ? v.number("servo.force") : v.number_or("servo.stress", 0.0) * v.number_or("servo.area", 0.0);
  servo.mass = v.number_or("servo.mass", servo.has_gains() ? 1.0 : 0.0);
  servo.max_speed = v.number_or("servo.max_speed", 0.0);
  servo.from = v.number_or("from", 0.0);
  servo.until = v.number_or("until", infinity);
  servo.direction = Vec3::Zero();
  if (v.has("servo.direction")) {
    const auto unit = unit_vector(reading, v.vec3("servo.direction"), v.place_of("servo.direction"),
                                  label + " motion servo direction");
    if (unit) servo.direction = *unit;
  }
  return servo;
}

void read_motion(Reading& reading, const Node& node, const std::string& label, MotionsRead& out) {
  const std::string own = label + " motion";
  const Field& field = *std::ranges::find(reading.schema.at("body").fields, "motion", &Field::name);
  const TableValues v = read_table(node, own, field.fields, reading);
  if (v.number_or("until", infinity) <= v.number_or("from", 0.0))
    reading.error(v.place_of("until"), own + ": until must be later than from");
  if (v.written("servo")) {
    if (out.servo) reading.error(v.place_of("servo"), own + ": a body has one servo");
    out.servo = read_servo_of(reading, v, label);
  }
  const bool moves = v.written("velocity") || v.written("rotation") || v.written("oscillation") || v.written("table") ||
                     v.written("file");
  if (v.written("servo") && !moves) return;
  Motion motion;
  if (v.has("velocity")) motion.velocity = v.vec3("velocity");
  motion.from = v.number_or("from", 0.0);
  motion.until = v.number_or("until", infinity);
  const auto direction = [&](const std::string& key, Vec3& to) {
    if (!v.has(key)) return;
    if (const auto unit = unit_vector(reading, v.vec3(key), v.place_of(key), own + "." + key)) to = *unit;
  };
  direction("rotation.axis", motion.rotation_axis);
  motion.rotation_rate = v.number_or("rotation.rate", 0.0);
  if (v.has("rotation.about")) motion.rotation_about = v.vec3("rotation.about");
  direction("oscillation.direction", motion.oscillation_direction);
  motion.oscillation_amplitude = v.number_or("oscillation.amplitude", 0.0);
  motion.oscillation_frequency = v.number_or("oscillation.frequency", 0.0);
  motion.table = read_motion_table(reading, node, v, own);
  out.parts.push_back(std::move(motion));
}

}  // namespace

MotionsRead read_motions(Reading& reading, const Node& node, const std::string& label) {
  MotionsRead out;
  if (node.type == Node::Type::table) {
    read_motion(reading, node, label, out);
  } else if (node.is_array_of_tables() || (node.type == Node::Type::array && node.items.empty())) {
    for (const Node& item : node.items) read_motion(reading, item, label, out);
  } else {
    reading.error(node.place, label + " motion: expected a table or a list of tables, found " + type_name(node.type));
  }
  const bool moves = std::ranges::any_of(out.parts, [](const Motion& m) {
    return !m.velocity.isZero(0.0) || m.rotation_rate != 0.0 || m.oscillation_amplitude != 0.0 || m.table;
  });
  if (out.servo) out.servo->beside_motion = moves;
  return out;
}

bool follows_time(const Reading& reading, const Node& node) {
  if (node.type == Node::Type::table) return true;
  const Node* params = reading.root.find("params");
  if (params && params->find("t")) return false;
  return std::ranges::any_of(node.items, [](const Node& item) {
    return item.type == Node::Type::text && item.text.find('=') != std::string::npos && mentions(item.text, "t");
  });
}

namespace {

/// Linear interpolation between rows; constant before the first and after the last.
TimeVector interpolation(MotionTable::Rows rows) {
  return [rows = std::make_shared<const MotionTable::Rows>(std::move(rows))](double t) -> Vec3 {
    const auto& times = rows->time;
    if (t <= times.front()) return rows->value.front();
    if (t >= times.back()) return rows->value.back();
    const auto k = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), t) - times.begin());
    const double share = (t - times[k - 1]) / (times[k] - times[k - 1]);
    return rows->value[k - 1] + share * (rows->value[k] - rows->value[k - 1]);
  };
}

}  // namespace

TimedVector read_time_vector(Reading& reading, const Node& node, const std::string& unit, const std::string& label) {
  TimedVector out;
  if (node.type == Node::Type::table) {
    Field table, file, columns, of_unit, scale;
    table.name = "table";
    table.kind = Kind::rows;
    file.name = "file";
    file.kind = Kind::text;
    columns.name = "columns";
    columns.kind = Kind::texts;
    of_unit.name = "unit";
    of_unit.kind = Kind::text;
    scale.name = "scale";
    scale.default_value = Value(1.0);
    const auto v = read_table(node, label, as_optional({table, file, columns, of_unit, scale}), reading);
    if (auto rows = read_time_rows(reading, node, v, unit, label)) out.loose = interpolation(std::move(*rows));
    return out;
  }
  std::array<std::function<double(double)>, 3> part{};
  for (std::size_t k = 0; k < 3 && k < node.items.size(); ++k) {
    const Node& item = node.items[k];
    const bool timed =
        item.type == Node::Type::text && mentions(item.text, "t") && item.text.find('=') != item.text.npos;
    if (timed)
      part[k] = reading.time_expression(item, label);
    else
      out.steady[static_cast<int>(k)] = reading.number(item, unit, label).value_or(0.0);
  }
  out.loose = [part](double t) {
    Vec3 v = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      if (part[k]) v[static_cast<int>(k)] = part[k](t);
    return v;
  };
  return out;
}

void read_body_loads(Reading& reading, const Node& item, const TableValues& v, const std::string& label, Since since,
                     BodySpec& body) {
  TimedLoad load;
  load.since = since;
  if (const Node* force = item.find("force"); force && follows_time(reading, *force)) {
    const TimedVector read = read_time_vector(reading, *force, "N", label + " force");
    load.force = read.loose;
    body.force = read.steady;
  } else if (v.has("force") && v.vec3("force").squaredNorm() > 0) {
    body.force = v.vec3("force");
  }
  if (const Node* torque = item.find("torque"); torque && follows_time(reading, *torque)) {
    const TimedVector read = read_time_vector(reading, *torque, "N m", label + " torque");
    load.torque = [=](double t) { return Vec3(read.steady + read.loose(t)); };
  } else if (v.has("torque") && v.vec3("torque").squaredNorm() > 0) {
    load.torque = [torque = v.vec3("torque")](double) { return torque; };
  }
  if (load.force || load.torque) body.load = load;
}

}  // namespace epafi
