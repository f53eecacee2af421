// What the corners of two bodies remember goes on where their names change: equal boxes side by side have coincident
// corners, and the least offset turns a corner of one into a crossing of two edges.
#include <fmt/format.h>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;

namespace {

/// Equal boxes in a row on a floor; a driven plate hits the first one.
std::string row_of_boxes(Random& random, const std::string& law) {
  const int boxes = 2 + static_cast<int>(random.bits() % 3);
  const double x = random.uniform(0.2, 1), y = random.uniform(0.2, 1), z = random.uniform(0.1, 0.3);
  return fmt::format(
      "[run]\nduration = 0.05\noutput_interval = 0.05\n[world]\ngravity = [0, 0, -9.81]\n"
      "[material.m]\ndensity = 1000\nyoungs_modulus = \"1 GPa\"\npoissons_ratio = 0.3\n"
      "[contact]\nmethod = \"smooth\"\nrestitution = {:.3f}\nfriction = {:.3f}\n"
      "[contact.smooth]\nlaw = \"{}\"\nstiffness = {:.17g}\n"
      "[[body]]\nshape = {{ half_space = {{ normal = [0, 0, 1] }} }}\nmaterial = \"m\"\nfixed = true\n"
      "[[body]]\nname = \"box\"\nrepeat = {}\nshape = {{ box = {{ size = [{:.17g}, {:.17g}, {:.17g}] }} }}\n"
      "material = \"m\"\nposition = [\"= {:.17g}*i\", 0, {:.17g}]\n"
      "[[body]]\nshape = {{ box = {{ size = [0.4, 2, 1.2] }} }}\nmaterial = \"m\"\n"
      "position = [{:.17g}, 0, 0.7]\nmotion = {{ velocity = [{:.17g}, 0, 0] }}\n",
      random.uniform(0.2, 0.6), random.bits() % 2 == 0 ? 0.0 : random.uniform(0.1, 0.5), law, random.uniform(1e7, 1e9),
      boxes, x, y, z, x, 0.5 * z, -0.5 * x - 0.2 - random.uniform(1e-3, 0.02), random.uniform(0.5, 2));
}

}  // namespace

TEST_CASE("boxes side by side keep what their corners remember: the balance closes", "[physics][memory]") {
  Random random(31, 1);
  for (int draw = 0; draw < 12; ++draw) {
    const std::string text = row_of_boxes(random, draw % 3 == 2 ? "linear" : "walton-braun");
    INFO(text);
    auto run = experiments::start_text(text);
    run.advance_to(0);
    CHECK(run.failure.empty());
    CHECK(std::abs(run.energy_error()) < 2e-3);
  }
}
