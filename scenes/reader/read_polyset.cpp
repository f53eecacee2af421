/// @file read_polyset.cpp  [[bodies]] from a .polyset file: convex polyhedra, each with its own vertices and pose.
///   polyset 1 SEED N L          header; the rest of the line is for other programs
///   b NV NF MASS IXX IYY IZZ PX PY PZ QW QX QY QZ     one body: position of the centre of mass, orientation
///   v X Y Z                     NV vertices about the centre of mass [m]
///   f A B C                     NF triangles; not read: the body is the convex hull of the vertices
/// Mass properties are computed from the vertices and the material's density, as for any polyhedron.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "scenes/reader/parts.h"

namespace epafi {

namespace {

/// Lines of the file with their numbers.
struct Lines {
  std::ifstream in;
  std::string file, text;
  int number = 0;
  bool next() {
    while (std::getline(in, text)) {
      ++number;
      if (!text.empty() && text[0] != '#') return true;
    }
    return false;
  }
  Place place() const { return {file, number, 1}; }
};

/// `count` finite numbers after the first word of the line; empty where there are fewer.
std::vector<double> numbers_of(const std::string& line, std::size_t count) {
  std::istringstream in(line);
  std::string word;
  in >> word;
  std::vector<double> out;
  for (double v = 0; out.size() < count && in >> v && std::isfinite(v);) out.push_back(v);
  if (out.size() < count) out.clear();
  return out;
}

bool starts_with(const std::string& line, const char* word) { return line.rfind(std::string(word) + " ", 0) == 0; }

}  // namespace

void read_polyset(Draft& draft, const BodyFile& file) {
  Lines lines{std::ifstream(file.path), file.path, {}, 0};
  Scene& scene = draft.scene;
  const auto fail = [&](const std::string& expected) {
    draft.reading.error(lines.place(), fmt::format("expected {}, found '{}'", expected, lines.text.substr(0, 40)));
  };
  if (!lines.next() || !starts_with(lines.text, "polyset")) return fail("the header 'polyset 1 ...'");
  const auto header = numbers_of(lines.text, 3);
  const Place header_place = lines.place();
  std::size_t bodies = 0;
  for (; lines.next(); ++bodies) {
    const auto body = numbers_of(lines.text, 13);
    if (!starts_with(lines.text, "b") || body.empty()) return fail("a body 'b' with 13 numbers");
    if (!(body[0] >= 4 && body[0] <= 1e6 && body[1] >= 0 && body[1] <= 1e7)) return fail("4 to 1e6 vertices");
    ShapeSpec shape;
    shape.type = "polyhedron";
    shape.place = lines.place();
    BodySpec spec;
    spec.position = Vec3(body[6], body[7], body[8]);
    spec.orientation = Quat(body[9], body[10], body[11], body[12]);
    if (!(spec.orientation.norm() > 0)) return fail("a quaternion that is not 0");
    spec.orientation.normalize();
    std::vector<Vec3> vertices;
    for (auto k = static_cast<long>(body[0]); k > 0; --k) {
      const bool more = lines.next();
      const auto v = more ? numbers_of(lines.text, 3) : std::vector<double>{};
      if (v.empty() || !starts_with(lines.text, "v")) return fail("a vertex 'v x y z'");
      vertices.push_back(Vec3(v[0], v[1], v[2]));
    }
    for (auto k = static_cast<long>(body[1]); k > 0; --k)
      if (!lines.next() || !starts_with(lines.text, "f")) return fail("a triangle 'f a b c'");
    shape.parameters.set("vertices", std::move(vertices));
    spec.shape = scene.shapes.size();
    spec.material = file.material;
    spec.fixed = file.fixed;
    spec.group = scene.groups.size() - 1;
    scene.shapes.push_back(std::move(shape));
    scene.bodies.push_back(std::move(spec));
    ++scene.groups.back().count;
  }
  if (bodies == 0 || (!header.empty() && header[2] != static_cast<double>(bodies)))
    draft.reading.error(
        header_place, fmt::format("the file announces {} bodies and has {}", header.empty() ? 1.0 : header[2], bodies));
}

}  // namespace epafi
