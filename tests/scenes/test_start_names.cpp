// A scene that starts from a run and writes bodies of its own: those of names that it does not take from the run are
// its own, and what the run overrules is told.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "scenes/session.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/viz_export/temporary_folder.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

const std::string settings =
    "[run]\nduration = 0.02\noutput_interval = 0.02\n[world]\ngravity = [0, 0, -9.81]\n[material.m]\ndensity = 2500\n"
    "youngs_modulus = \"5 MPa\"\npoissons_ratio = 0.3\n[contact]\nmethod = \"smooth\"\nrestitution = 0.5\n"
    "friction = 0.5\n[shape.ball]\nsphere = { radius = 0.01 }\n";

std::string floor_at(double height, const std::string& shape = "half_space = { normal = [0, 0, 1] }") {
  return fmt::format(
      "[[body]]\nname = \"floor\"\nshape = {{ {} }}\nmaterial = \"m\"\nposition = [0, 0, {}]\nfixed = true\n", shape,
      height);
}

std::string ball(const std::string& name, double x, double z = 0.00999) {
  return fmt::format("[[body]]\nname = \"{}\"\nshape = \"ball\"\nmaterial = \"m\"\nposition = [{}, 0, {}]\n", name, x,
                     z);
}

std::string lattice(int count) {
  return fmt::format(
      "[[fill]]\nname = \"sand\"\nshape = \"ball\"\nmaterial = \"m\"\ncount = {}\nregion = {{ box = {{ min = [-0.1, "
      "0.1, "
      "0], max = [0.1, 0.3, 0.2] }} }}\n",
      count);
}

void run(const fs::path& scene, const fs::path& out) {
  ReadResult read = read_scene(scene.string(), {}, full_registry());
  for (const Problem& p : read.problems) UNSCOPED_INFO(p.to_string());
  REQUIRE(read.scene);
  Session session(assemble(std::move(*read.scene)), {}, out);
  REQUIRE(session.run({}, true) == Ending::completed);
}

}  // namespace

TEST_CASE("bodies of a run that a scene does not take leave their names to its own", "[scenes][start]") {
  const TemporaryFolder folder;
  std::mt19937 random(12);
  std::ofstream(folder / "first.toml") << settings << floor_at(0) << ball("p", 0) << ball("q", 0.1);
  run(folder / "first.toml", folder / "first");
  for (int draw = 0; draw < 6; ++draw) {
    const bool by_region = draw % 2 == 0, boxed = draw % 3 == 0;
    const double sunk = std::uniform_real_distribution<double>(0, 5e-4)(random);
    const std::string take =
        by_region ? "region = { box = { min = [-0.05, -1, 0.001], max = [0.05, 1, 1] } }" : "bodies = [\"p\"]";
    const std::string own =
        boxed ? floor_at(-0.05 - sunk, "box = { size = [1, 1, 0.1] }") : floor_at(-sunk);  // where it is written here
    const std::string text =
        fmt::format("[start]\nfrom = {{ run = \"first\", {} }}\n", take) + settings + own + ball("q", 0.3);
    INFO(text);
    ReadResult read = read_scene_text(text, (folder / "next.toml").string(), {}, full_registry());
    for (const Problem& p : read.problems) INFO(p.to_string());
    REQUIRE(read.scene);
    CHECK(read.problems.empty());
    auto assembly = assemble(std::move(*read.scene));
    const World& world = assembly->simulation->world;
    REQUIRE(world.size() == 3);
    const auto at = [&](const std::string& name) {
      for (Slot s = 0; s < world.size(); ++s)
        if (body_name(*assembly, world.id[s]) == name) return world.position[s];
      return Vec3(Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
    };
    CHECK(at("floor").z() == (boxed ? -0.05 - sunk : -sunk));
    CHECK(at("q").x() == 0.3);
    CHECK(std::abs(at("p").z() - 0.00999) < 1e-4);
  }
}

TEST_CASE("what a run overrules in a scene that starts from it is told", "[scenes][start]") {
  const TemporaryFolder folder;
  std::ofstream(folder / "first.toml") << settings << floor_at(0) << ball("p", 0) << lattice(10);
  run(folder / "first.toml", folder / "first");
  struct Case {
    std::string bodies, told;
  };
  const std::string place = "place and velocity are those of there", shape = "with another shape";
  for (const Case& c : {Case{floor_at(0) + ball("p", 0) + lattice(10), ""}, Case{ball("p", 0.2), place},
                        Case{ball("p", 0) + lattice(12), "adds no bodies"},
                        Case{floor_at(0, "box = { size = [1, 1, 0.1] }"), shape}, Case{floor_at(-0.1), place}}) {
    INFO(c.bodies);
    ReadResult read = read_scene_text("[start]\nfrom = \"first\"\n" + settings + c.bodies,
                                      (folder / "next.toml").string(), {}, full_registry());
    REQUIRE(read.scene);
    REQUIRE(read.problems.size() == (c.told.empty() ? 0 : 1));
    if (!c.told.empty()) CHECK(read.problems[0].to_string().find(c.told) != std::string::npos);
  }
}
