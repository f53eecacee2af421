// A measure says the same whether it is alone or beside others: those that look at contacts ask for them themselves,
// where the loop over spheres writes none out.
#include <cmath>
#include <map>

#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/session.h"
#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"

using namespace epafi;

namespace {

const std::string scene = R"TOML(
run = { duration = 0.06, time_step = 5e-5, output_interval = 0.02 }
world = { gravity = [0, 0, -9.81] }
material.bead = { density = 2500.0, youngs_modulus = "5 MPa", poissons_ratio = 0.3 }
shape.bead = { sphere = { radius = 2.5e-3 } }
contact = { method = "smooth", restitution = 0.6, friction = 0.5, smooth = { law = "hertz-mindlin" } }
[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "bead"
fixed = true
[[body]]
name = "ball"
shape = "bead"
material = "bead"
position = [0.01, 0.01, 0.0025]
[[body]]
name = "walls"
repeat = 4
shape = { half_space = { normal = ["= cos(i*pi/2)", "= sin(i*pi/2)", 0] } }
material = "bead"
position = ["= 0.01 - 0.01*cos(i*pi/2)", "= 0.01 - 0.01*sin(i*pi/2)", 0]
fixed = true
[[fill]]
name = "others"
shape = "bead"
material = "bead"
count = 60
region = { box = { min = [0, 0, 0.01], max = [0.02, 0.02, 0.1] } }
)TOML";

using Values = std::map<std::string, std::map<std::string, RunSummary::Component>>;

Values measured(const std::vector<std::string>& measures) {
  std::string text = scene;
  for (const std::string& m : measures) text += "[[measure]]\ninterval = 0.01\n" + m;
  ReadResult read = read_scene_text(text, "scene.toml", {}, full_registry());
  INFO((read.problems.empty() ? "" : read.problems[0].to_string()));
  REQUIRE(read.scene);
  const TemporaryFolder folder;
  Session session(assemble(std::move(*read.scene)), {}, folder / "out", Session::Output::least);
  REQUIRE(session.run({}, true) == Ending::completed);
  return session.summary().measures;
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

TEST_CASE("a measure says the same alone and beside others that look at contacts", "[scenes][measures]") {
  const std::vector<std::string> measures{
      "kind = 'force'\nbody = 'floor'\n",
      "kind = 'contact'\nbetween = ['ball', 'floor']\n",
      "kind = 'position'\nbody = 'ball'\n",
      "kind = 'coordination'\n",
      "kind = 'stress'\nregion = { box = { min = [0, 0, 0], max = [0.02, 0.02, 0.01] } }\n",
      "kind = 'hysteresis'\nbetween = ['ball', 'floor']\n",
      "kind = 'force_chains'\n",
      "kind = 'energy'\n",
      "kind = 'velocity'\nbody = 'ball'\n",
      "kind = 'solid_fraction'\nregion = { box = { min = [0, 0, 0], max = [0.02, 0.02, 0.01] } }\n",
      "kind = 'profile'\nregion = { box = { min = [0, 0, 0], max = [0.02, 0.02, 0.01] } }\n"};
  const Values together = measured(measures);
  REQUIRE(together.size() == measures.size());
  CHECK(together.at("force").at("z").last < -0.001);
  for (const std::string& m : measures)
    for (const auto& [name, components] : measured({m}))
      for (const auto& [component, value] : components) {
        INFO(name << " " << component);
        const RunSummary::Component& other = together.at(name).at(component);
        CHECK(same(value.last, other.last));
        CHECK(same(value.min, other.min));
        CHECK(same(value.max, other.max));
      }
}
