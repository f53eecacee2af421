/// @file read_body_files.cpp  [[bodies]]: one body per row of a CSV file with a header line.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "engine/nearest.h"
#include "scenes/reader/parts.h"

namespace epafi {
namespace {

const std::vector<std::string> number_columns{"x",  "y",  "z",  "vx", "vy", "vz", "qw",
                                              "qx", "qy", "qz", "wx", "wy", "wz", "radius"};
const std::vector<std::string> known_columns{"x",  "y",  "z",  "vx", "vy", "vz",     "qw",    "qx",
                                             "qy", "qz", "wx", "wy", "wz", "radius", "shape", "material"};

struct Cell {
  std::string text;
  Place place;
};

std::vector<Cell> split(const std::string& line, const std::string& file, int number) {
  std::vector<Cell> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::size_t first = begin, last = end;
    while (first < last && (line[first] == ' ' || line[first] == '\t')) ++first;
    while (last > first && (line[last - 1] == ' ' || line[last - 1] == '\t' || line[last - 1] == '\r')) --last;
    cells.push_back({line.substr(first, last - first), {file, number, static_cast<int>(first) + 1}});
    begin = end + 1;
  }
  return cells;
}

/// One file being read.
struct Rows {
  Draft& draft;
  std::string label;
  std::vector<Cell> header;
  std::optional<std::size_t> shape, material;  ///< of rows that name none
  bool fixed = false;
  std::map<std::string, Cell> row;

