/// @file read_body_files.cpp  [[bodies]]: one body per row of a table (row_file.h).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/units/random.h"
#include "scenes/reader/parts.h"
#include "scenes/reader/row_file.h"
#include "scenes/reader/text_cells.h"
#include "scenes/reader/toml_text.h"

namespace epafi {
namespace {

using Cell = RowFile::Cell;

/// Reader of one file.
struct Rows {
  Draft& draft;
  std::string label;
  RowFile& table;
  std::optional<std::size_t> shape, material;  ///< of rows that name none
  bool fixed = false, as_drawn = false;
  std::map<std::string, Cell> row{};                    ///< its cells that hold something
  std::map<std::string, double> factor{};               ///< of the columns, to SI
  std::map<std::string, std::size_t> written_shapes{};  ///< of column shape, by its text
  double own_size = 1.0;                                ///< of the shape of this row

  bool has(const std::string& column) const { return row.count(column) != 0; }
  double number(const std::string& column, double otherwise = 0.0) {
    if (!has(column)) return otherwise;
    const Cell& cell = row.at(column);
    const auto value = read_number(cell.text);
    if (!value) draft.reading.error(cell.place, "column " + column + ": expected a number, found '" + cell.text + "'");
    return value.value_or(0.0) * factor.at(column);
  }
  bool check_header(const Place& place);
  std::optional<BodySpec> body();
  std::optional<std::size_t> shape_of_row();
  std::optional<std::size_t> named_shape();
  std::optional<std::size_t> sphere_of_row(const std::string& column);
  double length(const std::string& column);
  void enter_group();
};

/// place: where the scene names the file.
bool Rows::check_header(const Place& place) {
  const std::size_t errors = draft.reading.errors();
  const auto& columns = table.columns();
  for (const RowFile::Column& column : columns) {
    if (column.name.empty()) continue;
    if (!factor.emplace(column.name, column.factor).second)
      draft.reading.error(column.place, "the column '" + column.name + "' is given twice");
  }
  const auto missing = [&](const std::string& column) {
    draft.reading.error(columns.empty() ? place : columns[0].place, "missing column '" + column + "'");
  };
  for (const char* column : {"x", "y", "z"})
    if (!table.has_column(column)) missing(column);
  for (const char* group : {"vxvyvz", "wxwywz", "qwqxqyqz"}) {  // all of a vector or nothing
    const std::string names = group;
    bool any = false;
    for (std::size_t k = 0; k < names.size(); k += 2) any = any || table.has_column(names.substr(k, 2));
    for (std::size_t k = 0; any && k < names.size(); k += 2)
      if (!table.has_column(names.substr(k, 2))) missing(names.substr(k, 2));
  }
  const bool has_size = table.has_column("radius") || table.has_column("diameter");
  if (!shape && !table.has_column("shape") && !has_size) missing("radius' or 'shape");
  if (!material && !table.has_column("material")) missing("material");
  return draft.reading.errors() == errors;
}

/// A number above 0.
double Rows::length(const std::string& column) {
  const std::size_t errors = draft.reading.errors();
  const double value = number(column);
  if (!(value > 0.0) && draft.reading.errors() == errors)
    draft.reading.error(row.at(column).place, "column " + column + " = " + format_number(value) +
                                                  " is outside (0, inf) (" + column +
                                                  (column == "size" ? ", a factor)" : ", in m)"));
  return value;
}

/// Shape of column `shape`: a name, or a table as in a scene.
std::optional<std::size_t> Rows::named_shape() {
  const Cell& cell = row.at("shape");
  if (const auto found = written_shapes.find(cell.text); found != written_shapes.end()) return found->second;
  const bool is_table = cell.text.front() == '{';
  const auto named = is_table ? read_shape_value(draft, parse_toml_value(cell.text, cell.place), label)
                              : find_shape(draft, cell.text, cell.place, label);
  if (!named) return std::nullopt;
  if (!fixed) let_move(draft, *named);
  return written_shapes[cell.text] = *named;
}

std::optional<std::size_t> Rows::sphere_of_row(const std::string& column) {
  own_size = column == "radius" ? length(column) : 0.5 * length(column);
  if (!(own_size > 0.0)) return std::nullopt;
  if (!draft.unit_sphere) {
    draft.unit_sphere = draft.scene.shapes.size();
    ShapeSpec sphere;
    sphere.type = "sphere";
    sphere.parameters.set("radius", 1.0);
    sphere.place = row.at(column).place;
    draft.scene.shapes.push_back(std::move(sphere));
  }
  return draft.unit_sphere;
}

std::optional<std::size_t> Rows::shape_of_row() {
  const std::string column = has("radius") ? "radius" : "diameter";
  own_size = 1.0;
  if (has("shape") && has(column)) {
    draft.reading.error(row.at(column).place, "the row has a " + column + " and a shape; keep one");
    return std::nullopt;
  }
  if (has(column)) return sphere_of_row(column);
  if (has("size")) own_size = length("size");
  if (has("shape")) return named_shape();
  if (!shape) draft.reading.error(row.at("x").place, "the row has neither radius nor shape");
  return shape;
}

/// Begins a group where the group's name of a row changes; rows of a group are adjacent.
void Rows::enter_group() {
  auto& groups = draft.scene.groups;
  const std::string name = has("group") ? row.at("group").text : "";
  if (name.empty() || groups.back().name == name) return;
  const Place& place = row.at("group").place;
  check_group_name(draft, name, place);
  GroupSpec group = groups.back();  // of the same file: the group that both belong to, the stage
  if (group.count == 0) groups.pop_back();
  group.name = name;
  group.place = place;
  group.first = draft.scene.bodies.size();
  group.count = 0;
  groups.push_back(std::move(group));
}

std::optional<BodySpec> Rows::body() {
  BodySpec body;
  const auto own_shape = shape_of_row();
  const auto own_material =
      has("material") ? find_material(draft, row.at("material").text, row.at("material").place, label) : material;
  if (!has("material") && !material) draft.reading.error(row.at("x").place, "the row has no material");
  body.position = Vec3(number("x"), number("y"), number("z"));
  body.velocity = Vec3(number("vx"), number("vy"), number("vz"));
  body.angular_velocity = Vec3(number("wx"), number("wy"), number("wz"));
  if (body.angular_velocity.squaredNorm() > 0.0) body.spin_place = row.at("wx").place;
  body.orientation = Quat(number("qw", 1.0), number("qx"), number("qy"), number("qz"));
  if (!(body.orientation.norm() > 0.0))
    draft.reading.error(row.at("qw").place, "a quaternion of length 0 is no orientation");
  else
    body.orientation.normalize();
  body.fixed = fixed;
  body.as_drawn = as_drawn;
  if (!own_shape || !own_material) return std::nullopt;
  body.shape = *own_shape;
  body.size = own_size;
  body.material = *own_material;
  return body;
}

void add_row(Rows& rows, std::vector<Cell> cells) {
  auto& scene = rows.draft.scene;
  rows.row.clear();
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const std::string& column = rows.table.columns()[k].name;
    const bool may_be_empty = column == "shape" || column == "size" || column == "radius" || column == "diameter" ||
                              column == "material" || column == "group";
    if (!column.empty() && !(may_be_empty && cells[k].text.empty())) rows.row[column] = std::move(cells[k]);
  }
  auto body = rows.body();
  if (!body) return;
  rows.enter_group();
  body->group = scene.groups.size() - 1;
  scene.bodies.push_back(std::move(*body));
  ++scene.groups.back().count;
}

void read_rows(Rows& rows, const std::string& file, const Place& place) {
  Reading& reading = rows.draft.reading;
  const std::size_t errors = reading.errors();
  if (!rows.table.open() || !rows.check_header(place)) return;
  auto& bodies = rows.draft.scene.bodies;
  bodies.reserve(bodies.size() + rows.table.rows_ahead());
  std::vector<Cell> cells;
  while (rows.table.next(cells) && reading.errors() < errors + 20) add_row(rows, std::move(cells));
  if (reading.errors() == errors && rows.draft.scene.groups.back().count == 0)
    reading.error(place, "the file '" + file + "' has no body");
}

/// Displaces the bodies from `first` on at random, by at most `jitter` [m] per axis.
void displace(Scene& scene, std::size_t first, double jitter) {
  if (jitter == 0.0) return;
  for (std::size_t k = first; k < scene.bodies.size(); ++k) {
    Random random(scene.run.seed, k);
    for (int axis = 0; axis < 3; ++axis) scene.bodies[k].position[axis] += random.uniform(-jitter, jitter);
  }
}

/// Extension of a file of bodies in lower case; none after an error: unknown kind, or missing file.
std::optional<std::string> ending_of(Reading& reading, const std::string& path, const Place& place,
                                     const std::string& label) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  const std::vector<std::string> endings{".csv",  ".txt",       ".dat",      ".tsv",     ".xyz",
                                         ".dump", ".lammpstrj", ".liggghts", ".polyset", ".h5"};
  std::error_code failure;
  if (std::find(endings.begin(), endings.end(), ending) == endings.end())
    reading.error(place, label +
                             " file: expected a table (.csv, .txt, .dat, .tsv, .xyz), a dump of LAMMPS or LIGGGHTS "
                             "(.dump, .lammpstrj, .liggghts), .polyset or .h5, found '" +
                             path + "'");
  else if (!std::filesystem::is_regular_file(path, failure))
    reading.error(place, label + " file: there is no file '" + path + "'");
  else
    return ending;
  return std::nullopt;
}

