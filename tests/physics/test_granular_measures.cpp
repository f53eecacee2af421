// Hysteresis loop, force chains, angle of repose, mixing and wall forces of arrangements whose answers are known.
#include <cmath>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

std::string measured_head(double duration, double restitution, const std::string& step = "\"auto\"") {
  return "title = \"m\"\nrun = { duration = " + std::to_string(duration) + ", time_step = " + step +
         ", output_interval = 0.01 }\n" +
         "material.m = { density = 2500.0, youngs_modulus = \"10 MPa\", poissons_ratio = 0.25 }\n" +
         "contact = { method = \"smooth\", restitution = " + std::to_string(restitution) +
         ", friction = 0.0, smooth = { law = \"hertz\" } }\nshape.ball = { sphere = { radius = 0.01 } }\n";
}

}  // namespace

TEST_CASE("the loop of one contact encloses the energy that it loses", "[physics][measures]") {
  for (double e : {0.3, 0.8, 1.0}) {
    auto run = start_text(measured_head(0.004, e, "1e-6") + R"(
[[body]]
name = "a"
shape = "ball"
material = "m"
velocity = [2, 0, 0]
[[body]]
name = "b"
shape = "ball"
material = "m"
position = [0.0201, 0, 0]
[[measure]]
name = "loop"
kind = "hysteresis"
between = ["a", "b"]
)");
    run.advance_to(0);
    const double mass = 2500 * 4.0 / 3.0 * 3.14159265358979323846 * 1e-6, energy = 0.25 * mass * 4;
    CHECK(run.last("loop", "overlap") == 0.0);
    CHECK(run.largest("loop", "normal_force") > 1.0);
    // what the trapezoid leaves out is the jump of the damper in the first step
    CHECK(run.last("loop", "loop_area") == Approx(energy * (1 - e * e)).margin(1e-3 * energy));
  }
}

TEST_CASE("a loaded column is one force chain, what lies beside it is none", "[physics][measures]") {
  // read before the column, which nothing holds aside, gives way
  auto run = start_text(measured_head(0.08, 0.1) + R"(world = { gravity = [0, 0, -10] }
[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "m"
fixed = true
[[body]]
name = "column"
repeat = 5
shape = "ball"
material = "m"
position = [0, 0, "= 0.01 + 0.02*i"]
[[body]]
name = "weight"
shape = "ball"
material = "m"
position = [0, 0, 0.11]
force = [0, 0, -5]
[[body]]
name = "beside"
repeat = 6
shape = "ball"
material = "m"
position = ["= 0.1 + 0.1*i", 0, 0.01]
[[measure]]
name = "chains"
kind = "force_chains"
[[measure]]
name = "floor"
kind = "force"
body = "floor"
[[measure]]
name = "all"
kind = "force"
body = "column"
)");
  run.advance_to(0);
  CHECK(run.last("chains", "chains") == 1);
  CHECK(run.last("chains", "longest") == 6);
  CHECK(run.last("chains", "share") == Approx(0.5));
  CHECK(run.last("chains", "strong") == Approx(0.5));  // the six contacts of the column of twelve
  const double weight = 2500 * 4.0 / 3.0 * 3.14159265358979323846 * 1e-6 * 10;
  double lift = 0.0;
  const World& w = run.simulation().world;
  for (Slot s = 0; s < w.size(); ++s) lift += w.is_movable(s) ? w.force[s].z() : 0.0;
  CHECK(run.last("floor", "z") == Approx(-lift).epsilon(1e-12));   // action and reaction
  CHECK(lift == Approx(12 * weight + 5).epsilon(1e-2));            // 0.08 s after the start it still swings up and down
  CHECK(run.last("all", "z") == Approx(5 * weight).margin(0.05));  // carries itself: contacts inside cancel
}

TEST_CASE("cones and ridges have the slope they were built with", "[physics][measures]") {
  auto run = start_text(measured_head(1e-5, 0.5, "1e-5") + R"X(
[[body]]
name = "cone"
repeat = [20, 8]
shape = "ball"
material = "m"
position = ["= 1 + 0.05*(i + 1)*cos(pi/4*j)", "= 2 + 0.05*(i + 1)*sin(pi/4*j)", "= 3 - 0.05*(i + 1)*tan(pi/6)"]
[[measure]]
name = "heap"
kind = "angle_of_repose"
centre = [1, 2, 2]
bins = 20
[[measure]]
name = "ridge"
kind = "angle_of_repose"
centre = [1, 2, 2]
axis = "x"
bins = 10
)X");
  run.advance_to(0);
  CHECK(run.last("heap", "angle") == Approx(30.0).epsilon(1e-9));
  CHECK(run.last("heap", "reach") == Approx(1.0));
  CHECK(run.last("heap", "height") == Approx(1 - 0.05 * std::tan(3.14159265358979 / 6) + 0.01));
  CHECK(run.last("ridge", "angle") == Approx(30.0).epsilon(1e-9));  // the tops are those on the axis of x
}

TEST_CASE("what has rolled off a heap changes neither its slope nor its reach", "[physics][measures]") {
  // a full cone: shells of spacing 0.05 about the axis, 33 balls a turn at the foot, strays on the ground far away
  const auto heap = [](double degrees, int strays) {
    const std::string slope = std::to_string(std::tan(degrees * 3.14159265358979 / 180));
    auto run = start_text(measured_head(1e-5, 0.5, "1e-5") + R"X(
[[body]]
name = "cone"
repeat = [20, 40]
shape = "ball"
material = "m"
position = ["= 0.05*(i + 1)*cos(pi/20*j)", "= 0.05*(i + 1)*sin(pi/20*j)", "= (1.05 - 0.05*(i + 1))*)X" +
                          slope + R"X("]
[[body]]
name = "stray"
repeat = )X" + std::to_string(strays) +
                          R"X(
shape = "ball"
material = "m"
position = ["= 1.1 + 0.2*i", "= 0.3*i", 0]
[[measure]]
name = "heap"
kind = "angle_of_repose"
)X");
    run.advance_to(0);
    return std::pair(run.last("heap", "angle"), run.last("heap", "reach"));
  };
  for (const double degrees : {5.0, 12.0, 25.0, 40.0}) {
    CHECK(heap(degrees, 1).first == Approx(degrees).epsilon(1e-5));
    for (const int strays : {5, 10, 20}) {
      CHECK(heap(degrees, strays).first == Approx(degrees).epsilon(1e-5));
      CHECK(heap(degrees, strays).second == Approx(1.0));
    }
  }
}

