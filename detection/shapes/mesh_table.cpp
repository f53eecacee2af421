// Triangles as rows of nine numbers: the corners one after the other, a line of names before them or none. Names may
// end in a unit, as in "vertex1_X[mm]"; without one coordinates are metres.
#include <array>

#include "detection/shapes/mesh_file.h"
#include "detection/shapes/mesh_text.h"
#include "engine/units/units.h"

namespace epafi {
namespace {

constexpr std::size_t columns = 9;

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

/// To metres.
double factor_of(std::string_view name, const MeshText& text) {
  const auto begin = name.find('['), end = name.find(']');
  if (begin == name.npos || end == name.npos || end < begin) return 1.0;
  const QuantityResult read = read_quantity("1 " + std::string(name.substr(begin + 1, end - begin - 1)), "m");
  if (!read.value) text.fail(fmt::format("column '{}': {}", MeshText::shown(name), read.problem));
  return *read.value;
}

}  // namespace

MeshFile read_triangle_table(std::string_view bytes, const std::string& file, MeshFaces faces) {
  std::string between_blanks(bytes);
  std::ranges::replace_if(
      between_blanks, [](char c) { return c == ',' || c == ';' || c == '"'; }, ' ');
  MeshText text(between_blanks, file, true);
  std::array<double, columns> factors;
  factors.fill(1.0);
  std::vector<Vec3> corners;
  for (bool named = false; text.next_line();) {
    const std::size_t words = count_words(text);
    if (words == 0) continue;
    if (words != columns)
      text.fail(fmt::format("a triangle is nine numbers, x y z of its three corners; found {} columns", words));
    if (!named && corners.empty() && begins_with_a_name(text)) {
      for (double& factor : factors) factor = factor_of(text.word(), text);
      named = true;
      continue;
    }
    for (std::size_t k = 0; k < columns; k += 3) {
      const Vec3 x = text.point();
      corners.push_back(x.cwiseProduct(Vec3(factors[k], factors[k + 1], factors[k + 2])));
    }
  }
  const double precision = text.written_precision() * *std::ranges::max_element(factors);
  return finished_mesh(welded_surface(corners), file, faces, precision);
}

}  // namespace epafi
