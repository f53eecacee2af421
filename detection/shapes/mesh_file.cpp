#include "detection/shapes/mesh_file.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <tuple>

#include <fmt/format.h>

#include "detection/shapes/mesh_text.h"
#include "detection/shapes/polygon_ears.h"

namespace epafi {
namespace {

constexpr std::uintmax_t largest_file = std::uintmax_t{1}
                                        << 31;           // 2 GiB: about 40 million triangles, far beyond any use
constexpr std::size_t stl_header = 84, stl_record = 50;  // bytes of a binary STL
constexpr std::size_t largest_file_index = 0xfffffffeu;

bool has_area(const TriangleSurface& s, const Triangle& t) {
  if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return false;
  const Vec3 &a = s.vertices[t[0]], &b = s.vertices[t[1]], &c = s.vertices[t[2]];
  return (b - a).cross(c - a).squaredNorm() > 0.0;
}

/// How far rounding may have put a coordinate: as it was written, or in single precision where all are such numbers.
double precision_of(const TriangleSurface& s, double written) {
  double largest = 0.0;
  for (const Vec3& v : s.vertices) {
    if (v.cast<float>().cast<double>() != v) return written;
    largest = std::max(largest, v.cwiseAbs().maxCoeff());
  }
  return std::max(written, std::ldexp(largest, -24));
}

/// Index of an OBJ face corner `v`, `v/vt`, `v//vn` or `v/vt/vn`; counted from 1, or back from the last where negative.
std::uint32_t corner(MeshText& text, std::string_view word, std::size_t vertices) {
  const auto number = word.substr(0, word.find('/'));
  long long k = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), k);
  if (error != std::errc{} || end != number.data() + number.size() || k == 0)
    text.fail(fmt::format("expected a vertex index, found '{}'", MeshText::shown(word)));
  const auto count = static_cast<long long>(vertices);
  if (k > count || k < -count) text.fail(fmt::format("vertex index {} is out of range: {} vertices so far", k, count));
  return static_cast<std::uint32_t>(k > 0 ? k - 1 : count + k);
}

void read_face(MeshText& text, TriangleSurface& surface) {
  std::vector<std::uint32_t> polygon;
  for (auto w = text.word(); !w.empty(); w = text.word()) polygon.push_back(corner(text, w, surface.vertices.size()));
  if (polygon.size() < 3) text.fail(fmt::format("a face needs at least 3 vertices, found {}", polygon.size()));
  append_polygon(surface.vertices, std::move(polygon), surface.triangles);
}

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value |= std::uint32_t{static_cast<unsigned char>(bytes[at + k])} << (8 * k);
  return value;
}

std::vector<Vec3> binary_corners(std::string_view bytes, const std::string& file) {
  const std::size_t count = little_endian(bytes, 80);
  std::vector<Vec3> corners;
  corners.reserve(3 * count);  // the caller has held the count against the size of the file
  for (std::size_t t = 0; t < count; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      Vec3 p;
      for (int i = 0; i < 3; ++i) {
        const std::size_t at = stl_header + t * stl_record + 12 + 12 * k + 4 * static_cast<std::size_t>(i);
        p[i] = std::bit_cast<float>(little_endian(bytes, at));
      }
      if (!p.allFinite())
        throw SceneError(fmt::format("triangle {} of {} has a vertex that is not finite", t + 1, count), {file, 0, 0});
      corners.push_back(p + Vec3::Zero());
    }
  }
  return corners;
}

/// As many bytes as the header announces, and no more behind than a record: some programs end with two zeros or a mark.
bool is_binary_stl(std::string_view bytes) {
  if (bytes.size() < stl_header) return false;
  const std::size_t announced = stl_header + stl_record * std::size_t{little_endian(bytes, 80)};
  const std::size_t behind = announced == stl_header ? 1 : stl_record;
  return bytes.size() >= announced && bytes.size() < announced + behind;
}

bool next_filled_line(MeshText& text) {
  while (text.next_line())
    if (text.line().find_first_not_of(" \t\r\v\f") != std::string_view::npos) return true;
  return false;
}

