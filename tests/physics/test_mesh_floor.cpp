// A sphere that slides, comes to roll and rolls over the edges and vertices of triangulated floors moves as on the
// plane: no kick at any resolution, with either method of contact.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"
#include "tests/support/scene_run.h"

using namespace epafi;

namespace {

/// Square of edge 4 m at z = 0 in cells x cells squares, each cut along a diagonal; inner vertices shaken by `shake`
/// cells.
void write_floor(const std::string& path, int cells, double shake) {
  Random random(201, static_cast<std::uint64_t>(cells));
  std::ofstream out(path);
  out.precision(17);
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      const bool inner = i > 0 && j > 0 && i < cells && j < cells;
      const double h = 4.0 / cells, dx = inner ? random.uniform(-shake, shake) : 0.0,
                   dy = inner ? random.uniform(-shake, shake) : 0.0;
      out << "v " << -2 + h * (i + dx) << ' ' << -2 + h * (j + dy) << " 0\n";
    }
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const int a = 1 + i + j * (cells + 1), b = a + 1, c = a + cells + 1, d = c + 1;
      if ((i + j) % 2)
        out << "f " << a << ' ' << b << ' ' << d << "\nf " << a << ' ' << d << ' ' << c << "\n";
      else
        out << "f " << a << ' ' << b << ' ' << c << "\nf " << b << ' ' << d << ' ' << c << "\n";
    }
}

std::string write_scene(const std::string& name, const std::string& floor, bool smooth) {
  const std::string path =
      std::string(EPAFI_BINARY_DIR) + "/mesh_floor_" + name + (smooth ? "_smooth" : "_nonsmooth") + ".toml";
  std::ofstream out(path);
  out << "title = \"sphere on a floor\"\n[run]\nduration = 0.6\ntime_step = " << (smooth ? "1e-4" : "1e-3") << "\n"
      << "[world]\ngravity = [0, 0, -9.81]\n[material.rubber]\ndensity = 1000\nyoungs_modulus = 1e7\npoissons_ratio = "
         "0.3\n"
      << "[contact]\nmethod = \"" << (smooth ? "smooth" : "nonsmooth") << "\"\nrestitution = 0.3\nfriction = 0.4\n"
      << "[[body]]\nname = \"floor\"\nshape = { " << floor << " }\nmaterial = \"rubber\"\nfixed = true\n"
      << "[[body]]\nname = \"ball\"\nshape = { sphere = { radius = 0.05 } }\nmaterial = \"rubber\"\nposition = [-0.9, "
         "-0.35, 0.05]\n"
      << "velocity = [3.0, 0.9, 0]\n";
  return path;
}

struct Course {
  std::vector<Vec3> velocity, angular_velocity, position;
};

Course run(const std::string& scene) {
  auto sim = experiments::prepare_scene(scene, {});
  sim.simulation().start();
  Course track;
  const World& world = sim.simulation().world;
  while (sim.simulation().steps() < sim.assembly->steps) {
    REQUIRE_FALSE(sim.simulation().advance().has_value());
    const Slot s = world.slot_of(BodyId{1});
    track.velocity.push_back(world.velocity[s]);
    track.angular_velocity.push_back(world.angular_velocity[s]);
    track.position.push_back(world.position[s]);
  }
  return track;
}

}  // namespace

TEST_CASE("a sphere slides and rolls over meshes of any resolution as on the plane, to 1e-9", "[physics][mesh][long]") {
  for (const bool smooth : {true, false}) {
    const Course plane = run(write_scene("plane", "half_space = { normal = [0, 0, 1] }", smooth));
    const Vec3 v = plane.velocity.back(), w = plane.angular_velocity.back();
    CHECK(v.x() == Approx(0.05 * w.y()).epsilon(2e-2));  // it has come to roll
    CHECK(plane.position.back().x() > 0.4);
    for (const int cells : {1, 2, 8, 40, 200}) {  // edges of 80 to 0.4 radii
      const std::string file = "mesh_floor_" + std::to_string(cells) + ".obj";
      write_floor(std::string(EPAFI_BINARY_DIR) + "/" + file, cells, 0.3);
      const Course mesh = run(write_scene(std::to_string(cells), "mesh = { file = \"" + file + "\" }", smooth));
      REQUIRE(mesh.velocity.size() == plane.velocity.size());
      double kick = 0.0;
      for (std::size_t k = 0; k < plane.velocity.size(); ++k) {
        kick = std::max(kick, (mesh.velocity[k] - plane.velocity[k]).norm());
        kick = std::max(kick, 0.05 * (mesh.angular_velocity[k] - plane.angular_velocity[k]).norm());
      }
      INFO((smooth ? "smooth" : "non-smooth")
           << ", " << cells << " cells: largest difference of velocity " << kick << " m/s");
      CHECK(kick < 1e-9);
    }
  }
}

TEST_CASE("round bodies press a mesh as they press the plane", "[physics][mesh]") {
  const std::string floor = std::string(EPAFI_BINARY_DIR) + "/mesh_floor_round.obj";
  write_floor(floor, 3, 0.2);
  const std::string walls[] = {"{ mesh = { file = \"" + floor + "\" } }", "{ half_space = { normal = [0, 0, 1] } }"};
  Random random(211, 0);
  for (int draw = 0; draw < 20; ++draw) {
    const Vec3 axes(random.uniform(0.05, 0.2), random.uniform(0.05, 0.2), random.uniform(0.05, 0.2));
    const Quat q = testing::random_turn(random);
    const double height = (axes.asDiagonal() * (q.conjugate() * Vec3::UnitZ())).norm();  // of an ellipsoid
    const std::string body = fmt::format(
        "[[body]]\nmaterial = \"m\"\nshape = {{ ellipsoid = {{ semi_axes = [{:.17g}, {:.17g}, {:.17g}] }} }}\n"
        "position = [0.31, 0.17, {:.17g}]\norientation = [{:.17g}, {:.17g}, {:.17g}, {:.17g}]\n",
        axes[0], axes[1], axes[2], 0.999 * height, q.w(), q.x(), q.y(), q.z());
    double force[2];
    for (int k = 0; k < 2; ++k) {
      auto run = experiments::start_text(
          "run = { duration = 1e-6, time_step = 1e-6 }\n"
          "material.m = { density = 1000, youngs_modulus = 1e7, poissons_ratio = 0.3 }\n"
          "contact = { method = \"smooth\", restitution = 0.5, friction = 0.0 }\n[[body]]\nmaterial = \"m\"\nfixed = "
          "true\nshape = " +
          walls[k] + "\n" + body);
      force[k] = run.simulation().world.force[run.simulation().world.slot_of(BodyId{1})].z();
    }
    INFO("draw " << draw);
    CHECK(force[1] > 0.0);
    CHECK(force[0] == Approx(force[1]).epsilon(1e-9));
  }
}
