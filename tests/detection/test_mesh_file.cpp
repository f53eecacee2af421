#include "detection/shapes/mesh_file.h"

#include <fmt/format.h>
#include <unistd.h>
#include <bit>
#include <filesystem>
#include <fstream>

#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using namespace epafi::testing;
using Catch::Matchers::Contains;
using Catch::Matchers::Equals;

namespace {

std::string number_text(double x, const char* format) {
  char word[64];
  std::snprintf(word, sizeof word, format, x);
  return word;
}
std::string obj_text(const TriangleSurface& s, const char* format = "%.17g") {
  std::string text = "# box\nmtllib none.mtl\no box\n";
  char line[160];
  for (const Vec3& v : s.vertices) {
    text += "v";
    for (const double x : v) text.append(" ").append(number_text(x, format));
    text += "\n";
  }
  for (const auto& t : s.triangles) {
    std::snprintf(line, sizeof line, "f %u/1/1 %u//2 %u\n", t[0] + 1, t[1] + 1, t[2] + 1);
    text += line;
  }
  return text;
}
std::string ascii_stl(const TriangleSurface& s) {
  std::string text = "solid box\n";
  char line[160];
  for (const auto& t : s.triangles) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const auto v : t) {
      std::snprintf(line, sizeof line, "   vertex %.17g %.17g %.17g\n", s.vertices[v].x(), s.vertices[v].y(),
                    s.vertices[v].z());
      text += line;
    }
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid box\n";
}
void put(std::string& out, std::uint32_t bits) {
  for (int k = 0; k < 4; ++k) out += static_cast<char>(bits >> (8 * k) & 255u);
}
std::string binary_stl(const TriangleSurface& s) {
  std::string out = "solid is what some writers put even here";
  out.resize(80, ' ');
  put(out, static_cast<std::uint32_t>(s.triangles.size()));
  for (const auto& t : s.triangles) {
    for (int k = 0; k < 3; ++k) put(out, 0);
    for (const auto v : t)
      for (int i = 0; i < 3; ++i) put(out, std::bit_cast<std::uint32_t>(static_cast<float>(s.vertices[v][i])));
    out += std::string(2, '\0');
  }
  return out;
}
std::string ply_header(const TriangleSurface& s, const std::string& format, const std::string& real) {
  return "ply\nformat " + format + " 1.0\nelement vertex " + std::to_string(s.vertices.size()) + "\nproperty " + real +
         " x\nproperty " + real + " y\nproperty " + real + " z\nelement face " + std::to_string(s.triangles.size()) +
         "\nproperty list uchar int vertex_indices\nend_header\n";
}
std::string ply_text(const TriangleSurface& s) {
  std::string text = ply_header(s, "ascii", "double");
  char line[160];
  for (const Vec3& v : s.vertices) {
    std::snprintf(line, sizeof line, "%.17g %.17g %.17g\n", v.x(), v.y(), v.z());
    text += line;
  }
  for (const auto& t : s.triangles) {
    std::snprintf(line, sizeof line, "3 %u %u %u\n", t[0], t[1], t[2]);
    text += line;
  }
  return text;
}
std::string binary_ply(const TriangleSurface& s, bool big) {
  std::string out = ply_header(s, big ? "binary_big_endian" : "binary_little_endian", "float");
  const auto add = [&](std::uint32_t bits) {
    std::string bytes;
    put(bytes, bits);
    if (big) std::reverse(bytes.begin(), bytes.end());
    out += bytes;
  };
  for (const Vec3& v : s.vertices)
    for (int i = 0; i < 3; ++i) add(std::bit_cast<std::uint32_t>(static_cast<float>(v[i])));
  for (const auto& t : s.triangles) {
    out += '\3';
    for (const auto v : t) add(v);
  }
  return out;
}
std::vector<Vec3> corners(const TriangleSurface& s) {
  std::vector<Vec3> out;
  for (const auto& t : s.triangles)
    for (const auto v : t) out.push_back(s.vertices[v]);
  return out;
}

}  // namespace