std::vector<Vec3> ascii_corners(MeshText& text) {
  const auto line = [&](const char* what) {
    if (!next_filled_line(text)) text.fail(fmt::format("the file ends where '{}' is expected", what));
  };
  std::vector<Vec3> corners;
  line("solid");
  text.expect("solid");
  while (next_filled_line(text)) {
    const auto first = text.word();
    const bool two_words = MeshText::same_word(first, "end") && MeshText::same_word(text.word(), "solid");
    if (two_words || MeshText::same_word(first, "endsolid")) {
      if (!next_filled_line(text)) return corners;
      text.expect("solid");  // several solids in one file are one surface
      continue;
    }
    if (!MeshText::same_word(first, "facet"))
      text.fail(fmt::format("expected 'facet' or 'endsolid', found {}", MeshText::named(first)));
    line("outer loop");
    text.expect("outer");
    text.expect("loop");
    text.expect_end();
    for (int k = 0; k < 3; ++k) {
      line("vertex");
      text.expect("vertex");
      corners.push_back(text.point() + Vec3::Zero());
      text.expect_end();
    }
    line("endloop");
    text.expect("endloop");
    text.expect_end();
    line("endfacet");
    text.expect("endfacet");
    text.expect_end();
  }
  text.fail("the file ends where 'endsolid' is expected");
}

}  // namespace

MeshFile finished_mesh(TriangleSurface surface, const std::string& file, MeshFaces faces, double written_precision) {
  const std::size_t before = surface.triangles.size();
  std::erase_if(surface.triangles, [&](const Triangle& t) { return !has_area(surface, t); });
  const std::size_t dropped = before - surface.triangles.size();
  if (faces == MeshFaces::optional && surface.vertices.empty())
    throw SceneError("the file has no corner", {file, 0, 0});
  if (faces == MeshFaces::needed && surface.triangles.empty())
    throw SceneError("the mesh has no triangle with an area", {file, 0, 0});
  MeshReport report = inspect(surface);
  report.dropped = dropped;
  report.precision = precision_of(surface, written_precision);
  return {std::move(surface), report};
}

std::string MeshReport::to_string() const {
  const auto edge = [](const std::array<Vec3, 2>& e) {
    return fmt::format("({:.6g}, {:.6g}, {:.6g}) - ({:.6g}, {:.6g}, {:.6g})", e[0].x(), e[0].y(), e[0].z(), e[1].x(),
                       e[1].y(), e[1].z());
  };
  std::string text;
  const auto add = [&](const std::string& sentence) { text.append(text.empty() ? "" : "; ").append(sentence); };
  if (open_edges > 0) {
    std::string some;
    for (const auto& e : some_open) some.append(some.empty() ? "" : ", ").append(edge(e));
    add(fmt::format("not watertight: {} open edges: {}{}", open_edges, some,
                    open_edges > some_open.size() ? " ..." : ""));
  }
  if (clashing_edges > 0)
    add(fmt::format("{} edges with more than two triangles or with two of opposite orientation, the first is {}",
                    clashing_edges, edge(first_clash)));
  if (is_inverted()) add("inside out: the triangles are clockwise seen from outside");
  if (dropped > 0) add(fmt::format("{} triangles without area left out", dropped));
  return text;
}

MeshReport inspect(const TriangleSurface& surface) {
  const auto uses = sorted_edge_uses(surface.triangles);
  MeshReport report;
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].edge() == uses[begin].edge()) ++end;
    const std::array<Vec3, 2> ends{surface.vertices[uses[begin].low], surface.vertices[uses[begin].high]};
    if (end - begin == 1) {
      if (report.open_edges++ < MeshReport::most_named) report.some_open.push_back(ends);
    } else if (end - begin > 2 || uses[begin].forward == uses[begin + 1].forward) {
      if (report.clashing_edges++ == 0) report.first_clash = ends;
    }
  }
  report.volume = surface_mass_properties(surface).mass;
  return report;
}

