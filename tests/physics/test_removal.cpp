// Bodies that are taken out far away leave the rest as it is, bit for bit: friction springs and dampers go on as if
// nothing had happened, though contacts are evaluated once more to learn what energy has gone.
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// A bed that settles, beside 40 spheres that fall by themselves and, where `removed`, go one by one.
SceneRun bed_beside_a_rain(const std::string& contact, bool removed) {
  const std::string rain = R"({ repeat = 40, material = "bead", shape = "bead", position = [1, "= 0.01 * i", 1])" +
                           std::string(removed ? R"(, remove_at = "= 0.03 + i * 7e-4" })" : " }");
  const std::string text = R"(
run = { duration = 0.06, time_step = 2e-5 }
world = { gravity = [0.5, 0, -9.81] }
material.bead = { density = 2500.0, youngs_modulus = "5 MPa", poissons_ratio = 0.3 }
shape.bead = { sphere = { radius = "2.5 mm" } }
body = [ { fixed = true, material = "bead", shape = { half_space = { normal = [0, 0, 1] } } }, )" +
                           rain + R"( ]
contact = { method = "smooth", restitution = 0.6, friction = 0.5, )" +
                           contact + R"( }
[[fill]]
shape = "bead"
material = "bead"
count = 150
region = { box = { min = [-0.015, -0.015, 0.0025], max = [0.015, 0.015, 0.2] } }
)";
  SceneRun run = start_text(text);
  run.advance_to(0);
  return run;
}

double largest_difference(SceneRun& x, SceneRun& y) {
  World &a = x.simulation().world, &b = y.simulation().world;
  double worst = 0.0;
  for (const BodyId id : a.id) {
    const Slot s = a.slot_of(id), t = b.slot_of(id);
    worst = std::max({worst, (a.position[s] - b.position[t]).norm(), (a.velocity[s] - b.velocity[t]).norm(),
                      (a.angular_velocity[s] - b.angular_velocity[t]).norm()});
  }
  return worst;
}

}  // namespace

TEST_CASE("removing bodies far away does not change a bit of the others", "[physics][removal]") {
  const std::string contact = GENERATE(
      R"(smooth = { law = "hertz-mindlin" })",                              // the fused loop
      R"(smooth = { law = "hertz", tangential = "mindlin-deresiewicz" })",  // a long history
      R"(rolling_friction = 0.1, smooth = { law = "linear", stiffness = 4000.0, rolling = "spring" })");  // rolling
                                                                                                          // springs
  SceneRun with = bed_beside_a_rain(contact, true), without = bed_beside_a_rain(contact, false);
  REQUIRE(with.failure.empty());
  CHECK(with.simulation().bodies_removed() == 40);
  CHECK(with.simulation().work.report.touching > 50);
  CHECK(largest_difference(with, without) == 0.0);
  CHECK(with.energy_error() < 1e-2);
}