TEST_CASE("OBJ and both kinds of STL give back the surface that was written", "[detection][mesh-file]") {
  const TriangleSurface box = box_surface({0.5, 0.25, 2.0});
  for (const auto& [name, mesh] : {std::pair{"obj", read_obj(obj_text(box), "box.obj")},
                                   {"ascii", read_stl(ascii_stl(box), "box.stl")},
                                   {"binary", read_stl(binary_stl(box), "box.stl")}}) {
    INFO(name);
    CHECK(mesh.surface.vertices.size() == 8);
    CHECK(corners(mesh.surface) == corners(box));
    CHECK(mesh.report.is_watertight());
    CHECK_FALSE(mesh.report.is_inverted());
    CHECK(mesh.report.volume == Approx(2.0).epsilon(1e-15));
    CHECK(mesh.report.to_string() == "");
  }
}

TEST_CASE("numbers with every digit survive the text", "[detection][mesh-file]") {
  Random random(31, 0);
  const TriangleSurface s = moved(prism_surface(20, 0.3, 0.7), random_turn(random), random_point(random));
  CHECK(corners(read_obj(obj_text(s), "p.obj").surface) == corners(s));
  CHECK(corners(read_stl(ascii_stl(s), "p.stl").surface) == corners(s));
}

TEST_CASE("how far a file has rounded its corners is seen by its digits", "[detection][mesh-file]") {
  Random random(32, 0);
  const TriangleSurface s = moved(prism_surface(20, 0.3, 0.7), random_turn(random), 5.0 * random_direction(random));
  double largest = 0.0;
  for (const Vec3& v : s.vertices) largest = std::max(largest, v.cwiseAbs().maxCoeff());
  const double single = std::ldexp(largest, -24);
  const auto precision = [&](const char* format) { return read_obj(obj_text(s, format), "p.obj").report.precision; };
  CHECK(precision("%.17g") == 0.0);
  CHECK(precision("%.6f") == Approx(5e-7));
  CHECK(precision("%.5e") == Approx(5e-6));  // of the largest, in [1, 10)
  CHECK(precision("%.6g") == Approx(5e-6));
  CHECK(precision("%.9g") == Approx(single));  // single precision with all its digits
  CHECK(read_stl(binary_stl(s), "p.stl").report.precision == Approx(single));
  CHECK(read_ply(binary_ply(s, true), "p.ply").report.precision == Approx(single));
  // what a person writes is meant so
  const TriangleSurface exact = moved(box_surface({0.1, 0.25, 0.013}), Quat(1, 0, 0, 0), Vec3(0.5, 0, 0));
  CHECK(read_obj(obj_text(exact, "%.4g"), "p.obj").report.precision == 0.0);
}

TEST_CASE("the digits of a file tell its rounding whatever powers of ten its coordinates have",
          "[detection][mesh-file]") {
  Random random(34, 0);
  for (int run = 0; run < 50; ++run) {
    const double size = std::pow(10.0, random.uniform(-3, 3));
    TriangleSurface s = moved(prism_surface(20, 0.3, 0.7), random_turn(random), 2.0 * random_direction(random));
    for (Vec3& v : s.vertices) v *= size;
    s.vertices[0] *= 1e-3;  // near the origin: more decimals than the others
    const auto precision = [&](const char* format) { return read_obj(obj_text(s, format), "p.obj").report.precision; };
    double largest = 0.0;
    for (const Vec3& v : s.vertices) largest = std::max(largest, v.cwiseAbs().maxCoeff());
    const double single = std::ldexp(largest, -24);
    INFO("run " << run << ", largest coordinate " << largest);
    CHECK(precision("%.6g") == Approx(0.5 * std::pow(10.0, std::floor(std::log10(largest)) - 5)));
    CHECK(precision("%.17g") == 0.0);
    for (Vec3& v : s.vertices) v = v.cast<float>().cast<double>();
    largest = 0.0;
    for (const Vec3& v : s.vertices) largest = std::max(largest, v.cwiseAbs().maxCoeff());
    for (const char* format : {"%.8g", "%.9g", "%.8e", "%.12g", "%.17g"})
      CHECK(precision(format) == Approx(single).epsilon(1e-6));
    CHECK(read_ply(ply_text(s), "p.ply").surface.vertices == s.vertices);
  }
}