MeshFile read_obj(std::string_view bytes, const std::string& file, MeshFaces faces) {
  // what describes looks, names or groups does not change the surface
  constexpr std::array<std::string_view, 10> without_effect{"vn", "vt",     "vp",     "o", "g",
                                                            "s",  "usemtl", "mtllib", "l", "p"};
  MeshText text(bytes, file, true);
  TriangleSurface surface;
  while (text.next_line()) {
    const auto first = text.word();
    if (first.empty()) continue;
    if (first == "v") {
      if (surface.vertices.size() == largest_file_index) text.fail("too many vertices");
      surface.vertices.push_back(text.point());  // a fourth number (weight) or a colour may follow
    } else if (first == "f") {
      read_face(text, surface);
    } else if (std::find(without_effect.begin(), without_effect.end(), first) == without_effect.end()) {
      text.fail(fmt::format("unknown statement '{}' (v, f and comments are read)", MeshText::shown(first)));
    }
  }
  return finished_mesh(std::move(surface), file, faces, text.written_precision());
}

TriangleSurface welded_surface(const std::vector<Vec3>& corners) {
  std::vector<std::uint32_t> order(corners.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t k) { return std::tuple(corners[k].x(), corners[k].y(), corners[k].z()); };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });
  std::vector<std::uint32_t> first(corners.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    first[order[k]] = k > 0 && key(order[k]) == key(order[k - 1]) ? first[order[k - 1]] : order[k];
  TriangleSurface surface;
  std::vector<std::uint32_t> name(corners.size());
  for (std::uint32_t k = 0; k < corners.size(); ++k) {
    if (first[k] == k) {
      name[k] = static_cast<std::uint32_t>(surface.vertices.size());
      surface.vertices.push_back(corners[k]);
    } else {
      name[k] = name[first[k]];
    }
  }
  for (std::size_t k = 0; k + 2 < corners.size(); k += 3)
    surface.triangles.push_back({name[k], name[k + 1], name[k + 2]});
  return surface;
}

MeshFile read_stl(std::string_view bytes, const std::string& file, MeshFaces faces) {
  if (is_binary_stl(bytes)) return finished_mesh(welded_surface(binary_corners(bytes, file)), file, faces);
  const auto begin = bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (begin != bytes.npos && MeshText::same_word(bytes.substr(begin, 5), "solid")) {
    MeshText text(bytes, file);
    const auto corners = ascii_corners(text);
    return finished_mesh(welded_surface(corners), file, faces, text.written_precision());
  }
  if (bytes.size() < stl_header)
    throw SceneError(
        fmt::format("neither text that begins with 'solid' nor the 84 bytes of a binary STL header: {} bytes",
                    bytes.size()),
        {file, 0, 0});
  const std::size_t count = little_endian(bytes, 80);
  throw SceneError(fmt::format("the binary STL announces {} triangles ({} bytes), the file has {} bytes", count,
                               stl_header + stl_record * count, bytes.size()),
                   {file, 0, 0});
}

MeshFile read_mesh_file(const std::string& path, MeshFaces faces) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (!fs::is_regular_file(path, error)) throw FileError(fmt::format("cannot read mesh '{}': no such file", path));
  const auto size = fs::file_size(path, error);
  if (error || size > largest_file) throw FileError(fmt::format("cannot read mesh '{}': larger than 2 GiB", path));
  std::string ending = fs::path(path).extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  const bool is_table = ending == ".txt" || ending == ".csv" || ending == ".dat";
  if (ending != ".obj" && ending != ".stl" && ending != ".ply" && !is_table)
    throw SceneError(
        fmt::format("mesh files end in .obj, .stl, .ply or, as tables of triangles, .txt, .csv, .dat; found "
                    "'{}'",
                    ending),
        {path, 0, 0});
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream in(path, std::ios::binary);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw FileError(fmt::format("cannot read mesh '{}'", path));
  const auto read = is_table           ? read_triangle_table
                    : ending == ".obj" ? read_obj
                    : ending == ".stl" ? read_stl
                                       : read_ply;
  return read(bytes, path, faces);
}

}  // namespace epafi
