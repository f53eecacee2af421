// Free bodies that lie side by side are one surface: what slides or rolls over them without friction keeps its speed,
// in any frame and far from the origin; a step higher than the tolerance stops it.
#include <fmt/format.h>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"
#include "tests/support/scene_run.h"

using namespace epafi;

namespace {

constexpr double pace = 2.0, thick = 0.1;

struct Slider {
  const char* shape;
  double height;  ///< of its centre where it stands on the tiles [m]
};

constexpr Slider sliders[] = {
    {"box = { size = [0.1, 0.1, 0.1] }", 0.05},
    {"sphere = { radius = 0.05 }", 0.05},
    {"clump = { spheres = [[0, 0, 0, 0.05], [0.06, 0, 0, 0.05], [0.03, 0.05, 0, 0.05]] }", 0.05},
    {"cylinder = { radius = 0.05, length = 0.1 }", 0.05},
    {"capsule = { radius = 0.04, length = 0.08 }", 0.08},
    {"ellipsoid = { semi_axes = [0.06, 0.05, 0.04] }", 0.04},
    {"polyhedron = { vertices = [[-0.05, -0.05, 0], [0.05, -0.05, 0], [0.05, 0.05, 0], [-0.05, 0.05, 0],"
     " [-0.03, -0.03, 0.1], [0.03, -0.03, 0.1], [0.03, 0.03, 0.1], [-0.03, 0.03, 0.1]] }",
     0.04},
};

/// Writes bodies where they stand in a frame that is turned and shifted as a whole.
class Tiles {
 public:
  Tiles(Random& random, bool smooth, double distance) : turn_(testing::random_turn(random)), smooth_(smooth) {
    origin_ = distance * testing::random_direction(random);
  }
  void add(const std::string& name, const std::string& shape, const Vec3& at, const std::string& more) {
    const Vec3 p = origin_ + turn_ * at;
    text_ += fmt::format(
        "[[body]]\nname = \"{}\"\nshape = {{ {} }}\nposition = [{:.17g}, {:.17g}, {:.17g}]\n"
        "orientation = [{:.17g}, {:.17g}, {:.17g}, {:.17g}]\n{}\n",
        name, shape, p.x(), p.y(), p.z(), turn_.w(), turn_.x(), turn_.y(), turn_.z(), more);
  }
  void add_floor(const std::vector<double>& off) {
    add("floor", "half_space = { normal = [0, 0, 1] }", Vec3(0, 0, -thick), "material = \"a\"\nfixed = true");
    for (std::size_t k = 0; k < off.size(); ++k)
      add(fmt::format("tile{}", k), fmt::format("box = {{ size = [0.3, 0.6, {:.17g}] }}", thick + off[k]),
          Vec3(0.3 * static_cast<double>(k), 0, 0.5 * (off[k] - thick)), "material = \"a\"");
  }
  void add_slider(const Slider& body, double rise) {
    const Vec3 v = turn_ * Vec3(pace, 0, 0);
    add("b", body.shape, Vec3(0.02, 0.03, body.height + rise),
        fmt::format("material = \"b\"\nvelocity = [{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z()));
  }
  /// Speeds along, across and up at the end.
  Vec3 run(double time) const {
    const Vec3 g = turn_ * Vec3(0, 0, -9.81);
    const std::string head = fmt::format(
        "[run]\nduration = {}\n[world]\ngravity = [{:.17g}, {:.17g}, {:.17g}]\n"
        "[material]\na = {{ density = 500, youngs_modulus = 1e7, poissons_ratio = 0.2 }}\n"
        "b = {{ density = 2500, youngs_modulus = 1e7, poissons_ratio = 0.2 }}\n"
        "[contact]\nmethod = \"{}\"\nrestitution = 0\nfriction = 0.5\n"
        "[[contact.pair]]\nbetween = [\"a\", \"b\"]\nfriction = 0\n",
        time, g.x(), g.y(), g.z(), smooth_ ? "smooth" : "nonsmooth");
    experiments::SceneRun run = experiments::prepare(read_scene_text(head + text_, "tiles.toml", {}, full_registry()));
    run.advance_to(0);
    REQUIRE(run.failure.empty());
    const World& world = run.simulation().world;
    return turn_.conjugate() * world.velocity[world.slot_of(static_cast<BodyId>(world.size() - 1))];
  }

 private:
  Quat turn_;
  Vec3 origin_;
  bool smooth_;
  std::string text_;
};

}  // namespace

TEST_CASE("bodies slide over free tiles that lie side by side as over one plate", "[seams][physics]") {
  Random random(645, 1);
  for (int draw = 0; draw < 28; ++draw) {
    const bool smooth = draw / 7 % 2 == 0;
    const double distance = draw < 14 ? 0.0 : std::pow(10.0, random.uniform(0, 3));
    const Slider& body = sliders[draw % 7];
    Tiles tiles(random, smooth, distance);
    const double most = smooth ? 3e-5 : 5e-7;  // level: within the overlap, or 1e-5 of the body's size
    std::vector<double> off(4);
    for (double& o : off) o = draw % 2 == 0 ? 0.0 : random.uniform(-most, 0);
    tiles.add_floor(off);
    tiles.add_slider(body, 0.0);
    const Vec3 v = tiles.run(0.3);
    INFO("draw " << draw << ": " << body.shape << (smooth ? ", smooth, " : ", non-smooth, ") << distance << " m away");
    CHECK(v.x() > 0.999 * pace);
    CHECK(v.x() < 1.0001 * pace);
    CHECK(std::abs(v.y()) < 2e-3 * pace);
  }
}

TEST_CASE("a free tile that stands higher stops what slides against it", "[seams][physics]") {
  Random random(645, 2);
  for (int draw = 0; draw < 8; ++draw) {
    const bool smooth = draw % 2 == 0;
    Tiles tiles(random, smooth, draw < 4 ? 0.0 : random.uniform(1, 100));
    const double step = std::pow(10.0, random.uniform(-3, -1.7));
    tiles.add_floor({0.0, step, step});
    tiles.add_slider(sliders[draw % 4 < 2 ? 0 : 3], 0.0);
    INFO("draw " << draw << ", step " << step << (smooth ? ", smooth" : ", non-smooth"));
    CHECK(tiles.run(0.12).x() < 0.8 * pace);
  }
}
