#include "scenes/reader/row_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "engine/units/nearest.h"
#include "engine/units/units.h"
#include "scenes/reader/text_cells.h"
#include "viz_export/output/bodies_table.h"

namespace epafi {
namespace {

/// A name reduced to lower-case letters and digits, without a unit in brackets.
std::string plain_name(const std::string& name) {
  std::string out;
  for (const char c : name.substr(0, name.find_first_of("[("))) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u) != 0) out += static_cast<char>(std::tolower(u));
  }
  return out;
}

/// The unit in a name: "mm" of "PosX[mm]", "" where there is none.
std::string unit_in(const std::string& name) {
  const auto begin = name.find_first_of("[("), end = name.find_last_of("])");
  return begin != name.npos && end != name.npos && end > begin ? name.substr(begin + 1, end - begin - 1) : "";
}

/// Epafi's column for a plain name; "" for one that is not position, motion or size.
std::string own_name(const std::string& name) {
  static const std::map<std::string, std::string> names = [] {
    std::map<std::string, std::string> all;
    for (const std::string& known : RowFile::known()) all[known] = known;
    for (const std::string axis : {"x", "y", "z"}) {
      for (const char* before : {"pos", "position", "p", "coord", "centre", "center"}) all[before + axis] = axis;
      for (const char* behind : {"u", "pos", "position", "coord"}) all[axis + behind] = axis;
      for (const char* before : {"vel", "velocity"}) all[before + axis] = "v" + axis;
      for (const char* before : {"omega", "angvel", "angularvelocity", "spin"}) all[before + axis] = "w" + axis;
    }
    all.insert({{"r", "radius"}, {"rad", "radius"}, {"d", "diameter"}, {"diam", "diameter"}});
    all.insert({{"quatw", "qw"}, {"quati", "qx"}, {"quatj", "qy"}, {"quatk", "qz"}});
    return all;
  }();
  const auto found = names.find(name);
  return found == names.end() ? "" : found->second;
}

/// SI unit of a column.
std::string si_unit(const std::string& column) {
  if (column[0] == 'v' && column.size() == 2) return "m/s";
  if (column[0] == 'w' && column.size() == 2) return "rad/s";
  return column[0] == 'q' || column == "size" ? "" : "m";
}

bool is_word(const std::string& column) { return column == "shape" || column == "material" || column == "group"; }

/// Separator of a line: comma, else semicolon, else blank. Tables in braces hold commas and semicolons within quotes
/// only.
char separator_of(const std::string& line) {
  for (const char c : {',', ';'})
    if (cells_of_line(line, c).size() > 1) return c;
  return ' ';
}

struct DumpUnits {
  const char* name;
  double length, time;  ///< [m], [s]
};
/// LAMMPS, command `units`; styles for molecules are left out. lj: dimensionless, read as SI, as usual for granular
/// scenes.
constexpr DumpUnits dump_units[] = {
    {"si", 1.0, 1.0}, {"lj", 1.0, 1.0}, {"cgs", 1e-2, 1.0}, {"micro", 1e-6, 1e-6}, {"nano", 1e-9, 1e-9}};

}  // namespace

const std::vector<std::string>& RowFile::known() {
  static const std::vector<std::string> names{"x",        "y",     "z",    "vx",       "vy",   "vz", "qw",
                                              "qx",       "qy",    "qz",   "wx",       "wy",   "wz", "radius",
                                              "diameter", "shape", "size", "material", "group"};
  return names;
}

RowFile::RowFile(Reading& reading, std::string path, Place place, std::vector<std::string> columns)
    : reading_(reading),
      path_(std::move(path)),
      place_(std::move(place)),
      wanted_(std::move(columns)),
      in_(path_.ends_with(".h5")
              ? std::unique_ptr<std::istream>(std::make_unique<std::istringstream>(bodies_csv(path_)))
              : std::make_unique<std::ifstream>(path_, std::ios::binary)) {}

bool RowFile::error(const Place& at, const std::string& text) const {
  reading_.error(at, text);
  return false;
}

bool RowFile::has_column(const std::string& name) const {
  return std::any_of(columns_.begin(), columns_.end(), [&](const Column& c) { return c.name == name; });
}

bool RowFile::next_line() { return next_text_line(*in_, line_, number_); }

std::vector<RowFile::Cell> RowFile::split(std::size_t begin) const {
  std::vector<Cell> cells;
  for (TextCell& cell : cells_of_line(line_, separator_, begin))
    cells.push_back({std::move(cell.text), {path_, number_, cell.column}});
  return cells;
}

bool RowFile::open() {
  const std::size_t errors = reading_.errors();
  if (!next_line()) return error(place_, "the file '" + path_ + "' has no body");
  is_dump_ = line_.rfind("ITEM:", 0) == 0 || path_.ends_with(".dump") || path_.ends_with(".lammpstrj") ||
             path_.ends_with(".liggghts");
  return (is_dump_ ? open_dump() : open_text()) && reading_.errors() == errors;
}

/// Reads the columns of the last frame, whose rows follow.
bool RowFile::open_dump() {
  std::streampos behind = -1;
  int header_line = 0;
  std::string header;
  std::optional<std::size_t> count;
  int count_line = 0;
  do {
    if (line_.rfind("ITEM: UNITS", 0) == 0 && next_line() && !read_units(line_)) return false;
    if (line_.rfind("ITEM: NUMBER OF ATOMS", 0) == 0 && next_line()) {
      const auto n = read_number(line_);
      if (!n || *n < 0.0) return error({path_, number_, 1}, "expected the number of bodies, found '" + line_ + "'");
      count = static_cast<std::size_t>(*n);
      count_line = number_;
    }
    if (line_.rfind("ITEM: ATOMS", 0) != 0) continue;
    header = line_;
    header_line = number_;
    behind = in_->tellg();
    announced_ = count;
    announced_line_ = count_line;
  } while (next_line());
  if (header.empty()) return error(place_, "the file '" + path_ + "' has no line 'ITEM: ATOMS id x y z ...'");
  in_->clear();
  if (behind != std::streampos(-1)) in_->seekg(behind);
  line_ = header;
  number_ = header_line;
  if (!wanted_.empty()) return named_by_scene(split(11).size());
  name_columns(split(11), false);
  return true;
}

