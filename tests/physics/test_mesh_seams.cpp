// Flat bodies without friction slide over the seams of level walls, some of which are meshes: closed ones, sheets, one
// as wide as a periodic cell. They keep their speed, whatever the walls are made of, and do not turn.
#include <fmt/format.h>

#include <fstream>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"
#include "tests/support/scene_run.h"

using namespace epafi;

namespace {

constexpr double floor_width = 0.4, thick = 0.1;
constexpr std::uint64_t settled = 500, slid = 11000, looked_at_every = 20;  // over 0.22 m

enum class TileKind { closed, sheet, polyhedron };

/// The part of the floor between two seams, each of which leans by `skew` along y.
void write_tile(const std::string& name, bool sheet, const std::array<double, 2>& x, const std::array<double, 2>& skew,
                const std::array<double, 2>& y) {
  std::ofstream out(std::string(EPAFI_BINARY_DIR) + "/" + name);
  out.precision(17);
  for (const double z : {0.0, -thick})
    for (const auto& [end, side] : {std::pair{0u, 0u}, {1u, 0u}, {1u, 1u}, {0u, 1u}})
      out << "v " << x[end] + (side == 0 ? -skew[end] : skew[end]) << ' ' << y[side] << ' ' << z << '\n';
  out << "f 1 2 3 4\n";
  if (!sheet) out << "f 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n";
}

std::string sliding_shape(Random& random, double& height) {
  const double size = random.uniform(0.06, 0.1), wide = size * random.uniform(0.5, 1.0);
  const std::uint64_t kind = random.bits() % 3;
  height = kind == 0 ? 0.25 * size : kind == 1 ? 0.5 * wide : 0.0;
  if (kind == 0) return fmt::format("box = {{ size = [{:.17g}, {:.17g}, {:.17g}] }}", size, wide, 0.5 * size);
  if (kind == 1) return fmt::format("cylinder = {{ radius = {:.17g}, length = {:.17g} }}", 0.5 * size, wide);
  std::string corners;
  for (int k = 0; k < 7; ++k) {
    const double angle = 2.0 * testing::pi * (k + random.uniform(0.0, 0.6)) / 7, r = 0.5 * size;
    for (const double z : {0.0, 0.5 * size})
      corners += fmt::format("[{:.17g}, {:.17g}, {:.17g}], ", r * std::cos(angle), r * std::sin(angle), z);
  }
  return "polyhedron = { vertices = [" + corners.substr(0, corners.size() - 2) + "] }";
}

class SlidingScene {
 public:
  explicit SlidingScene(bool periodic)
      : text_(fmt::format(
            "[run]\nduration = 1\ntime_step = 2e-5\n[world]\ngravity = [0, 0, -9.81]\n{}[material]\na = {{ density = "
            "1000, youngs_modulus = 1e7, poissons_ratio = 0.3 }}\n[contact]\nmethod = \"smooth\"\nrestitution = "
            "0\nfriction = 0\n",
            periodic ? fmt::format("domain = {{ min = [0, 0, -0.2], max = [{0}, {0}, 0.4], periodic = [\"x\", \"y\"] "
                                   "}}\n",
                                   floor_width)
                     : "")) {}
  void add_tile(const std::string& file, TileKind kind) {
    add(fmt::format("{} = {{ file = \"{}/{}\" }}", kind == TileKind::polyhedron ? "polyhedron" : "mesh",
                    EPAFI_BINARY_DIR, file),
        Vec3::Zero(), "fixed = true");
  }
  void add(const std::string& shape, const Vec3& at, const std::string& more) {
    text_ += fmt::format(
        "[[body]]\nshape = {{ {} }}\nmaterial = \"a\"\nposition = [{:.17g}, {:.17g}, {:.17g}]\nplace "
        "= \"as-drawn\"\n{}\n",
        shape, at.x(), at.y(), at.z(), more);
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// Two tiles of these kinds, or one that fills the cell.
std::string scene_of(Random& random, std::span<const TileKind> kinds) {
  SlidingScene scene(kinds.size() == 1);
  if (kinds.size() == 1) {
    write_tile("seam_tile_0.obj", false, {0.0, floor_width}, {0.0, 0.0}, {0.0, floor_width});
    scene.add_tile("seam_tile_0.obj", kinds[0]);
  }
  const double skew = random.uniform(0, 0.3), at = random.uniform(0.08, 0.15);
  for (std::size_t k = 0; k < kinds.size() && kinds.size() > 1; ++k) {
    const std::string file = fmt::format("seam_tile_{}.obj", k);
    const auto ends = k == 0 ? std::array{-1.0, at} : std::array{at, 2.0};
    const auto lean = k == 0 ? std::array{0.0, skew} : std::array{skew, 0.0};
    write_tile(file, kinds[k] == TileKind::sheet, ends, lean, {-1.0, 1.0});
    scene.add_tile(file, kinds[k]);
  }
  double height = 0.0;
  const std::string body = sliding_shape(random, height);
  const double yaw = random.uniform(0, testing::pi), way = random.uniform(-0.5, 0.5);
  scene.add(body, Vec3(kinds.size() == 1 ? floor_width - at : 0.0, random.uniform(0, 0.05), height - 1e-4),
            fmt::format("orientation = [{:.17g}, 0, 0, {:.17g}]\nvelocity = [{:.17g}, {:.17g}, 0]", std::cos(yaw),
                        std::sin(yaw), std::cos(way), std::sin(way)));
  return scene.text();
}

}  // namespace

TEST_CASE("flat bodies keep their speed over the seams of meshes", "[seams][physics][mesh]") {
  using enum TileKind;
  const std::vector<std::vector<TileKind>> floors = {{closed, closed},    {sheet, closed},      {closed, sheet},
                                                     {sheet, polyhedron}, {polyhedron, closed}, {closed}};
  Random random(646, 1);
  for (std::size_t draw = 0; draw < 2 * floors.size(); ++draw) {
    experiments::SceneRun run = experiments::start_text(scene_of(random, floors[draw % floors.size()]));
    const World& world = run.simulation().world;
    double most_off = 0.0, spin = 0.0;
    run.advance_to(settled);
    Slot body = 0;
    while (!world.is_movable(body)) ++body;
    const Vec3 before = world.velocity[body];
    for (std::uint64_t step = settled; step <= slid && run.failure.empty(); step += looked_at_every) {
      run.advance_to(step);
      most_off = std::max(most_off, (world.velocity[body] - before).head<2>().norm());
      spin = std::max(spin, world.angular_velocity[body].norm());
    }
    INFO("draw " << draw << run.failure);
    REQUIRE(run.failure.empty());
    CHECK(most_off < 1e-4);  // up to 1.2 where each mesh holds for itself
    CHECK(spin < 2e-2);
  }
}