TEST_CASE("OBJ: polygons, negative indices, Windows line ends, signs and exponents", "[detection][mesh-file]") {
  const auto mesh =
      read_obj("v 0 0 0\r\nv +1 0 0\r\nv 1e0 1.0E0 0\r\nv -0 1 0\r\n\r\ns off\r\nf -4 -3 -2 -1\r\n", "q.obj");
  CHECK(mesh.surface.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}});
  CHECK(mesh.surface.vertices[1] == Vec3(1, 0, 0));
}

TEST_CASE("PLY: text and both byte orders give the same surface; other elements and properties are passed over",
          "[detection][mesh-file]") {
  const TriangleSurface box = box_surface({1, 2, 3});
  for (const auto& bytes : {ply_text(box), binary_ply(box, false), binary_ply(box, true)}) {
    const auto mesh = read_ply(bytes, "box.ply");
    CHECK(mesh.surface.vertices == box.vertices);
    CHECK(mesh.surface.triangles == box.triangles);
    CHECK(mesh.report.volume == Approx(48.0).epsilon(1e-15));
    CHECK(mesh.report.is_watertight());
  }
  const auto quad = read_ply(
      "ply\r\nformat ascii 1.0\r\ncomment x\r\nelement material 1\r\nproperty float shine\r\nelement vertex "
      "4\r\nproperty uchar red\r\n"
      "property float x\r\nproperty float y\r\nproperty float z\r\nelement face 1\r\nproperty list uchar int "
      "vertex_index\r\nend_header\r\n"
      "0.5\r\n255 0 0 0\r\n255 1 0 0\r\n255 1 1 0\r\n255 0 1 0\r\n4 0 1 2 3\r\n",
      "quad.ply");
  CHECK(quad.surface.triangles == std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}});
  CHECK(quad.surface.vertices[2] == Vec3(1, 1, 0));
}

TEST_CASE("broken PLY files are refused with the reason", "[detection][mesh-file]") {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const std::string corners = "0 0 0\n1 0 0\n0 1 0\n";
  const std::vector<std::pair<std::string, std::string>> broken{
      {"", "a.ply: error: expected 'ply', found the end of the line"},
      {"ply\nformat ebcdic 1.0\n", "a.ply:2:8: error: unknown format 'ebcdic'"},
      {"ply\nelement vertex 3\nend_header\n", "a.ply:3:1: error: the header names no format"},
      {"ply\nproperty float x\n", "a.ply:2:1: error: a property before the first element"},
      {"ply\nformat ascii 1.0\n", "a.ply:2:8: error: the file ends where 'end_header' is expected"},
      {head + corners + "\n\n", "a.ply: error: the file ends before all elements of its header are read"},
      {head + corners, "a.ply:9:1: error: the header announces at least 20 bytes of data, the file has 18"},
      {"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nend_header\n",
       "a.ply:4:1: error: element 'vertex' has no property"},  // would be 96 GB of corners
      {"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n",
       "a.ply:5:1: error: the header announces at least 16000000000 bytes of data, the file has 0"},
      {head + corners + "3 0 1 3\n", "a.ply:13:7: error: vertex index 3 is out of range: 3 vertices"},
      {head + "0 0 0\n1 0,5 0\n0 1 0\n3 0 1 2\n", "a.ply:11:3: error: expected a number, found '0,5'"},
      {head + "0 0 0\n1 9 0 0\n0 1 0\n3 0 1 2\n", "a.ply:11:7: error: expected the end of the line, found '0'"},
      {head + corners + "2 0 1\n", "a.ply:13:5: error: a face needs at least 3 vertices, found 2"},
      {head + corners + "3 0 0 0\n", "a.ply: error: the mesh has no triangle with an area"}};
  for (const auto& [text, message] : broken) CHECK_THROWS_WITH(read_ply(text, "a.ply"), Equals(message));
}

