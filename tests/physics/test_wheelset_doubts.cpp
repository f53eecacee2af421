// Where the models of a wheelset in motion do not hold.
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/wheelset_case.h"

using namespace epafi;
using namespace epafi::experiments;

TEST_CASE("a run says where its models of wheel on rail do not hold", "[physics][wheelset][warnings]") {
  // what a patch case would call not valid: spin by a law that has none, an ellipse where the curvature changes, stick
  // by a law of full slip; the defaults hold on the tread
  const auto reasons = [](const char* wheel, const char* normal, const char* tangential, double start) {
    WheelsetCase c{wheel, normal, tangential};
    c.start = start;
    c.duration = 0.02;
    SceneRun run = start_text(text_of(c));
    std::string all;
    while (run.simulation().steps() < run.assembly->steps) {
      REQUIRE_FALSE(run.simulation().advance());
      for (const ModelDoubt& doubt : run.simulation().work.report.doubts) all += doubt.reason + "\n";
    }
    return all;
  };
  const char *cone = "name = \"cone\"", *s1002 = "name = \"s1002\"";
  CHECK_THAT(reasons(cone, "hertz", "vermeulen-johnson", 1e-3), Catch::Contains("spin, which the law does not know"));
  CHECK_THAT(reasons(cone, "hertz", "coulomb", 1e-3), Catch::Contains("part of the patch sticks"));
  CHECK_THAT(reasons(s1002, "hertz", "fastsim", 5e-4), Catch::Contains("the curvature changes over the patch"));
  Random random(61, 0);
  for (int draw = 0; draw < 4; ++draw) {
    const double start = random.uniform(-3e-3, 3e-3);
    INFO("start " << start);
    CHECK(reasons(s1002, "semi-hertz", "fastsim", start).empty());
  }
}
