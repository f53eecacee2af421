// Cases A01 and A02 through the whole engine: scene file, detection, law, scheme, measures (Chung and Ooi 2011).
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi::experiments;

TEST_CASE("two glass spheres meet head-on as Hertz says (A01)", "[physics][impact][A01]") {
  // R* = 5 mm, m* = m/2, E* = E/(2 (1 - nu^2)), v = 20 m/s: delta = (15 m* v^2 / (16 E* sqrt(R*)))^(2/5), F = 4/3 E*
  // sqrt(R*) delta^1.5
  auto run = run_scene("impact/chung_ooi_1.toml");
  CHECK(run.largest("impact", "overlap") == Approx(2.74113e-4).epsilon(1e-3));
  CHECK(run.largest("impact", "normal_force") == Approx(10696.9).epsilon(1e-3));
  CHECK(run.last("rebound", "x") == Approx(10.0).epsilon(1e-3));
}

TEST_CASE("two limestone spheres meet head-on as Hertz says (A01)", "[physics][impact][A01]") {
  auto run = run_scene("impact/chung_ooi_1.toml",
                       {"material.glass.youngs_modulus=20e9", "material.glass.poissons_ratio=0.25",
                        "material.glass.density=2500", "run.time_step=5.42010e-7", "run.duration=1e-4"});
  CHECK(run.largest("impact", "overlap") == Approx(3.68304e-4).epsilon(1e-3));
  CHECK(run.largest("impact", "normal_force") == Approx(7108.24).epsilon(1e-3));
}

TEST_CASE("a sphere meets a rigid plane as Hertz says (A02)", "[physics][impact][A02]") {
  auto aluminium = run_scene("impact/chung_ooi_2.toml");
  CHECK(aluminium.largest("impact", "overlap") == Approx(4.97172e-5).epsilon(1e-3));
  CHECK(aluminium.largest("impact", "normal_force") == Approx(11369.9).epsilon(1e-3));
  CHECK(aluminium.last("rebound", "z") == Approx(0.2).epsilon(1e-3));
  auto magnesium = run_scene("impact/chung_ooi_2.toml",
                             {"material.aluminium.youngs_modulus=40e9", "material.aluminium.poissons_ratio=0.35",
                              "material.aluminium.density=1800"});
  CHECK(magnesium.largest("impact", "overlap") == Approx(5.21233e-5).epsilon(1e-3));
  CHECK(magnesium.largest("impact", "normal_force") == Approx(7232.68).epsilon(1e-3));
}
