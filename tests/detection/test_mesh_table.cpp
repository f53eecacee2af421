// Triangles from tables of nine columns.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <random>

#include "detection/shapes/mesh_file.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using namespace epafi::testing;
using Catch::Matchers::Contains;

TEST_CASE("triangles are read from a table of nine columns, with names and units or without",
          "[detection][mesh-file]") {
  const TriangleSurface box = box_surface({1, 2, 3});
  for (const auto& [header, factor, gap] : {std::tuple("", 1.0, " "),
                                            {"x1 y1 z1 x2 y2 z2 x3 y3 z3\n", 1.0, "\t"},
                                            {"X[mm],Y[mm],Z[mm],X[mm],Y[mm],Z[mm],X[mm],Y[mm],Z[mm]\n", 1e3, ","}}) {
    std::string text = header;
    for (const Triangle& t : box.triangles) {
      std::vector<double> row;
      for (const std::uint32_t v : t)
        for (int k = 0; k < 3; ++k) row.push_back(factor * box.vertices[v][k]);
      text += fmt::format("{}\n", fmt::join(row, gap));
    }
    const MeshFile mesh = read_triangle_table(text, "box.txt");
    CHECK(mesh.surface.triangles.size() == 12);
    CHECK(mesh.report.is_watertight());
    CHECK(mesh.report.volume == Approx(surface_mass_properties(box.vertices, box.triangles).mass));
  }
  CHECK_THROWS_WITH(read_triangle_table("0 0 0 1 0 0 0 1\n", "a.txt"), Contains("a.txt:1:") && Contains("8 columns"));
  CHECK_THROWS_WITH(read_triangle_table("0 0 0 1 0 0 0 1 q\n", "a.txt"), Contains("expected a number, found 'q'"));
}

TEST_CASE("names of triangle columns give their order and units, however they are written", "[detection][mesh]") {
  Random random(17, 1);
  const std::string corner_of[] = {"1", "2", "3"}, axis_of[] = {"x", "y", "z"};
  for (int draw = 0; draw < 60; ++draw) {
    std::array<std::size_t, 9> order{0, 1, 2, 3, 4, 5, 6, 7, 8};
    if (draw % 2 == 0) std::shuffle(order.begin(), order.end(), std::mt19937(static_cast<unsigned>(draw)));
    const auto style = random.bits() % 3, unit = random.bits() % 6;
    const std::string between = random.bits() % 2 == 0 && unit != 1 ? " " : random.bits() % 2 == 0 ? "," : " ; ";
    const std::string after[] = {"[mm]", " [mm]", "(mm)", "/mm", "_mm", ""};
    std::string names = unit == 5 ? "# made by hand\n# unit: mm\n" : "", rows;
    for (std::size_t k = 0; k < 9; ++k) {
      const std::string corner = corner_of[order[k] / 3], axis = axis_of[order[k] % 3];
      const std::string name = style == 0   ? axis + corner
                               : style == 1 ? "vertex" + corner + "_" + std::string(1, char(axis[0] - 'x' + 'X'))
                                            : corner + axis;
      names += (k > 0 ? between : "") + (style == 2 ? "p" + name : name) + after[unit];
    }
    std::array<double, 9> x{};
    std::vector<Vec3> points;
    for (int row = 0; row < 3; ++row) {
      for (double& c : x) c = std::round(random.uniform(-500, 500));
      for (std::size_t k = 0; k < 9; ++k) rows += (k > 0 ? between : "") + fmt::format("{}", x[order[k]]);
      rows += "\n";
      for (std::size_t k = 0; k < 9; k += 3) points.emplace_back(1e-3 * x[k], 1e-3 * x[k + 1], 1e-3 * x[k + 2]);
    }
    INFO(names << "\n" << rows);
    const MeshFile mesh = read_triangle_table(names + "\n" + rows, "a.csv");
    REQUIRE(mesh.surface.vertices.size() == points.size());
    for (const Vec3& p : points)
      CHECK(std::ranges::any_of(mesh.surface.vertices, [&](const Vec3& v) { return (v - p).norm() < 1e-12; }));
  }
  CHECK_THROWS_WITH(read_triangle_table("x1[kg] y1 z1 x2 y2 z2 x3 y3 z3\n", "a.csv"),
                    Contains("'kg' is no unit of length"));
  CHECK_THROWS_WITH(read_triangle_table("# unit: kg\n0 0 0 1 0 0 0 1 0\n", "a.csv"), Contains("no unit of length"));
}

TEST_CASE("what a PLY file does not need may be no number", "[detection][mesh-file]") {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float quality\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 nan 0 0\n1 - 2 0\n0 1e999 1 3\n3 0 1 2\n";
  const MeshFile mesh = read_ply(ply, "a.ply");
  CHECK(mesh.surface.vertices[1] == Vec3(1, 2, 0));
  CHECK_THROWS_AS(read_ply(ply.substr(0, ply.find("0 nan")) + "nan 0 0 0\n0 0 0 0\n0 0 0 0\n3 0 1 2\n", "a.ply"),
                  SceneError);
}
