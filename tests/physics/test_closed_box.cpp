// A closed box keeps its bodies. The walls are triangles, the bodies hulls, and the box is shaken. Near the edge where
// two walls meet a hull once lost all its contacts, each wall leaving it to the other, and fell through.
#include <fstream>

#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// A box of 12 triangles about the origin with edges of twice `half` [m].
std::string box_file(double half) {
  const std::string path = EPAFI_BINARY_DIR "/closed_box.obj";
  std::ofstream out(path);
  for (int k = 0; k < 8; ++k)
    out << "v " << (k & 1 ? half : -half) << " " << (k & 2 ? half : -half) << " " << (k & 4 ? half : -half) << "\n";
  out << "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  return path;
}

struct Shaking {
  double seconds, time_step, until, restitution;
};

/// n hulls of 10 mm in a box that they fill to an eighth, shaken by 5 mm at 5 Hz along the diagonal.
void check_box(int n, const Shaking& shaking) {
  const double edge = 0.01 * std::cbrt(static_cast<double>(n) * 0.5 / 0.12);
  const std::string size = std::to_string(0.5 * edge - 0.006);
  SceneRun run = start_text(
      "run = { duration = " + std::to_string(shaking.seconds) + ", time_step = " + std::to_string(shaking.time_step) +
      R"(, output_interval = 1.0, seed = 3 }
world = { gravity = [0, 0, -9.81] }
material.stone = { density = 2500.0, youngs_modulus = "20 MPa", poissons_ratio = 0.3 }
contact = { method = "nonsmooth", restitution = )" +
      std::to_string(shaking.restitution) + R"(, friction = 0.4, nonsmooth = { solver = "pgs", iterations = 10 } }
[shape.stone]
polyhedron = { random = { vertices = 14, seed = 3 } }
scale_to_diameter = 0.01
[[body]]
name = "box"
shape = { mesh = { file = ")" +
      box_file(0.5 * edge) + R"(" } }
material = "stone"
motion = { oscillation = { direction = [1, 0.7, 0.5], amplitude = 0.005, frequency = 5.0 }, until = )" +
      std::to_string(shaking.until) + R"( }
[[fill]]
name = "stones"
shape = ["stone"]
material = "stone"
count = )" +
      std::to_string(n) +
      R"(
method = "lattice"
region = { box = { min = [-)" +
      size + ", -" + size + ", -" + size + "], max = [" + size + ", " + size + ", " + size + R"(] } }
)");
  run.advance_to(0);
  INFO(run.failure);
  CHECK(run.failure.empty());
  const World& w = run.simulation().world;
  REQUIRE(w.size() == static_cast<std::size_t>(n) + 1);
  const Slot box = w.slot_of(BodyId{0});
  std::size_t outside = 0;
  for (Slot s = 0; s < w.size(); ++s) outside += (w.position[s] - w.position[box]).cwiseAbs().maxCoeff() > 0.5 * edge;
  CHECK(outside == 0);
}

}  // namespace

TEST_CASE("a shaken closed box of triangles loses none of its hulls", "[physics][closed-box][long]") {
  check_box(60, {2.0, 1e-3, 2.0, 0.3});
}

TEST_CASE("a shaken closed box of triangles loses none of 10000 hulls", "[.night][closed-box]") {
  check_box(10000, {2.0, 1e-3, 2.0, 0.3});
}

/// At 10 ms a body is lost in step 13: 1.3 m/s take it through a wall of triangles without `continuous`, and the run
/// says so.
TEST_CASE("a closed box loses none of 10000 hulls in 100 s", "[.night][closed-box]") {
  check_box(10000, {100.0, 4e-3, 10.0, 0.0});
}
