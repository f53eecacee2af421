// Triangles as rows of nine numbers: the corners one after the other, a line of names before them or none. Names may
// end in a unit, as in "vertex1_X[mm]"; without one coordinates are metres.
#include <array>
#include <optional>

#include "detection/shapes/mesh_file.h"
#include "detection/shapes/mesh_text.h"
#include "engine/units.h"

namespace epafi {
namespace {

constexpr std::size_t columns = 9;

/// To metres, of each column.
using Factors = std::array<double, columns>;

double factor_of(const std::string& name, const MeshText& text) {
  const auto begin = name.find('['), end = name.find(']');
  if (begin == name.npos || end == name.npos || end < begin) return 1.0;
  const QuantityResult read = read_quantity("1 " + name.substr(begin + 1, end - begin - 1), "m");
  if (!read.value) text.fail(fmt::format("column '{}': {}", MeshText::shown(name), read.problem));
  return *read.value;
}

std::vector<std::string> words_of(std::string line) {
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == ',' || c == ';' || c == '\t' || c == '"'; }, ' ');
  std::vector<std::string> words;
  for (std::size_t at = line.find_first_not_of(' '); at != line.npos;) {
    const std::size_t end = std::min(line.find(' ', at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(' ', end);
  }
  return words;
}

std::optional<double> number_in(const std::string& word) {
  const std::size_t sign = word[0] == '+' ? 1 : 0;
  double value = 0.0;
  const char* end = word.data() + word.size();
  const auto read = std::from_chars(word.data() + sign, end, value);
  return read.ec == std::errc{} && read.ptr == end && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

/// False where the line is one of names.
bool read_row(const std::vector<std::string>& words, const Factors& factors, const MeshText& text,
              std::vector<Vec3>& corners) {
  for (std::size_t k = 0; k < columns; ++k) {
    const auto value = number_in(words[k]);
    if (!value && corners.empty() && k == 0) return false;
    if (!value) text.fail(fmt::format("expected a number, found {}", MeshText::named(words[k])));
    if (k % 3 == 0) corners.push_back(Vec3::Zero());
    corners.back()[static_cast<int>(k % 3)] = factors[k] * *value;
  }
  return true;
}

}  // namespace

MeshFile read_triangle_table(std::string_view bytes, const std::string& file, MeshFaces faces) {
  MeshText text(bytes, file, true);
  Factors factors;
  factors.fill(1.0);
  std::vector<Vec3> corners;
  bool named = false;
  while (text.next_line()) {
    const auto words = words_of(std::string(text.line()));
    if (words.empty()) continue;
    if (words.size() != columns)
      text.fail(fmt::format("a triangle is nine numbers, x y z of its three corners; found {} columns", words.size()));
    if (read_row(words, factors, text, corners)) continue;
    if (std::exchange(named, true)) text.fail("a second line of names");
    for (std::size_t k = 0; k < columns; ++k) factors[k] = factor_of(words[k], text);
  }
  return finished_mesh(welded_surface(corners), file, faces);
}

}  // namespace epafi