TEST_CASE("spellings of STL and OBJ that other programs write are read", "[detection][mesh-file]") {
  const TriangleSurface box = box_surface({1, 2, 3});
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
    return text;
  };
  std::string capitals = ascii_stl(box);
  std::ranges::transform(capitals, capitals.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  const std::string zeros(2, '\0'), mark = "\xef\xbb\xbf";
  for (const std::string& text : {capitals, mark + ascii_stl(box), ascii_stl(box) + zeros, binary_stl(box) + zeros,
                                  changed(ascii_stl(box), "\n", "\r"), changed(ascii_stl(box), "\n", "\r\n"),
                                  changed(ascii_stl(box), "endsolid", "end solid")}) {
    const MeshFile mesh = read_stl(text, "box.stl");
    CHECK(mesh.surface.vertices.size() == 8);
    CHECK(mesh.surface.triangles.size() == 12);
    CHECK(mesh.report.is_watertight());
  }
  for (const std::string& text :
       {mark + obj_text(box), changed(obj_text(box), "f ", "f \\\n"), changed(obj_text(box), "\n", " # more\n"),
        obj_text(box) + "p 1\n", changed(obj_text(box), "\n", "\r\n")}) {
    const MeshFile mesh = read_obj(text, "box.obj");
    CHECK(mesh.surface.vertices == box.vertices);
    CHECK(mesh.surface.triangles == box.triangles);
  }
  std::string endless;  // lines that go on and on
  for (int k = 0; k < 200000; ++k) endless += "\\\n";
  CHECK_THROWS_AS(read_obj("f " + endless, "a.obj"), SceneError);
}

