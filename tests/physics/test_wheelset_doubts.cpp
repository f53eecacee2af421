// Where the models of a wheelset in motion do not hold.
#include <sstream>

#include "engine/units/random.h"
#include "scenes/railway/rolling.h"
#include "tests/support/catch.h"
#include "tests/support/wheelset_case.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// What its models say against themselves in 0.02 s.
std::string reasons(const char* wheel, const std::string& normal, const std::string& tangential, double start) {
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
}

/// X of `key = "X"` in a text, else as it was.
void follow(const std::string& text, const std::string& key, std::string& value) {
  const std::string before = key + " = \"";
  if (const auto at = text.find(before); at != std::string::npos)
    value = text.substr(at + before.size(), text.find('"', at + before.size()) - at - before.size());
}

}  // namespace

TEST_CASE("a run says where its models of wheel on rail do not hold", "[physics][wheelset][warnings]") {
  // what a patch case would call not valid: spin by a law that has none, an ellipse where the curvature changes, stick
  // by a law of full slip; the defaults hold on the tread
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

TEST_CASE("the model that a doubt names has no such doubt", "[physics][wheelset][warnings]") {
  Random random(63, 0);
  int named = 0;
  for (const char* normal : {"hertz", "multi-hertz", "semi-hertz"})
    for (const char* tangential : {"vermeulen-johnson", "coulomb", "kalker-linear", "shen-hedrick-elkins"}) {
      const char* wheel = random.uniform(0.0, 1.0) < 0.5 ? "name = \"cone\"" : "name = \"s1002\"";
      const double start = random.uniform(-2e-3, 2e-3);
      std::string force = normal, creep = tangential, line;
      std::istringstream lines(reasons(wheel, force, creep, start));
      std::vector<std::string> doubts;
      while (std::getline(lines, line)) {
        const std::string remedy = model_remedy(line);
        if (remedy.empty()) continue;
        follow(remedy, "normal", force);
        follow(remedy, "tangential", creep);
        doubts.push_back(line.substr(0, 15));
      }
      INFO(wheel << ", " << start << ": " << normal << " to " << force << ", " << tangential << " to " << creep);
      const std::string left = reasons(wheel, force, creep, start);
      for (const std::string& doubt : doubts) CHECK(left.find(doubt) == std::string::npos);
      named += !doubts.empty();
    }
  CHECK(named >= 8);
}
