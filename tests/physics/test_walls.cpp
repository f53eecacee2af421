// Walls of every kind obey the same law: half-space, box and a box of 1200 triangles turn a sphere back alike.
#include <cmath>
#include <fstream>
#include <numbers>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/viz_export/temporary_folder.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// A box of half extents (0.5, 0.5, 0.1), each face in 10 x 10 squares of two triangles, as OBJ.
void write_mesh_box(const std::string& path) {
  std::ofstream out(path);
  out.precision(17);
  std::size_t vertices = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (int side : {-1, 1}) {
      const int p = (axis + 1) % 3, q = (axis + 2) % 3;
      const Vec3 half(0.5, 0.5, 0.1);
      for (int i = 0; i <= 10; ++i)
        for (int j = 0; j <= 10; ++j) {
          Vec3 x = Vec3::Zero();
          x[axis] = side * half[axis];
          x[p] = (i / 5.0 - 1) * half[p];
          x[q] = (j / 5.0 - 1) * half[q];
          out << "v " << x.x() << " " << x.y() << " " << x.z() << "\n";
        }
      for (int i = 0; i < 10; ++i)
        for (int j = 0; j < 10; ++j) {
          const std::size_t a = vertices + 1 + static_cast<std::size_t>(11 * i + j), b = a + 11, c = b + 1, d = a + 1;
          if (side > 0)
            out << "f " << a << " " << b << " " << c << "\nf " << a << " " << c << " " << d << "\n";
          else
            out << "f " << a << " " << c << " " << b << "\nf " << a << " " << d << " " << c << "\n";
        }
      vertices += 121;
    }
}

/// The plane z = 0.1 over [-0.2, 0.3] x [-0.1, 0.2] in cells of two triangles; irregular: nodes shifted by up to 0.3
/// cells, diagonals either way.
void write_floor(const std::string& path, double cell, bool irregular) {
  std::ofstream out(path);
  out.precision(17);
  Random random(3, 0);
  const auto nx = static_cast<std::size_t>(std::lround(0.5 / cell)),
             ny = static_cast<std::size_t>(std::max(1L, std::lround(0.3 / cell)));
  const double hx = 0.5 / static_cast<double>(nx), hy = 0.3 / static_cast<double>(ny);
  for (std::size_t j = 0; j <= ny; ++j)
    for (std::size_t i = 0; i <= nx; ++i) {
      const bool inside = irregular && i > 0 && j > 0 && i < nx && j < ny;
      const double sx = inside ? random.uniform(-0.3, 0.3) : 0.0, sy = inside ? random.uniform(-0.3, 0.3) : 0.0;
      out << "v " << -0.2 + hx * (static_cast<double>(i) + sx) << " " << -0.1 + hy * (static_cast<double>(j) + sy)
          << " 0.1\n";
    }
  for (std::size_t j = 0; j < ny; ++j)
    for (std::size_t i = 0; i < nx; ++i) {
      const std::size_t a = j * (nx + 1) + i + 1, b = a + 1, c = b + nx + 1, d = c - 1;
      if (irregular && random.uniform() < 0.5)
        out << "f " << a << " " << b << " " << d << "\nf " << b << " " << c << " " << d << "\n";
      else
        out << "f " << a << " " << b << " " << c << "\nf " << a << " " << c << " " << d << "\n";
    }
}

struct Flight {
  Vec3 position, velocity, spin;
};

Flight fly(const std::string& folder, const std::string& wall, const std::string& body, double duration,
           double restitution) {
  std::ofstream(folder + "/scene.toml")
      << "title = \"wall\"\nrun = { duration = " << duration << ", time_step = 2e-6, output_interval = 0.01 }\n"
      << "material.m = { density = 2500.0, youngs_modulus = \"1 GPa\", poissons_ratio = 0.25 }\n"
      << "world = { gravity = [0, 0, -9.81] }\n"
      << "[contact]\nmethod = \"smooth\"\nrestitution = " << restitution
      << "\nfriction = 0.4\nsmooth = { law = \"hertz-mindlin\" }\n"
      << "[[body]]\nname = \"wall\"\nshape = " << wall << "\nmaterial = \"m\"\nfixed = true\n"
      << "[[body]]\nname = \"ball\"\nshape = { sphere = { radius = 0.01 } }\nmaterial = \"m\"\n"
      << body;
  SceneRun run = prepare_scene(folder + "/scene.toml", {});
  run.simulation().start();
  run.advance_to(0);
  REQUIRE(run.failure.empty());
  const World& w = run.simulation().world;
  const Slot s = w.slot_of(Assembly::body_id(1));
  return {w.position[s], w.velocity[s], w.angular_velocity[s]};
}

