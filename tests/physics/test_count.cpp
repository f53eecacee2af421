// What a count says of bodies whose places are known.
#include "engine/threads/parallel.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;

TEST_CASE("bodies are counted in a region, on a side of a plane, and by group", "[physics][measures]") {
  // 5 x 4 x 3 balls of 1 cm at whole decimetres, and two more of twice the size by another name, in the group too
  auto run = experiments::start_text(R"(
run = { duration = 1e-4, time_step = 1e-4, output_interval = 1e-4 }
material.m = { density = 2000.0, youngs_modulus = 1e7, poissons_ratio = 0.3 }
contact = { method = "smooth", restitution = 0.5, friction = 0.5 }
shape.ball = { sphere = { radius = 0.005 } }
[[body]]
name = "grid"
group = "all"
repeat = [5, 4, 3]
shape = "ball"
material = "m"
position = ["= 0.1*i", "= 0.1*j", "= 0.1*k"]
[[body]]
name = "large"
group = "all"
repeat = 2
shape = { sphere = { radius = 0.01 } }
material = "m"
position = ["= -1 - i", 0, 0]
[[measure]]
name = "box"
kind = "count"
body = "grid"
region = { box = { min = [0.05, -1, -1], max = [0.35, 1, 0.15] } }
[[measure]]
name = "side"
kind = "count"
plane = { point = [0.25, 0, 0], normal = [-2, 0, 0] }
[[measure]]
name = "group"
kind = "count"
group = "all"
)");
  run.advance_to(0);
  const double ball = 4.0 / 3 * 3.14159265358979324 * 1.25e-7;
  CHECK(run.last("box", "number") == 3 * 4 * 2);
  CHECK(run.last("side", "number") == 3 * 4 * 3 + 2);
  CHECK(run.last("group", "number") == 62);
  CHECK(run.last("group", "volume") == Approx((60 + 2 * 8) * ball).epsilon(1e-12));
  CHECK(run.last("group", "mass") == Approx((60 + 2 * 8) * ball * 2000).epsilon(1e-12));
}