TEST_CASE("a face with inner corners is cut to triangles that cover it once", "[detection][mesh-file]") {
  using Outline = std::vector<std::array<double, 2>>;
  const Outline bracket{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}, arrow{{0, 0}, {2, 1}, {0, 2}, {0.5, 1}},
      comb{{0, 0}, {1, 0}, {2, 0}, {5, 0}, {5, 2}, {4, 2}, {4, 1},
           {3, 1}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  Random random(33, 0);
  for (const Outline& outline : {bracket, arrow, comb})
    for (std::size_t start = 0; start < outline.size(); ++start) {
      const Quat turn = random_turn(random);
      std::string text, face = "f";
      double area = 0.0;
      for (std::size_t k = 0; k < outline.size(); ++k) {
        const auto &p = outline[(start + k) % outline.size()], &q = outline[(start + k + 1) % outline.size()];
        area += 0.5 * (p[0] * q[1] - p[1] * q[0]);
        const Vec3 x = turn * Vec3(p[0], p[1], 0);
        text += fmt::format("v {:.17g} {:.17g} {:.17g}\n", x.x(), x.y(), x.z());
        face += fmt::format(" {}", k + 1);
      }
      const TriangleSurface s = read_obj(text + face + "\n", "face.obj").surface;
      CHECK(s.triangles.size() == outline.size() - 2);
      double covered = 0.0;
      for (const Triangle& t : s.triangles) {
        const Vec3 twice = (s.vertices[t[1]] - s.vertices[t[0]]).cross(s.vertices[t[2]] - s.vertices[t[0]]);
        CHECK(twice.dot(turn * Vec3::UnitZ()) > 0.0);  // none lies the other way round
        covered += 0.5 * twice.norm();
      }
      CHECK(covered == Approx(area).epsilon(1e-12));
    }
}

TEST_CASE("open, clashing and inverted surfaces are named", "[detection][mesh-file]") {
  TriangleSurface s = box_surface({1, 1, 1});
  s.triangles.pop_back();  // {3, 7, 5}
  CHECK(inspect(s).open_edges == 3);
  CHECK_FALSE(inspect(s).is_watertight());
  CHECK(inspect(s).to_string() ==
        "not watertight: 3 open edges: (1, 1, -1) - (1, -1, 1), (1, 1, -1) - (1, 1, 1), (1, -1, 1) - (1, 1, 1)");
  s.triangles.push_back({3, 5, 7});
  CHECK(inspect(s).open_edges == 0);
  CHECK(inspect(s).clashing_edges == 3);
  s = box_surface({1, 1, 1});
  for (auto& t : s.triangles) std::swap(t[0], t[1]);
  CHECK(inspect(s).is_watertight());
  CHECK(inspect(s).to_string() == "inside out: the triangles are clockwise seen from outside");
}

TEST_CASE("triangles without area are left out and counted", "[detection][mesh-file]") {
  std::string text = obj_text(box_surface({1, 1, 1}));
  text += "f 1 1 2\nf 3 3 3\n";
  const auto mesh = read_obj(text, "box.obj");
  CHECK(mesh.surface.triangles.size() == 12);
  CHECK(mesh.report.dropped == 2);
  CHECK(mesh.report.is_watertight());
  CHECK(mesh.report.to_string() == "2 triangles without area left out");
}

TEST_CASE("broken OBJ files are refused at the place of the trouble", "[detection][mesh-file]") {
  const std::string v = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::vector<std::pair<std::string, std::string>> broken{
      {v + "f 1 2 4\n", "a.obj:4:7: error: vertex index 4 is out of range: 3 vertices so far"},
      {v + "f 1 2 -4\n", "a.obj:4:7: error: vertex index -4 is out of range: 3 vertices so far"},
      {v + "f 0 1 2\n", "a.obj:4:3: error: expected a vertex index, found '0'"},
      {v + "f 1 2 3.5\n", "a.obj:4:7: error: expected a vertex index, found '3.5'"},
      {v + "f 1 2 99999999999999999999\n", "a.obj:4:7: error: expected a vertex index, found '99999999999999999999'"},
      {v + "f 1 2\n", "a.obj:4:6: error: a face needs at least 3 vertices, found 2"},
      {"v 0 0\n", "a.obj:1:6: error: a number is missing"},
      {"v 0 zero 0\n", "a.obj:1:5: error: expected a number, found 'zero'"},
      {"v 0 1.5x 0\n", "a.obj:1:5: error: expected a number, found '1.5x'"},
      {"v 0 nan 0\n", "a.obj:1:5: error: 'nan' is not a finite number"},
      {"v 0 0 inf\n", "a.obj:1:7: error: 'inf' is not a finite number"},
      {"v 0 0 1e999\n", "a.obj:1:7: error: '1e999' is outside the range of numbers"},
      {"curv2 1 2\n", "a.obj:1:1: error: unknown statement 'curv2' (v, f and comments are read)"},
      {"\x7f\x45LF\x01\n", "a.obj:1:1: error: unknown statement '?ELF?' (v, f and comments are read)"},
      {v, "a.obj: error: the mesh has no triangle with an area"},
      {"", "a.obj: error: the mesh has no triangle with an area"}};
  for (const auto& [text, message] : broken) CHECK_THROWS_WITH(read_obj(text, "a.obj"), Equals(message));
}

TEST_CASE("broken STL files are refused at the place of the trouble", "[detection][mesh-file]") {
  const std::string begin = "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
  const std::vector<std::pair<std::string, std::string>> broken{
      {begin + "endloop\n", "a.stl:6:1: error: expected 'vertex', found 'endloop'"},
      {begin + "vertex 0 1 nan\n", "a.stl:6:12: error: 'nan' is not a finite number"},
      {begin + "vertex 0 1 0 1\n", "a.stl:6:14: error: expected the end of the line, found '1'"},
      {begin + "vertex 0 1 0\nvertex 1 1 0\n", "a.stl:7:1: error: expected 'endloop', found 'vertex'"},
      {begin, "a.stl:5:13: error: the file ends where 'vertex' is expected"},
      {begin + "vertex 0 1 0\nendloop\nendfacet\n", "a.stl:8:9: error: the file ends where 'endsolid' is expected"},
      {"solid x\nfacets\n", "a.stl:2:1: error: expected 'facet' or 'endsolid', found 'facets'"},
      {"solid x\nendsolid x\n", "a.stl: error: the mesh has no triangle with an area"},
      {"sol", "a.stl: error: neither text that begins with 'solid' nor the 84 bytes of a binary STL header: 3 bytes"},
      {"", "a.stl: error: neither text that begins with 'solid' nor the 84 bytes of a binary STL header: 0 bytes"}};
  for (const auto& [text, message] : broken) CHECK_THROWS_WITH(read_stl(text, "a.stl"), Equals(message));
}

TEST_CASE("a binary STL that announces more than it holds allocates nothing", "[detection][mesh-file]") {
  std::string bytes(84, ' ');
  for (std::size_t k = 80; k < 84; ++k) bytes[k] = '\xff';
  CHECK_THROWS_WITH(
      read_stl(bytes, "a.stl"),
      Equals(
          "a.stl: error: the binary STL announces 4294967295 triangles (214748364834 bytes), the file has 84 bytes"));
  std::string cut = binary_stl(box_surface({1, 1, 1}));
  cut.replace(0, 5, "DOSID");
  cut.pop_back();
  CHECK_THROWS_WITH(read_stl(cut, "a.stl"),
                    Equals("a.stl: error: the binary STL announces 12 triangles (684 bytes), the file has 683 bytes"));
  std::string spoiled = binary_stl(box_surface({1, 1, 1}));
  for (std::size_t k = 0; k < 4; ++k) spoiled[84 + 50 + 12 + k] = '\xff';
  CHECK_THROWS_WITH(read_stl(spoiled, "a.stl"),
                    Equals("a.stl: error: triangle 2 of 12 has a vertex that is not finite"));
}

TEST_CASE("any cut or flipped byte gives a mesh or a message, nothing else", "[detection][mesh-file]") {
  Random random(32, 0);
  const TriangleSurface box = box_surface({1, 2, 3});
  int read = 0, refused = 0;
  for (const std::string& good :
       {obj_text(box), ascii_stl(box), binary_stl(box), ply_text(box), binary_ply(box, false)}) {
    for (int k = 0; k < 400; ++k) {
      std::string bad =
          good.substr(0, static_cast<std::size_t>(random.uniform(0, static_cast<double>(good.size() + 1))));
      for (int j = 0; j < 3 && !bad.empty(); ++j)
        bad[static_cast<std::size_t>(random.uniform(0, static_cast<double>(bad.size())))] =
            static_cast<char>(random.bits() & 255u);
      for (const auto reader : {&read_obj, &read_stl, &read_ply}) {
        try {
          const auto mesh = reader(bad, "x", MeshFaces::needed);
          ++read;
          for (const auto& t : mesh.surface.triangles)
            for (const auto v : t) REQUIRE(v < mesh.surface.vertices.size());
          for (const Vec3& v : mesh.surface.vertices) REQUIRE(v.allFinite());
        } catch (const SceneError&) {
          ++refused;
        }
      }
    }
  }
  CHECK(read > 0);
  CHECK(refused > 0);
}

TEST_CASE("files are read by their ending; what is missing or strange is refused", "[detection][mesh-file]") {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / ("epafi_mesh_file_" + std::to_string(::getpid()));
  fs::create_directory(folder);
  const TriangleSurface box = box_surface({1, 1, 1});
  std::ofstream(folder / "box.STL", std::ios::binary) << binary_stl(box);
  std::ofstream(folder / "box.obj") << obj_text(box);
  std::ofstream(folder / "box.ply") << ply_text(box);
  std::ofstream(folder / "box.step") << "ISO";
  CHECK(read_mesh_file((folder / "box.STL").string()).surface.triangles.size() == 12);
  CHECK(read_mesh_file((folder / "box.obj").string()).surface.triangles.size() == 12);
  CHECK(read_mesh_file((folder / "box.ply").string()).surface.triangles.size() == 12);
  CHECK_THROWS_AS(read_mesh_file((folder / "box.step").string()), SceneError);
  CHECK_THROWS_AS(read_mesh_file((folder / "none.obj").string()), FileError);
  CHECK_THROWS_AS(read_mesh_file(folder.string()), FileError);
  fs::remove_all(folder);
}

TEST_CASE("corners without faces are read where a hull is taken of them", "[detection][mesh-file]") {
  const TriangleSurface box = box_surface({1, 2, 3});
  std::string corners;
  for (const Vec3& v : box.vertices) corners += fmt::format("v {} {} {}\n", v.x(), v.y(), v.z());
  const MeshFile cloud = read_obj(corners, "cloud.obj", MeshFaces::optional);
  CHECK(cloud.surface.vertices == box.vertices);
  CHECK(cloud.surface.triangles.empty());
  CHECK(read_obj(obj_text(box), "box.obj", MeshFaces::optional).surface.triangles.size() == 12);
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
      "0 0 0\n1 2 3\n";
  CHECK(read_ply(ply, "cloud.ply", MeshFaces::optional).surface.vertices.size() == 2);
  CHECK_THROWS_WITH(read_ply(ply, "cloud.ply"), Equals("cloud.ply: error: the mesh has no triangle with an area"));
  CHECK_THROWS_WITH(read_obj("# nothing\n", "a.obj", MeshFaces::optional),
                    Equals("a.obj: error: the file has no corner"));
}