bool RowFile::read_units(const std::string& name) {
  std::vector<std::string> names;
  for (const DumpUnits& units : dump_units) {
    names.push_back(units.name);
    if (name != units.name) continue;
    length_ = units.length;
    time_ = units.time;
    return true;
  }
  return error({path_, number_, 1},
               fmt::format("units '{}' are not read; of LAMMPS' units {}", name, fmt::join(names, ", ")));
}

/// Reads the columns of a table: from a line of names, from a comment, or by default.
bool RowFile::open_text() {
  std::vector<Cell> in_comment;
  do {
    if (line_.find_first_not_of(" \t") == line_.npos) continue;
    if (line_[0] != '#') {
      separator_ = separator_of(line_);
      break;
    }
    const bool is_yade = line_.rfind("#format", 0) == 0;
    if (is_yade) std::replace(line_.begin(), line_.end(), '_', ' ');
    separator_ = separator_of(line_);
    auto cells = split(is_yade ? 7 : 1);
    const auto places = std::count_if(cells.begin(), cells.end(), [](const Cell& c) {
      const std::string own = own_name(plain_name(c.text));
      return own == "x" || own == "y" || own == "z";
    });
    if (places == 3) in_comment = std::move(cells);
  } while (next_line());
  if (!*in_) return error(place_, "the file '" + path_ + "' has no body");
  const auto cells = split();
  const bool numbers =
      std::all_of(cells.begin(), cells.end(), [](const Cell& c) { return read_number(c.text).has_value(); });
  kept_line_ = numbers;
  if (!wanted_.empty()) return named_by_scene(cells.size());
  if (!numbers) {
    name_columns(cells, separator_ == ',');
  } else if (!in_comment.empty()) {
    name_columns(in_comment, false);
  } else if (cells.size() == 3) {
    wanted_ = {"x", "y", "z"};
    return named_by_scene(3);
  } else {
    return error({path_, number_, 1},
                 fmt::format("{} columns without names: name them by `columns`, as in columns = [\"x\", "
                             "\"y\", \"z\", \"radius\"]; \"-\" passes one over",
                             cells.size()));
  }
  return true;
}

bool RowFile::named_by_scene(std::size_t count) {
  if (wanted_.size() != count)
    return error(place_, fmt::format("columns: {} names, the file '{}' has {} columns", wanted_.size(), path_, count));
  for (const std::string& name : wanted_)
    columns_.push_back(name == "-" ? Column{"", name, place_} : column_of({name, place_}, true));
  return true;
}

void RowFile::name_columns(const std::vector<Cell>& header, bool strict) {
  for (const Cell& cell : header) columns_.push_back(column_of(cell, strict));
}

/// strict: an unknown name is an error, unless it has a unit: then another program wrote it.
RowFile::Column RowFile::column_of(const Cell& cell, bool strict) const {
  Column column{own_name(plain_name(cell.text)), cell.text, cell.place};
  const std::string unit = unit_in(cell.text);
  if (is_dump_ && (cell.text == "xs" || cell.text == "xsu"))
    reading_.error(cell.place, "scaled coordinates: write the dump with x y z in place of xs ys zs");
  if (column.name.empty()) {
    if (strict && unit.empty())
      reading_.error(cell.place,
                     "unknown column '" + cell.text + "'" + suggestion(cell.text, known(), "known columns"));
    return column;
  }
  if (is_word(column.name)) {
    if (is_dump_) column.name.clear();  // numbers of types
    return column;
  }
  const std::string si = si_unit(column.name);
  if (!unit.empty()) {
    const auto read = read_quantity("1 " + unit, si);
    if (!read.value) reading_.error(cell.place, "column '" + cell.text + "': " + read.problem);
    column.factor = read.value.value_or(1.0);
  } else if (is_dump_) {
    column.factor = si == "m" ? length_ : si == "m/s" ? length_ / time_ : si == "rad/s" ? 1.0 / time_ : 1.0;
  }
  return column;
}

bool RowFile::next(std::vector<Cell>& cells) {
  while (kept_line_ || next_line()) {
    kept_line_ = false;
    if (line_.find_first_not_of(" \t") == line_.npos || line_[0] == '#') continue;
    if (is_dump_ && line_.rfind("ITEM:", 0) == 0) break;
    cells = split();
    ++rows_;
    if (cells.size() == columns_.size()) return true;
    return error({path_, number_, 1}, fmt::format("expected {} columns, found {}", columns_.size(), cells.size()));
  }
  return check_count();
}

/// Reports a dump whose last frame lacks rows, as after an interrupted write. Always returns false.
bool RowFile::check_count() {
  if (announced_ && *announced_ != rows_)
    error({path_, announced_line_, 1},
          fmt::format("the last frame announces {} bodies and has {} rows", *announced_, rows_));
  announced_.reset();
  return false;
}

std::size_t RowFile::rows_ahead() {
  const std::streampos begin = in_->tellg();
  std::size_t lines = 1;
  for (char block[4096]; in_->read(block, sizeof block), in_->gcount() > 0;)
    lines += static_cast<std::size_t>(std::count(block, block + in_->gcount(), '\n'));
  in_->clear();
  in_->seekg(begin);
  return lines;
}

}  // namespace epafi