/// Each group of a file by itself: any of them may be one of the run that the scene starts from.
void settle_groups(Draft& draft, std::size_t first) {
  auto& groups = draft.scene.groups;
  auto& bodies = draft.scene.bodies;
  if (first + 1 == groups.size()) return settle_imported(draft);
  const std::vector<GroupSpec> own(groups.begin() + static_cast<std::ptrdiff_t>(first), groups.end());
  auto row = bodies.begin() + static_cast<std::ptrdiff_t>(own.front().first);
  std::vector<BodySpec> rows(std::make_move_iterator(row), std::make_move_iterator(bodies.end()));
  bodies.erase(row, bodies.end());
  groups.resize(first);
  row = rows.begin();
  for (GroupSpec group : own) {
    group.first = bodies.size();
    for (std::size_t k = 0; k < group.count; ++k) {
      row->group = groups.size();
      bodies.push_back(std::move(*row++));
    }
    groups.push_back(std::move(group));
    settle_imported(draft);
  }
}

void read_file(Draft& draft, const Node& item) {
  Reading& reading = draft.reading;
  const std::string label = item_label("bodies", item);
  const std::size_t errors = reading.errors();
  const TableValues values = read_table(item, label, reading.schema.at("bodies").fields, reading);
  std::optional<std::size_t> shape, material;
  if (const Node* written = item.find("shape")) shape = read_shape_value(draft, *written, label);
  if (values.has("material"))
    material = find_material(draft, values.text("material"), values.place_of("material"), label);
  const std::string name = values.has("name") ? values.text("name") : "";
  check_group_name(draft, name, values.place_of("name"));
  const bool fixed = values.has("fixed") && values.boolean("fixed");
  const bool as_drawn = values.has("place") && values.text("place") == "as-drawn";
  if (reading.errors() != errors) return;
  if (!find_entry(reading.registry.shapes, "sphere"))
    return reading.error(item.place, label + ": there is no shape 'sphere'");
  const Place place = values.place_of("file");
  const std::string path = resolve_path(values.text("file"), place, reading.main_file);
  const auto ending = ending_of(reading, path, place, label);
  if (!ending) return;
  reading.files.push_back(path);
  const std::size_t first_group = draft.scene.groups.size();
  draft.scene.groups.push_back({name, draft.scene.bodies.size(), 0, item.place, {1}});
  draft.scene.groups.back().group = values.has("group") ? values.text("group") : "";
  draft.scene.groups.back().stage = item.stage;
  const std::size_t first = draft.scene.bodies.size();
  if (*ending == ".polyset") {
    if (!material) return reading.error(item.place, label + ": a .polyset needs a material");
    read_polyset(draft, {path, name, *material, fixed});
  } else {
    const auto columns = values.has("columns") ? values.texts("columns") : std::vector<std::string>{};
    try {
      RowFile table(reading, path, place, columns);
      Rows rows{draft, label, table, shape, material, fixed, as_drawn};
      read_rows(rows, path, place);
    } catch (const FileError& trouble) {
      reading.error(place, label + " file '" + path + "': " + trouble.what());
    }
  }
  displace(draft.scene, first, values.number("jitter"));
  if (reading.errors() == errors) settle_groups(draft, first_group);
}

}  // namespace

void read_body_files(Draft& draft) {
  each_item(draft.reading, "bodies", [&](const Node& item) { read_file(draft, item); });
}

}  // namespace epafi
