// What a contact remembers goes on where the body passes from face to face of a mesh: a ball that hangs by adhesion
// slides along under a ceiling of shallow bends, both hollow and ridged, and does not fall.
#include <fmt/format.h>

#include <fstream>

#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"
#include "tests/support/scene_run.h"

using namespace epafi;

namespace {

constexpr double radius = 1e-3;

/// Ceiling of strips across x from -5 mm to 5 mm, of random widths and turned by less than 0.9 degrees at each bend;
/// its height where the ball hangs first, at x = -3 mm, is 0.
void write_ceiling(const std::string& path, Random& random) {
  std::vector<std::pair<double, double>> profile = {{-5e-3, 0.0}};
  double slope = 0.0;
  while (profile.back().first < 5e-3) {
    const auto [x, z] = profile.back();
    const double width = profile.size() == 1 ? random.uniform(2.3e-3, 3e-3) : random.uniform(0.1e-3, 1.5e-3);
    profile.push_back({x + width, z + slope * width});
    const double wanted = random.uniform(-0.007, 0.007);  // rad: two neighbours differ by less than 0.9 degrees
    slope = wanted;
  }
  std::ofstream out(path);
  out.precision(17);
  for (const auto& [x, z] : profile) out << "v " << x << " -0.01 " << z << "\nv " << x << " 0.01 " << z << "\n";
  for (std::size_t k = 1; k < profile.size(); ++k) {
    const std::size_t a = 2 * k - 1, b = a + 1, c = a + 2, d = a + 3;
    out << "f " << a << ' ' << c << ' ' << d << "\nf " << a << ' ' << d << ' ' << b << "\n";
  }
}

std::string write_scene(const std::string& stem, double hold) {
  const double weight = 2500.0 * 4.0 / 3.0 * testing::pi * radius * radius * radius * 10.0;
  const double work = hold * weight / (1.5 * testing::pi * radius);  // pull-off force 3/2 pi W R (Johnson et al. 1971)
  std::ofstream out(stem + ".toml");
  out.precision(17);
  out << "[run]\nduration = 0.06\ntime_step = 2e-6\n[world]\ngravity = [0, 0, -10]\n"
      << "[material.m]\ndensity = 2500\nyoungs_modulus = 1e7\npoissons_ratio = 0.25\n"
      << "[contact]\nmethod = \"smooth\"\nrestitution = 0.5\nfriction = 0\n"
      << "smooth = { law = \"jkr\", work_of_adhesion = " << work << " }\n"
      << "[[body]]\nname = \"ceiling\"\nshape = { mesh = { file = \"" << stem
      << ".obj\" } }\nmaterial = \"m\"\nfixed = true\n"
      << "[[body]]\nname = \"ball\"\nshape = { sphere = { radius = " << radius << " } }\nmaterial = \"m\"\n"
      << "position = [-3e-3, 0, " << -0.9999 * radius << "]\nvelocity = [0.1, 0, 0]\n";
  return stem + ".toml";
}

}  // namespace

TEST_CASE("a ball that hangs by adhesion slides under shallow bends and does not fall", "[mesh][jkr]") {
  Random random(641, 3);
  for (int n = 0; n < 8; ++n) {
    const std::string stem = std::string(EPAFI_BINARY_DIR) + "/ceiling_" + std::to_string(n);
    write_ceiling(stem + ".obj", random);
    auto sim = experiments::prepare_scene(write_scene(stem, 1.4), {});
    sim.simulation().start();
    while (sim.simulation().steps() < sim.assembly->steps) REQUIRE_FALSE(sim.simulation().advance().has_value());
    const World& world = sim.simulation().world;
    const Vec3 end = world.position[world.slot_of(BodyId{1})];
    INFO("ceiling " << n);
    CHECK(end.z() > -1.1 * radius);
    CHECK(end.x() > 2.5e-3);
  }
}

TEST_CASE("whether adhesive bodies start at a gap or an overlap of rounding does not count", "[jkr][energy]") {
  Random random(641, 7);
  for (int n = 0; n < 24; ++n) {
    const double size = std::pow(10.0, random.uniform(-3, -1)), work = size * random.uniform(1, 100);
    const bool in_sphere_loop = n % 2 == 0;
    const auto lost = [&](double gap) {
      const std::string wall = in_sphere_loop ? "half_space = { normal = [0, 0, 1] }" : "box = { size = [1, 1, 0.1] }";
      auto run = experiments::start_text(fmt::format(
          "run = {{ duration = 1.0, time_step = {:.17g} }}\nworld = {{ gravity = [0, 0, -9.81] }}\n"
          "material.m = {{ density = 2500, youngs_modulus = 1e7, poissons_ratio = 0.25 }}\n"
          "contact = {{ method = \"smooth\", restitution = 0.5, friction = 0, smooth = {{ law = \"jkr\", "
          "work_of_adhesion = {} }} "
          "}}\n"
          "[[body]]\nshape = {{ {} }}\nmaterial = \"m\"\nposition = [0, 0, {}]\nfixed = true\n"
          "[[body]]\nshape = {{ {} }}\nmaterial = \"m\"\nposition = [0, 0, {:.17g}]\n",
          1e-3 * size, work, wall, in_sphere_loop ? 0.0 : -0.05,
          in_sphere_loop ? fmt::format("sphere = {{ radius = {:.17g} }}", size)
                         : fmt::format("ellipsoid = {{ semi_axes = [{0:.17g}, {0:.17g}, {0:.17g}] }}", size),
          size + gap));
      run.advance_to(200);
      REQUIRE(run.failure.empty());
      CHECK(std::abs(run.energy_error()) < 1e-2);
      return run.simulation().ledger.last().losses.adhesive;
    };
    const double met = lost(1e-13 * size);
    INFO("draw " << n << ": radius " << size << ", " << work << " J/m^2");
    CHECK(met > 0.0);
    CHECK(lost(-1e-13 * size) == Approx(met).epsilon(1e-6));
  }
}
