/// @file read_body_files.cpp  [[bodies]]: one body per row of a CSV file with a header line, of a dump of LAMMPS or LIGGGHTS
/// (its last frame), or of a text export of YADE.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "engine/nearest.h"
#include "engine/random.h"
#include "scenes/reader/parts.h"
#include "scenes/reader/toml_text.h"

namespace epafi {
namespace {

const std::vector<std::string> known_columns{"x",        "y",     "z",    "vx",       "vy",   "vz", "qw",
                                             "qx",       "qy",    "qz",   "wx",       "wy",   "wz", "radius",
                                             "diameter", "shape", "size", "material", "group"};

enum class Format { csv, dump, yade };

/// Column of ours for one of LAMMPS, LIGGGHTS or YADE; "" for what says nothing of position, motion or size.
std::string own_column(const std::string& foreign) {
  static const std::map<std::string, std::string> names{
      {"xu", "x"},      {"yu", "y"},      {"zu", "z"},      {"omegax", "wx"}, {"omegay", "wy"}, {"omegaz", "wz"},
      {"quatw", "qw"},  {"quati", "qx"},  {"quatj", "qy"},  {"quatk", "qz"},  {"r", "radius"},  {"rad", "radius"}};
  if (const auto found = names.find(foreign); found != names.end()) return found->second;
  const bool known = foreign != "material" && foreign != "shape" &&
                     std::find(known_columns.begin(), known_columns.end(), foreign) != known_columns.end();
  return known ? foreign : "";
}

struct Cell {
  std::string text;
  Place place;
};

/// Words between blanks.
std::vector<Cell> words(const std::string& line, const std::string& file, int number, std::size_t begin = 0) {
  constexpr const char* blank = " \t\r";
  std::vector<Cell> cells;
  for (begin = line.find_first_not_of(blank, begin); begin != line.npos; begin = line.find_first_not_of(blank, begin)) {
    const std::size_t end = std::min(line.find_first_of(blank, begin), line.size());
    cells.push_back({line.substr(begin, end - begin), {file, number, static_cast<int>(begin) + 1}});
    begin = end;
  }
  return cells;
}

/// Where the cell that begins there ends: at the next comma outside quotes.
std::size_t end_of_cell(const std::string& line, std::size_t begin) {
  bool quoted = false;
  for (std::size_t k = begin; k < line.size(); ++k) {
    if (line[k] == '"') quoted = !quoted;
    if (line[k] == ',' && !quoted) return k;
  }
  return line.size();
}

/// "a ""b""" to a "b"; other texts stay.
std::string without_quotes(const std::string& text) {
  if (text.size() < 2 || text.front() != '"' || text.back() != '"') return text;
  std::string out;
  for (std::size_t k = 1; k + 1 < text.size(); ++k) {
    out += text[k];
    if (text[k] == '"') ++k;  // the second of two
  }
  return out;
}

std::vector<Cell> split(const std::string& line, const std::string& file, int number) {
  std::vector<Cell> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = end_of_cell(line, begin);
    std::size_t first = begin, last = end;
    while (first < last && (line[first] == ' ' || line[first] == '\t')) ++first;
    while (last > first && (line[last - 1] == ' ' || line[last - 1] == '\t' || line[last - 1] == '\r')) --last;
    cells.push_back({without_quotes(line.substr(first, last - first)), {file, number, static_cast<int>(first) + 1}});
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
  bool fixed = false, as_drawn = false;
  Format format = Format::csv;
  std::map<std::string, Cell> row;                    ///< its cells that hold something
  std::map<std::string, std::size_t> written_shapes;  ///< of column shape, by its text
  double own_size = 1.0;  ///< of the shape of this row

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
  std::optional<std::size_t> named_shape();
  std::optional<std::size_t> sphere_of_row(const std::string& column);
  double length(const std::string& column);
  void enter_group();
};

bool Rows::check_header(const Place& place) {
  const std::size_t errors = draft.reading.errors();
  for (std::size_t k = 0; k < header.size(); ++k) {
    const Cell& cell = header[k];
    if (cell.text.empty() && format != Format::csv) continue;  // of no use here
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
  const bool has_size = has_column("radius") || has_column("diameter");
  if (!shape && !has_column("shape") && !has_size) missing("radius' or 'shape");
  if (!material && !has_column("material")) missing("material");
  return draft.reading.errors() == errors;
}

/// A number above 0.
double Rows::length(const std::string& column) {
  const double value = number(column);
  if (!(value > 0.0))
    draft.reading.error(row.at(column).place, "column " + column + " = " + format_number(value) +
                                                  " is outside (0, inf) (" + column +
                                                  (column == "size" ? ", a factor)" : ", in m)"));
  return value;
}

/// Of column shape: a name, or a table as it may stand in a scene.
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

/// Rows that name a group make one of their own; those of one name stand together.
void Rows::enter_group() {
  auto& groups = draft.scene.groups;
  const std::string name = has("group") ? row.at("group").text : "";
  if (name.empty() || groups.back().name == name) return;
  const Place& place = row.at("group").place;
  check_group_name(draft, name, place);
  if (groups.back().count == 0) groups.pop_back();
  groups.push_back({name, draft.scene.bodies.size(), 0, place, {1}});
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
  body.shape = *own_shape, body.size = own_size, body.material = *own_material;
  return body;
}

/// The line whose words name the columns, and its number; "" where there is none. Of a dump that of its last frame.
std::pair<std::string, int> find_header(std::istream& in, Format format) {
  std::pair<std::string, int> header;
  std::streampos behind = in.tellg();
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    const bool is_header = format == Format::dump ? line.rfind("ITEM: ATOMS", 0) == 0 : line.rfind("#format", 0) == 0;
    if (!is_header) continue;
    header = {line, number}, behind = in.tellg();
    if (format != Format::dump) break;
  }
  in.clear(), in.seekg(behind);
  return header;
}

/// Reads the columns of a dump (`ITEM: ATOMS id x y z ...`) or of YADE (`#format x_y_z_r`); the first row follows.
int read_foreign_header(Rows& rows, std::istream& in, const std::string& file, const Place& place) {
  auto [line, number] = find_header(in, rows.format);
  if (line.empty()) {
    rows.draft.reading.error(place, "the file '" + file + "' has no line '" +
                                        (rows.format == Format::dump ? "ITEM: ATOMS id x y z ..." : "#format x_y_z_r") + "'");
    return 0;
  }
  if (rows.format == Format::yade) std::replace(line.begin(), line.end(), '_', ' ');
  rows.header = words(line, file, number, rows.format == Format::dump ? 11 : 7);
  for (Cell& cell : rows.header) {
    if (cell.text == "xs" || cell.text == "xsu")
      rows.draft.reading.error(cell.place, "scaled coordinates: write the dump with x y z in place of xs ys zs");
    cell.text = own_column(cell.text);
  }
  return number;
}

void add_row(Rows& rows, std::vector<Cell> cells) {
  auto& scene = rows.draft.scene;
  rows.row.clear();
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const std::string& column = rows.header[k].text;
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

/// Lines from here on: as many bodies as there may be.
std::size_t lines_ahead(std::istream& in) {
  const std::streampos begin = in.tellg();
  std::size_t lines = 0;
  for (char block[4096]; in.read(block, sizeof block), in.gcount() > 0;)
    lines += static_cast<std::size_t>(std::count(block, block + in.gcount(), '\n'));
  in.clear(), in.seekg(begin);
  return lines;
}

void read_rows(Rows& rows, std::istream& in, const std::string& file, const Place& place) {
  Reading& reading = rows.draft.reading;
  const std::size_t errors = reading.errors();
  int number = 0;
  if (rows.format != Format::csv) {
    number = read_foreign_header(rows, in, file, place);
    if (reading.errors() != errors || !rows.check_header(place)) return;
  }
  auto& bodies = rows.draft.scene.bodies;
  bodies.reserve(bodies.size() + lines_ahead(in));
  std::string line;
  while (std::getline(in, line) && reading.errors() < errors + 20) {
    ++number;
    if (line.empty() || line[0] == '#' || line == "\r") continue;
    if (rows.format == Format::dump && line.rfind("ITEM:", 0) == 0) break;
    auto cells = rows.format == Format::csv ? split(line, file, number) : words(line, file, number);
    if (rows.header.empty()) {
      rows.header = std::move(cells);
      if (!rows.check_header(place)) return;
    } else if (cells.size() != rows.header.size()) {
      reading.error({file, number, 1}, fmt::format("expected {} columns, found {}", rows.header.size(), cells.size()));
    } else {
      add_row(rows, std::move(cells));
    }
  }
  if (reading.errors() == errors && rows.draft.scene.groups.back().count == 0)
    reading.error(place, "the file '" + file + "' has no body");
}

/// Displaces the bodies from `first` on by chance: a random start for bodies whose places stand in a file.
void displace(Scene& scene, std::size_t first, double jitter) {
  if (jitter == 0.0) return;
  for (std::size_t k = first; k < scene.bodies.size(); ++k) {
    Random random(scene.run.seed, k);
    for (int axis = 0; axis < 3; ++axis) scene.bodies[k].position[axis] += random.uniform(-jitter, jitter);
  }
}

void read_file(Draft& draft, const Node& item) {
  Reading& reading = draft.reading;
  const std::string label = item_label("bodies", item);
  const std::size_t errors = reading.errors();
  const TableValues values = read_table(item, label, reading.schema.at("bodies").fields, reading);
  Rows rows{draft, label, {}, {}, {}, values.has("fixed") && values.boolean("fixed"), false, Format::csv, {}, {}};
  rows.as_drawn = values.has("place") && values.text("place") == "as-drawn";
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
  const bool is_dump = ending == ".dump" || ending == ".lammpstrj" || ending == ".liggghts";
  if (ending != ".csv" && ending != ".polyset" && ending != ".txt" && !is_dump)
    return reading.error(place, label + " file: expected .csv, .dump, .lammpstrj, .liggghts (LAMMPS, LIGGGHTS), .txt "
                                        "(YADE) or .polyset, found '" + path + "'");
  std::error_code failure;
  if (!std::filesystem::is_regular_file(path, failure))
    return reading.error(place, label + " file: there is no file '" + path + "'");
  draft.scene.groups.push_back({name, draft.scene.bodies.size(), 0, item.place, {1}});
  draft.scene.groups.back().group = values.has("group") ? values.text("group") : "";
  draft.scene.groups.back().stage = item.stage;
  const std::size_t first = draft.scene.bodies.size();
  if (ending == ".polyset") {
    if (!rows.material) return reading.error(item.place, label + ": a .polyset needs a material");
    read_polyset(draft, {path, name, *rows.material, rows.fixed});
  } else {
    rows.format = is_dump ? Format::dump : ending == ".txt" ? Format::yade : Format::csv;
    std::ifstream in(path);
    read_rows(rows, in, path, place);
  }
  displace(draft.scene, first, values.number("jitter"));
  if (reading.errors() == errors) settle_imported(draft);
}

}  // namespace

void read_body_files(Draft& draft) {
  each_item(draft.reading, "bodies", [&](const Node& item) { read_file(draft, item); });
}

}  // namespace epafi
