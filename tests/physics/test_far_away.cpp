// Case B10: the same scenes at the origin and 1e6 m away along every axis, where positions are known to 1.2e-10 m.
// Detection works with differences of positions, so what differs is what the stored positions lose.
#include <cmath>

#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

SceneRun run_at(double distance, const std::string& scene, const std::vector<std::string>& overrides) {
  SceneRun run = prepare_scene(library(scene), overrides);
  for (Vec3& x : run.simulation().world.position) x += Vec3::Constant(distance);
  run.simulation().start();
  run.advance_to(0);
  CHECK(run.failure.empty());
  return run;
}

constexpr double far_away = 1e6;

}  // namespace

TEST_CASE("a head-on impact far from the origin has its force within 1e-6 (A01, B10)", "[physics][B10]") {
  const std::string scene = "impact/chung_ooi_1.toml";
  const SceneRun here = run_at(0.0, scene, {}), there = run_at(far_away, scene, {});
  const double force = here.largest("impact", "normal_force");
  CHECK(std::abs(there.largest("impact", "normal_force") / force - 1.0) < 1e-6);
  CHECK(std::abs(there.last("rebound", "x") / here.last("rebound", "x") - 1.0) < 1e-6);
}

TEST_CASE("an arch far from the origin stands and falls as at the origin (A31, B10)", "[physics][B10][long]") {
  for (const double share : {1.02, 0.98}) {
    // What falls is followed until its stones strike the floor, at 2.5 s: where they roll to after that hangs on
    // rounding.
    const std::string duration = share > 1.0 ? "run.duration=10" : "run.duration=2.5";
    std::vector<std::string> set{"params.ratio=" + std::to_string(0.10708 * share), duration};
    if (share < 1.0) set.emplace_back("contact.nonsmooth.tolerance=1e-11");  // when it falls hangs on what is left
    const SceneRun here = run_at(0.0, "stability/arch.toml", set), there = run_at(far_away, "stability/arch.toml", set);
    INFO("thickness " << share << " of the least: " << here.largest("drift", "distance") << " and "
                      << there.largest("drift", "distance") << " m");
    if (share > 1.0) {
      CHECK(here.largest("drift", "distance") < 1e-6);
      CHECK(there.largest("drift", "distance") < 1e-6);
    } else {
      CHECK(there.largest("drift", "distance") == Approx(here.largest("drift", "distance")).epsilon(1e-6));
      CHECK(here.largest("drift", "distance") > 1.0);
    }
  }
}

TEST_CASE("a scene far from the origin reports how exact its forces can be (B10)", "[physics][B10]") {
  const auto scene = [](const std::string& x) {
    return "title = \"far\"\nrun = { duration = 1e-4, time_step = 1e-6 }\n"
           "material.glass = { density = 2500, youngs_modulus = 70e9, poissons_ratio = 0.22 }\n"
           "contact = { method = \"smooth\", restitution = 0.5, friction = 0.3, smooth = { law = \"hertz-mindlin\" } "
           "}\n"
           "[[body]]\nname = \"ball\"\nshape = { sphere = { radius = 5e-3 } }\nmaterial = \"glass\"\nposition = [" +
           x + ", 0, 0]\n";
  };
  CHECK(start_text(scene("1.0")).assembly->warnings.empty());
  const SceneRun far = start_text(scene("1e6"));
  REQUIRE(far.assembly->warnings.size() == 1);
  CHECK_THAT(far.assembly->warnings[0].text, Catch::Contains("1e+06 m from the origin"));
  CHECK_THAT(far.assembly->warnings[0].text, Catch::Contains("known to 1.2e-10 m: 2e-08 of the smallest radius"));
}
