// Triangles as rows of nine numbers: the corners one after the other, a line of names before them or none. Names that
// tell corner and axis, as "x1" or "vertex1_X", give the order of columns. They may end in a unit, as in "x1[mm]",
// "x1 (mm)", "x1/mm" or "x1_mm"; a line "# unit: mm" before them holds for all. Without one coordinates are metres.
#include <array>
#include <optional>

#include "detection/shapes/mesh_file.h"
#include "detection/shapes/mesh_text.h"
#include "engine/units/units.h"

namespace epafi {
namespace {

constexpr std::size_t columns = 9;
constexpr std::string_view blanks = " \t\r\v\f\"";

/// Words of the rest of the line.
std::size_t count_words(MeshText text) {
  std::size_t count = 0;
  while (!text.word().empty()) ++count;
  return count;
}

bool begins_with_a_name(MeshText text) {
  const char first = text.word().front();
  return (first >= 'A' && first <= 'Z') || (first >= 'a' && first <= 'z');
}

/// Names of a line: between commas or semicolons, or, where it has none, between blanks.
std::vector<std::string_view> cells_of(std::string_view line) {
  const std::string_view ends = line.find_first_of(",;") == line.npos ? blanks : ",;";
  std::vector<std::string_view> cells;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t end = std::min(line.find_first_of(ends, at), line.size());
    std::string_view cell = line.substr(at, end - at);
    cell.remove_prefix(std::min(cell.find_first_not_of(blanks), cell.size()));
    cell = cell.substr(0, cell.find_last_not_of(blanks) + 1);
    if (!cell.empty()) cells.push_back(cell);
    at = end + 1;
  }
  return cells;
}

/// Metres per unit.
std::optional<double> unit(std::string_view name) { return read_quantity("1 " + std::string(name), "m").value; }

/// A column: to metres, and which of the nine numbers it is.
struct Column {
  double factor = 1.0;
  std::optional<std::size_t> number{};
};

Column column_of(std::string_view name, double factor, const MeshText& text) {
  Column column{factor};
  const auto bracket = name.find_first_of("[("), mark = name.find_last_of("/_");
  if (bracket != name.npos) {
    const auto inside = name.substr(bracket + 1, name.find_first_of("])") - bracket - 1);
    const std::optional<double> written = unit(inside);
    if (!written)
      text.fail(fmt::format("column '{}': '{}' is no unit of length", MeshText::shown(name), MeshText::shown(inside)));
    column.factor = *written;
    name = name.substr(0, name.find_last_not_of(blanks, bracket - (bracket > 0)) + 1);
  } else if (mark != name.npos && unit(name.substr(mark + 1))) {
    column.factor = *unit(name.substr(mark + 1));
    name = name.substr(0, mark);
  }
  const auto corner = name.find_first_of("123");
  if (corner == name.npos || name.find_first_of("0123456789", corner + 1) != name.npos) return column;
  constexpr std::string_view axes = "xyzXYZ";
  auto axis = axes.find(name.back());
  if (axis == axes.npos) axis = axes.find(name.front());
  if (axis != axes.npos) column.number = 3 * static_cast<std::size_t>(name[corner] - '1') + axis % 3;
  return column;
}

/// By their names. As they stand where the names do not tell each of the nine numbers once.
std::array<Column, columns> columns_of(const std::vector<std::string_view>& names, double factor,
                                       const MeshText& text) {
  std::array<Column, columns> all;
  std::array<bool, columns> told{};
  for (std::size_t k = 0; k < columns; ++k) {
    all[k] = names.empty() ? Column{factor} : column_of(names[k], factor, text);
    if (all[k].number) told[*all[k].number] = true;
  }
  const bool by_name = std::ranges::find(told, false) == told.end();
  for (std::size_t k = 0; k < columns && !by_name; ++k) all[k].number = k;
  return all;
}

/// Of a line "# unit: mm" before all others but comments.
double unit_before(std::string_view bytes, MeshText text) {
  while (bytes.starts_with('#')) {
    text.next_line();
    const std::string_view line = bytes.substr(0, bytes.find_first_of("\n\r"));
    bytes.remove_prefix(std::min(bytes.find_first_not_of("\n\r", line.size()), bytes.size()));
    const auto colon = line.find("unit:");
    if (colon == line.npos) continue;
    const auto cells = cells_of(line.substr(colon + 5));
    const auto factor = cells.empty() ? std::nullopt : unit(cells.front());
    if (!factor) text.fail("the unit after '# unit:' is no unit of length; write m, mm, cm, um or in");
    return *factor;
  }
  return 1.0;
}

}  // namespace

MeshFile read_triangle_table(std::string_view bytes, const std::string& file, MeshFaces faces) {
  std::string between_blanks(bytes);
  std::ranges::replace_if(
      between_blanks, [](char c) { return c == ',' || c == ';' || c == '"'; }, ' ');
  MeshText text(between_blanks, file, true);
  const double unit = unit_before(bytes, text);
  std::array<Column, columns> column = columns_of({}, unit, text);
  std::vector<Vec3> corners;
  for (bool named = false; text.next_line();) {
    const std::size_t words = count_words(text);
    if (words == 0) continue;
    const std::size_t begin = static_cast<std::size_t>(text.line().data() - between_blanks.data());
    const auto names = !named && corners.empty() && begins_with_a_name(text)
                           ? cells_of(bytes.substr(begin, text.line().size()))
                           : std::vector<std::string_view>{};
    if ((names.empty() ? words : names.size()) != columns)
      text.fail(fmt::format("a triangle is nine numbers, x y z of its three corners; found {} columns",
                            names.empty() ? words : names.size()));
    named = named || !names.empty();
    if (!names.empty()) {
      column = columns_of(names, unit, text);
      continue;
    }
    std::array<double, columns> x;
    for (std::size_t k = 0; k < columns; ++k) x[*column[k].number] = column[k].factor * text.number();
    for (std::size_t k = 0; k < columns; k += 3) corners.emplace_back(x[k], x[k + 1], x[k + 2]);
  }
  const double largest = std::ranges::max_element(column, {}, &Column::factor)->factor;
  return finished_mesh(welded_surface(corners), file, faces, text.written_precision() * largest);
}

}  // namespace epafi