  bool has(const std::string& column) const { return row.count(column) != 0; }
  bool has_column(const std::string& name) const {
    return std::any_of(header.begin(), header.end(), [&](const Cell& c) { return c.text == name; });
  }
  double number(const std::string& column, double otherwise = 0.0) {
    if (!has(column)) return otherwise;
    const Cell& cell = row.at(column);
    double value = 0.0;
    const char* end = cell.text.data() + cell.text.size();
    const auto read = std::from_chars(cell.text.data(), end, value);
    if (read.ec != std::errc{} || read.ptr != end || !std::isfinite(value)) {
      draft.reading.error(cell.place, "column " + column + ": expected a number, found '" + cell.text + "'");
    }
    return value;
  }
  bool check_header(const Place& place);
  std::optional<BodySpec> body();
  std::optional<std::size_t> shape_of_row();
};

bool Rows::check_header(const Place& place) {
  const std::size_t errors = draft.reading.errors();
  for (std::size_t k = 0; k < header.size(); ++k) {
    const Cell& cell = header[k];
    if (std::find(known_columns.begin(), known_columns.end(), cell.text) == known_columns.end()) {
      draft.reading.error(cell.place,
                          "unknown column '" + cell.text + "'" + suggestion(cell.text, known_columns, "known columns"));
    }
    for (std::size_t j = 0; j < k; ++j)
      if (header[j].text == cell.text) draft.reading.error(cell.place, "the column '" + cell.text + "' is given twice");
  }
  const auto missing = [&](const std::string& column) {
    draft.reading.error(header.empty() ? place : header[0].place, "missing column '" + column + "'");
  };
  for (const char* column : {"x", "y", "z"})
    if (!has_column(column)) missing(column);
  for (const char* group : {"vxvyvz", "wxwywz", "qwqxqyqz"}) {  // all of a vector or nothing
    const std::string names = group;
    bool any = false;
    for (std::size_t k = 0; k < names.size(); k += 2) any = any || has_column(names.substr(k, 2));
    for (std::size_t k = 0; any && k < names.size(); k += 2)
      if (!has_column(names.substr(k, 2))) missing(names.substr(k, 2));
  }
  if (!shape && !has_column("shape") && !has_column("radius")) missing("radius' or 'shape");
  if (!material && !has_column("material")) missing("material");
  if (has_column("shape") && has_column("radius"))
    draft.reading.error(header[0].place, "columns radius and shape are both given; keep one");
  return draft.reading.errors() == errors;
}

std::optional<std::size_t> Rows::shape_of_row() {
  if (has("shape")) return find_shape(draft, row.at("shape").text, row.at("shape").place, label);
  if (!has("radius")) return shape;
  const double radius = number("radius");
  if (!(radius > 0.0)) {
    draft.reading.error(row.at("radius").place,
                        "column radius = " + format_number(radius) + " is outside (0, inf) (radius, in m)");
    return std::nullopt;
  }
  const auto [known, is_new] = draft.sphere_of_radius.try_emplace(radius, draft.scene.shapes.size());
  if (is_new) {
    ShapeSpec sphere;
    sphere.type = "sphere";
    sphere.parameters.set("radius", radius);
    sphere.place = row.at("radius").place;
    draft.scene.shapes.push_back(std::move(sphere));
  }
  return known->second;
}

std::optional<BodySpec> Rows::body() {
  BodySpec body;
  const auto own_shape = shape_of_row();
  const auto own_material =
      has("material") ? find_material(draft, row.at("material").text, row.at("material").place, label) : material;
  body.position = Vec3(number("x"), number("y"), number("z"));
  body.velocity = Vec3(number("vx"), number("vy"), number("vz"));
  body.angular_velocity = Vec3(number("wx"), number("wy"), number("wz"));
  body.spins = {has("wx"), has("wx") ? row.at("wx").place : Place{}};
  body.orientation = Quat(number("qw", 1.0), number("qx"), number("qy"), number("qz"));
  if (!(body.orientation.norm() > 0.0))
    draft.reading.error(row.at("qw").place, "a quaternion of length 0 is no orientation");
  else
    body.orientation.normalize();
  body.fixed = fixed;
  if (!own_shape || !own_material) return std::nullopt;
  body.shape = *own_shape, body.material = *own_material;
  return body;
}

void read_rows(Rows& rows, std::istream& in, const std::string& file, const std::string& name, const Place& place) {
  auto& scene = rows.draft.scene;
  Reading& reading = rows.draft.reading;
  const std::size_t errors = reading.errors();
  std::string line;
  for (int number = 1; std::getline(in, line) && reading.errors() < errors + 20; ++number) {
    if (line.empty() || line[0] == '#' || line == "\r") continue;
    auto cells = split(line, file, number);
    if (rows.header.empty()) {
      rows.header = std::move(cells);
      if (!rows.check_header(place)) return;
      continue;
    }
    if (cells.size() != rows.header.size()) {
      reading.error({file, number, 1}, fmt::format("expected {} columns, found {}", rows.header.size(), cells.size()));
      continue;
    }
    for (std::size_t k = 0; k < cells.size(); ++k) rows.row[rows.header[k].text] = std::move(cells[k]);
    auto body = rows.body();
    if (!body) continue;
    body->group = scene.groups.size() - 1;
    if (!name.empty()) body->name = fmt::format("{}[{}]", name, scene.groups.back().count);
    scene.bodies.push_back(std::move(*body));
    ++scene.groups.back().count;
  }
  if (reading.errors() == errors && scene.groups.back().count == 0)
    reading.error(place, "the file '" + file + "' has no body");
}

void read_file(Draft& draft, const Node& item) {
  Reading& reading = draft.reading;
  const std::string label = item_label("bodies", item);
  const std::size_t errors = reading.errors();
  const TableValues values = read_table(item, label, reading.schema.at("bodies").fields, reading);
  Rows rows{draft, label, {}, {}, {}, values.has("fixed") && values.boolean("fixed"), {}};
  if (const Node* shape = item.find("shape")) rows.shape = read_shape_value(draft, *shape, label);
  if (values.has("material"))
    rows.material = find_material(draft, values.text("material"), values.place_of("material"), label);
  const std::string name = values.has("name") ? values.text("name") : "";
  check_group_name(draft, name, values.place_of("name"));
  if (reading.errors() != errors) return;
  if (!find_entry(reading.registry.shapes, "sphere"))
    return reading.error(item.place, label + ": there is no shape 'sphere'");
  const Place place = values.place_of("file");
  const std::string path = resolve_path(values.text("file"), place, reading.main_file);
  const auto ending = std::filesystem::path(path).extension();
  if (ending != ".csv" && ending != ".polyset")
    return reading.error(place, label + " file: expected a .csv or .polyset file, found '" + path + "'");
  std::error_code failure;
  if (!std::filesystem::is_regular_file(path, failure))
    return reading.error(place, label + " file: there is no file '" + path + "'");
  draft.scene.groups.push_back({name, draft.scene.bodies.size(), 0, item.place});
  if (ending == ".polyset") {
    if (!rows.material) return reading.error(item.place, label + ": a .polyset needs a material");
    return read_polyset(draft, {path, name, *rows.material, rows.fixed});
  }
  std::ifstream in(path);
  read_rows(rows, in, path, name, place);
}

}  // namespace

void read_body_files(Draft& draft) {
  each_item(draft.reading, "bodies", [&](const Node& item) { read_file(draft, item); });
}

}  // namespace epafi
