// Flat arches of free stones, level on top: what slides over them without friction keeps its speed although the stones
// have sunk until their joints carry.
#include <fmt/format.h>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;

namespace {

constexpr double pace = 2.0, reach = 2.0;

/// Between two abutments whose joints, as all others, meet in one line below.
struct FlatArch {
  std::vector<double> joints;  ///< on top [m]
  double thick, narrowing;     ///< of what is at x on top, at the bottom
};

FlatArch random_arch(Random& random) {
  FlatArch arch;
  const double width = random.uniform(0.6, 1.2);
  arch.thick = random.uniform(0.1, 0.3);
  arch.narrowing = 1.0 - arch.thick / random.uniform(0.6, 1.5);
  std::vector<double> ends = {0.0};
  for (std::uint64_t k = 3 + random.bits() % 5; k > 0; --k) ends.push_back(ends.back() + random.uniform(0.6, 1.4));
  for (const double x : ends) arch.joints.push_back(width * (x / ends.back() - 0.5));
  return arch;
}

/// Corners of a stone between two joints; at the outer side of an abutment it stands upright.
std::string stone(const FlatArch& arch, double left, double right, bool fixed) {
  const double low_left = left <= -reach ? left : left * arch.narrowing,
               low_right = right >= reach ? right : right * arch.narrowing;
  std::string corners;
  for (const double y : {-0.3, 0.3})
    corners +=
        fmt::format("[{0:.17g}, {4}, 0], [{1:.17g}, {4}, 0], [{2:.17g}, {4}, {5:.17g}], [{3:.17g}, {4}, {5:.17g}], ",
                    left, right, low_left, low_right, y, -arch.thick);
  return fmt::format(
      "[[body]]\nshape = {{ polyhedron = {{ vertices = [{}] }} }}\nplace = \"as-drawn\"\n"
      "material = \"stone\"\nposition = [0, 0, 0]\n{}",
      corners, fixed ? "fixed = true\n" : "");
}

}  // namespace

TEST_CASE("bodies slide over flat arches of free stones as over one plate", "[seams][physics][long]") {
  Random random(645, 4);
  const std::string sliders[] = {"box = { size = [0.1, 0.1, 0.1] }", "cylinder = { radius = 0.05, length = 0.1 }"};
  for (int draw = 0; draw < 30; ++draw) {
    const FlatArch arch = random_arch(random);
    std::string text =
        "[run]\nduration = 0.9\n[world]\ngravity = [0, 0, -9.81]\n"
        "[material]\nstone = { density = 2500 }\nslider = { density = 250 }\n"
        "[contact]\nmethod = \"nonsmooth\"\nrestitution = 0\nfriction = 0.7\n"
        "[[contact.pair]]\nbetween = [\"stone\", \"slider\"]\nfriction = 0\n";
    text += stone(arch, -reach, arch.joints.front(), true);
    for (std::size_t k = 1; k < arch.joints.size(); ++k) text += stone(arch, arch.joints[k - 1], arch.joints[k], false);
    text += stone(arch, arch.joints.back(), reach, true);
    text += fmt::format(
        "[[body]]\nshape = {{ {} }}\nmaterial = \"slider\"\nposition = [{}, 0.03, 0.0500001]\n"
        "velocity = [{}, 0, 0]\n",
        sliders[draw % 2], arch.joints.front() - 0.2, pace);
    experiments::SceneRun run = experiments::prepare(read_scene_text(text, "arch.toml", {}, full_registry()));
    run.advance_to(0);
    INFO("draw " << draw << ", " << arch.joints.size() - 1 << " stones");
    REQUIRE(run.failure.empty());
    const World& world = run.simulation().world;
    const Slot slider = world.slot_of(static_cast<BodyId>(world.size() - 1));
    REQUIRE(world.position[slider].x() > arch.joints.back() + 0.05);
    CHECK(world.velocity[slider].x() > 0.999 * pace);
    CHECK(world.velocity[slider].x() < 1.0001 * pace);
  }
}
