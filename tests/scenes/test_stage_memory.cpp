// What contacts remember goes on where friction or rolling friction begins or ends, whatever the law and the loop.
#include <fstream>
#include <random>

#include "scenes/session.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/support/scene_text.h"
#include "tests/viz_export/temporary_folder.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

/// Balls that fall on a floor beside each other, and a standing capsule outside the loop of spheres.
std::string two_acts(int balls, const std::string& law, const std::string& before, const std::string& after) {
  return "[run]\noutput_interval = 0.01\n[world]\ngravity = [1.0, 0, -9.81]\n"
         "[material.m]\ndensity = 2500\nyoungs_modulus = \"5 MPa\"\npoissons_ratio = 0.3\n"
         "[contact]\nmethod = \"smooth\"\nrestitution = 0.5\n" +
         before + "[contact.smooth]\nlaw = \"" + law + "\"\n" + experiments::half_space_floor("m") +
         "[[body]]\nname = \"ball\"\nrepeat = " + std::to_string(balls) +
         "\nshape = { sphere = { radius = 0.01 } }\nmaterial = \"m\"\n"
         "position = [\"= 0.0199*(i - 12*floor(i/12))\", \"= 0.0199*floor(i/12)\", 0.0099]\nvelocity = [0.1, 0, 0]\n"
         "[[body]]\nname = \"rod\"\nshape = { capsule = { radius = 0.01, length = 0.02 } }\nmaterial = \"m\"\n"
         "position = [-0.1, 0, 0.0199]\n"
         "[[stage]]\nname = \"a\"\nduration = 0.02\n[[stage]]\nname = \"b\"\nduration = 0.02\n" +
         after;
}

auto outcome(const fs::path& scene, const fs::path& out) {
  ReadResult read = read_scene(scene.string(), {}, full_registry());
  for (const Problem& p : read.problems) UNSCOPED_INFO(p.to_string());
  REQUIRE(read.scene);
  Session session(assemble(std::move(*read.scene)), {}, out);
  REQUIRE(session.run({}, true) == Ending::completed);
  return session.summary();
}

}  // namespace

TEST_CASE("contacts keep what both laws remember where a stage adds or ends friction or rolling", "[scenes][stages]") {
  std::mt19937 random(91);
  const std::vector<std::string> laws = {"hertz", "linear\"\nstiffness = 1e4\n#\"",
                                         "hunt-crossley\"\nreference_speed = 0.5\n#\"",
                                         "jkr\"\nwork_of_adhesion = 0.05\n#\"", "walton-braun\"\nstiffness = 1e4\n#\""};
  const char* const values[] = {"0.0", "0.3", "0.5"};
  const auto keys = [](const std::string& prefix, const char* friction, const char* rolling) {
    return prefix + "friction = " + friction + "\n" + prefix + "rolling_friction = " + rolling + "\n";
  };
  for (int draw = 0; draw < 14; ++draw) {
    const std::string& law = laws[random() % laws.size()];
    const char* friction[] = {values[random() % 3], values[random() % 3]};
    const char* rolling[2];
    for (int k = 0; k < 2; ++k) rolling[k] = friction[k] == values[0] ? values[0] : values[random() % 3];
    const TemporaryFolder folder;
    const std::string text = two_acts(draw % 2 == 0 ? 3 : 120, law, keys("", friction[0], rolling[0]),
                                      keys("contact.", friction[1], rolling[1]));
    INFO(text);
    std::ofstream(folder / "s.toml") << text;
    const auto summary = outcome(folder / "s.toml", folder / "out");
    REQUIRE(summary.energy);
    CHECK(std::abs(summary.energy->relative_error) < 0.02);
  }
}