const std::string half_space = "{ half_space = { normal = [0, 0, 1] } }\nposition = [0, 0, 0.1]";
const std::string box = "{ box = { size = [1, 1, 0.2] } }";
const std::string mesh = "{ mesh = { file = \"box.obj\" } }";

/// Of the ball of fly() at its static overlap: N = m g, delta = (N / (4/3 E* sqrt(R)))^(2/3), E* = 1e9/2/(1 - 1/16).
std::string resting_height() {
  const double weight = 4.0 / 3.0 * std::numbers::pi * 1e-6 * 2500 * 9.81,
               delta = std::pow(weight / (4.0 / 3.0 * 0.5e9 / 0.9375 * 0.1), 2.0 / 3.0);
  char height[40];
  std::snprintf(height, sizeof height, "%.17g", 0.11 - delta);
  return height;
}

}  // namespace

TEST_CASE("mesh, box and half-space walls turn a sphere back alike, on faces, edges and corners of triangles",
          "[physics][walls]") {
  const TemporaryFolder folder;
  const std::string path = folder.path().string();
  write_mesh_box(path + "/box.obj");
  // on a face, on an edge shared by two triangles of one square, on an edge between squares, on a corner of eight
  // triangles
  for (const std::string place : {"0.033, 0.021", "0.03, 0.03", "0.1, 0.037", "0.1, 0.1"}) {
    const std::string body =
        "position = [" + place + ", 0.1101]\nvelocity = [0.7, 0.2, -1]\nangular_velocity = [3, -5, 2]\n";
    const Flight plain = fly(path, half_space, body, 2e-3, 0.8);
    CHECK(plain.velocity.z() > 0.7);
    for (const std::string& wall : {box, mesh}) {
      const Flight other = fly(path, wall, body, 2e-3, 0.8);
      INFO(place << " " << wall);
      CHECK((other.velocity - plain.velocity).norm() < 1e-9);
      CHECK((other.spin - plain.spin).norm() * 0.01 < 1e-9);
    }
  }
}

TEST_CASE("a sphere rolls and slides across the edges of triangles without a kick", "[physics][walls][long]") {
  const TemporaryFolder folder;
  const std::string path = folder.path().string();
  write_mesh_box(path + "/box.obj");
  const std::string height = resting_height();
  for (const std::string spin : {"[0, 100, 0]", "[0, 0, 0]"}) {  // rolling at 1 m/s, and sliding
    const std::string body = std::string("position = [-0.11, 0.0123, ") + height +
                             "]\nvelocity = [1, 0.3, 0]\nangular_velocity = " + spin + "\n";
    const Flight plain = fly(path, half_space, body, 0.25, 0.5);
    for (const std::string& wall : {box, mesh}) {
      const Flight other = fly(path, wall, body, 0.25, 0.5);
      INFO(spin << " " << wall);
      CHECK((other.velocity - plain.velocity).norm() < 1e-9);
      CHECK(std::abs(other.velocity.z()) < 1e-9);
    }
  }
}

TEST_CASE("whatever the triangles of a floor, a sphere rolls and slides over them as over the plane",
          "[physics][walls][long]") {
  const TemporaryFolder folder;
  const std::string path = folder.path().string(), height = resting_height();
  for (const std::string spin : {"[0, 100, 0]", "[0, 0, 0]"})
    // obliquely over edges, and along a line of the regular lattices: over vertices and along edges
    for (const bool oblique : {true, false}) {
      const std::string body = std::string("position = [-0.11, ") + (oblique ? "0.0123, " : "0.1, ") + height +
                               "]\nvelocity = [1, " + (oblique ? "0.3" : "0") + ", 0]\nangular_velocity = " + spin +
                               "\n";
      const Flight plain = fly(path, half_space, body, 0.1, 0.5);
      for (const double cell : {0.5, 0.1, 0.02, 0.005, 0.0025})  // 50 radii of the ball to a quarter of one
        for (const bool irregular : {false, true}) {
          write_floor(path + "/floor.obj", cell, irregular);
          const Flight other = fly(path, "{ mesh = { file = \"floor.obj\" } }", body, 0.1, 0.5);
          INFO(spin << (oblique ? " oblique" : " along a line") << " cell " << cell << (irregular ? " irregular" : ""));
          CHECK((other.velocity - plain.velocity).norm() < 1e-9);
          CHECK((other.spin - plain.spin).norm() * 0.01 < 1e-9);
          CHECK(std::abs(other.velocity.z()) < 1e-9);
          CHECK((other.position - plain.position).norm() < 1e-10);
        }
    }
}