namespace {
/// Columns of balls on a square lattice of pitch 1 under a cone, each begun at a random height, and balls that chance
/// has left on the slope.
std::string heap_of_columns(Random& random, double slope, double foot, int left_over) {
  std::string bodies;
  const auto ball = [&](double x, double y, double z) {
    bodies += "[[body]]\nshape = \"grain\"\nmaterial = \"m\"\nposition = [" + std::to_string(x) + ", " +
              std::to_string(y) + ", " + std::to_string(z) + "]\n";
  };
  const int wide = static_cast<int>(foot);
  for (int i = -wide; i <= wide; ++i)
    for (int j = -wide; j <= wide; ++j) {
      const double surface = (foot - std::hypot(i, j)) * slope;
      for (double top = surface - random.uniform(0.0, 1.0); top >= 1.0; top -= 1.0) ball(i, j, top - 0.5);
    }
  for (int k = 0; k < left_over; ++k) {
    const double away = random.uniform(0.1, 0.9) * foot, turn = random.uniform(-3.14, 3.14);
    ball(away * std::cos(turn), away * std::sin(turn), (foot - away) * slope + 1.0);
  }
  return bodies;
}
}  // namespace

TEST_CASE("the slope of a random heap is that of its surface, whatever lies on it by chance", "[physics][measures]") {
  for (std::uint32_t draw = 0; draw < 12; ++draw) {
    Random random(91, draw);
    const double degrees = random.uniform(28.0, 42.0), foot = random.uniform(12.0, 15.0);
    const double slope = std::tan(degrees * 3.14159265358979 / 180);
    auto run = start_text(
        "title = \"h\"\nrun = { duration = 1e-6, time_step = 1e-6 }\n"
        "material.m = { density = 2500.0, youngs_modulus = \"1 MPa\", poissons_ratio = 0.25 }\n"
        "contact = { method = \"smooth\", restitution = 0.5, friction = 0.0 }\n"
        "shape.grain = { sphere = { radius = 0.5 } }\n" +
        heap_of_columns(random, slope, foot, 4) + "[[measure]]\nname = \"heap\"\nkind = \"angle_of_repose\"\n");
    run.advance_to(0);
    INFO("draw " << draw << " at " << degrees << " degrees");
    CHECK(run.last("heap", "angle") == Approx(degrees).margin(2.0));
  }
}

TEST_CASE("Lacey's index is 0 for groups apart and 1 by chance", "[physics][measures]") {
  const auto lacey = [](const std::string& a, const std::string& b) {
    auto run =
        start_text(measured_head(1e-5, 0.5, "1e-5") +
                   "[[body]]\nname = \"a\"\nrepeat = [2, 4, 4]\nshape = \"ball\"\nmaterial = \"m\"\nposition = [" + a +
                   ", \"= 0.1*j + 0.05\", \"= 0.1*k + 0.05\"]\n[[body]]\nname = \"b\"\nrepeat = [2, 4, 4]\nshape = "
                   "\"ball\"\nmaterial = \"m\"\nposition = [" +
                   b +
                   ", \"= 0.1*j + 0.05\", \"= 0.1*k + 0.05\"]\n[[measure]]\nname = \"mix\"\nkind = \"mixing\"\nbetween "
                   "= [\"a\", \"b\"]\ncell = 0.2\n");
    run.advance_to(0);
    CHECK(run.last("mix", "share") == Approx(0.5));
    return run.last("mix", "lacey");
  };
  CHECK(lacey("\"= 0.1*i + 0.05\"", "\"= 0.1*i + 0.25\"") == Approx(0.0).margin(1e-12));
  // four of each in every cell: less variance than chance leaves in cells of 8, p (1 - p)/8
  CHECK(lacey("\"= 0.2*i + 0.05\"", "\"= 0.2*i + 0.15\"") == Approx(8.0 / 7.0));
}
