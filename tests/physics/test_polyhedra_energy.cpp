// Polyhedra under smooth contact: what the law of overlap volumes keeps of the energy, and what springs at points do
// not.
#include <fmt/format.h>

#include <array>
#include <fstream>

#include "engine/units/random.h"
#include "scenes/contact_setup.h"
#include "scenes/law_potential.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

double energy_error(const std::vector<std::string>& overrides, std::uint64_t steps) {
  SceneRun run = prepare_scene(std::string(EPAFI_SOURCE_DIR) + "/tests/data/scenes/elastic_polyhedra.toml", overrides);
  run.simulation().start();
  run.advance_to(steps);
  CHECK(run.failure.empty());
  return std::abs(run.energy_error());
}

}  // namespace

TEST_CASE("elastic polyhedra keep their energy under the overlap-volume law", "[physics][polyhedra][energy][long]") {
  // second order in the step: 8e-7 to 4e-6 at the automatic step; springs at the points of a manifold (hertz) have no
  // potential where points come and go and err by 0.12 to 0.19 after 1 s at any step
  CHECK(energy_error({"run.time_step=3.5e-5"}, 15000) < 1e-5);
}

TEST_CASE("elastic bodies keep their energy on a fixed box or hull as on a plane",
          "[physics][polyhedra][energy][long]") {
  // bodies of never more than four points, so that none comes or goes at a depth; the soft pyramid lands on its blunt
  // tip and is then deep with corners of three faces
  const char* shapes[] = {
      "polyhedron = { vertices = [[0.06, 0, 0], [-0.03, 0.05, 0], [-0.03, -0.05, 0], [0, 0, 0.03], [0, 0, -0.004]] }",
      "box = { size = [0.08, 0.1, 0.12] }", "capsule = { radius = 0.03, length = 0.1 }"};
  const char* floors[] = {"box = { size = [6, 6, 0.4] }",
                          "polyhedron = { vertices = [[-3, -3, -0.2], [3, -3, -0.2], [0, 3, -0.2], [-4, -3, 0.2], [4, "
                          "-3, 0.2], [0, 4, 0.2]] }"};
  Random random(641, 10);
  for (int draw = 0; draw < 12; ++draw) {
    const bool blunt = draw % 3 == 0;
    const Quat any = testing::random_turn(random),
               small(Eigen::AngleAxisd(random.uniform(-0.05, 0.05), Vec3(1, random.uniform(-1, 1), 0).normalized()));
    const Quat turn = blunt ? small : any;
    const Vec3 spin = (blunt ? 1.0 : 9.0) * testing::random_point(random);
    SceneRun run = prepare(read_scene_text(
        fmt::format("[run]\nduration = 0.6\ntime_step = 1e-5\n[world]\ngravity = [0, 0, -9.81]\n"
                    "[material]\na = {{ density = 1e3, youngs_modulus = {}, poissons_ratio = 0.2 }}\n"
                    "[contact]\nmethod = \"smooth\"\nrestitution = 1\nfriction = 0\nsmooth = {{ law = \"hertz\" }}\n"
                    "[[body]]\nshape = {{ {} }}\nmaterial = \"a\"\nplace = \"as-drawn\"\nposition = [0, 0, -0.2]\n"
                    "fixed = true\n[[body]]\nshape = {{ {} }}\nmaterial = \"a\"\nposition = [0.1, 0.2, 0.15]\n"
                    "orientation = [{:.17g}, {:.17g}, {:.17g}, {:.17g}]\nvelocity = [0.2, 0.1, -1]\n"
                    "angular_velocity = [{}, {}, {}]\n",
                    blunt ? 1e5 : 1e7, floors[draw % 2], shapes[draw % 3], turn.w(), turn.x(), turn.y(), turn.z(),
                    spin.x(), spin.y(), spin.z()),
        "floor.toml", {}, full_registry()));
    run.simulation().start();
    run.advance_to(0);
    INFO("draw " << draw << ", " << shapes[draw % 3]);
    REQUIRE(run.failure.empty());
    CHECK(std::abs(run.energy_error()) < 1e-5);
  }
}

namespace {

/// A prism of 5 to 12 corners, a hull, or a cylinder, about 0.1 m wide; no box and no pyramid.
std::string body_of_many_points(Random& random, int kind) {
  if (kind == 0) return fmt::format("cylinder = {{ radius = 0.05, length = {} }}", random.uniform(0.02, 0.1));
  std::string corners;
  const auto add = [&](const Vec3& x) { corners += fmt::format("[{:.17g}, {:.17g}, {:.17g}], ", x.x(), x.y(), x.z()); };
  if (kind == 1) {
    for (std::uint64_t k = 8 + random.bits() % 20; k > 0; --k)
      add(testing::random_direction(random).cwiseProduct(Vec3(0.06, 0.05, 0.03)));
  } else {
    const std::uint64_t n = 5 + random.bits() % 8;
    const double half = random.uniform(0.01, 0.05);
    for (std::uint64_t k = 0; k < 2 * n; ++k) {
      const double a = 2.0 * testing::pi * static_cast<double>(k / 2) / static_cast<double>(n);
      add(Vec3(0.05 * std::cos(a), 0.05 * std::sin(a), k % 2 == 0 ? half : -half));
    }
  }
  return "polyhedron = { vertices = [" + corners + "] }";
}

/// A floor z = 0 of random triangles, 6 m wide.
std::string mesh_floor(Random& random, int draw) {
  const std::string file = fmt::format("{}/landing_floor_{}.obj", EPAFI_BINARY_DIR, draw);
  std::ofstream out(file);
  out.precision(17);
  const std::uint64_t cells = 2 + random.bits() % (draw % 2 == 0 ? 6 : 60);
  std::array<std::vector<double>, 2> at;
  for (auto& line : at) {
    line = {-3.0, 3.0};
    while (line.size() <= cells) line.push_back(random.uniform(-1, 1));
    std::ranges::sort(line);
  }
  for (const double x : at[0])
    for (const double y : at[1]) out << "v " << x << " " << y << " 0\n";
  for (std::uint64_t i = 0; i < cells; ++i)
    for (std::uint64_t j = 1; j <= cells; ++j) {
      const std::uint64_t k = i * (cells + 1) + j, over = k + cells + 1;
      out << "f " << k << " " << over << " " << over + 1 << "\nf " << k << " " << over + 1 << " " << k + 1 << "\n";
    }
  return "mesh = { file = \"" + file + "\" }";
}

/// An angle, a channel or a star, upright: solids of 2 to 6 parts.
std::string solid_of_parts(Random& random, int draw) {
  const double w = random.uniform(0.01, 0.03), half = random.uniform(0.01, 0.04);
  std::vector<std::pair<double, double>> outline = {{-0.05, -0.05},         {0.05, -0.05},     {0.05, -0.05 + w},
                                                    {-0.05 + w, -0.05 + w}, {-0.05 + w, 0.05}, {-0.05, 0.05}};
  if (draw % 3 == 1)
    outline = {{-0.05, -0.05},        {0.05, -0.05},          {0.05, 0.05},      {0.05 - w, 0.05},
               {0.05 - w, -0.05 + w}, {-0.05 + w, -0.05 + w}, {-0.05 + w, 0.03}, {-0.05, 0.03}};
  if (draw % 3 == 2) {
    outline.clear();
    const std::uint64_t points = 6 + 2 * (random.bits() % 4);
    for (std::uint64_t k = 0; k < points; ++k) {
      const double angle = 2.0 * testing::pi * static_cast<double>(k) / static_cast<double>(points);
      const double r = k % 2 == 1 ? 0.06 : 0.03;
      outline.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
  }
  const std::string file = fmt::format("{}/landing_solid_{}.obj", EPAFI_BINARY_DIR, draw);
  std::ofstream out(file);
  out.precision(17);
  for (const double z : {-half, half})
    for (const auto& [x, y] : outline) out << "v " << x << " " << y << " " << z << "\n";
  const std::size_t n = outline.size();
  std::string below = "f", above = "f";
  for (std::size_t k = 1; k <= n; ++k) {
    below += fmt::format(" {}", n + 1 - k);
    above += fmt::format(" {}", n + k);
    out << fmt::format("f {} {} {} {}\n", k, k % n + 1, n + k % n + 1, n + k);
  }
  out << below << "\n" << above << "\n";
  return "solid = { file = \"" + file + "\" }";
}

/// Of the energy, after half a second of bouncing; every fourth draw lands anyhow, the others flat.
double error_of_landing(Random& random, int draw, const std::string& floor, const std::string& shape, double e) {
  const Quat flat(Eigen::AngleAxisd(random.uniform(-0.1, 0.1), Vec3(1, random.uniform(-1, 1), 0).normalized())),
      any = testing::random_turn(random), turn = draw % 4 == 3 ? any : flat;
  const double young = std::pow(10.0, random.uniform(5, 7));
  const Vec3 spin = (draw % 4 == 3 ? 9.0 : 1.0) * testing::random_point(random);
  SceneRun run = start_text(
      fmt::format("[run]\nduration = 0.5\ntime_step = 1e-5\n[world]\ngravity = [0, 0, -9.81]\n"
                  "[material]\na = {{ density = 1e3, youngs_modulus = {}, poissons_ratio = 0.2 }}\n"
                  "[contact]\nmethod = \"smooth\"\nrestitution = {}\nfriction = 0\nsmooth = {{ law = \"hertz\" }}\n"
                  "[[body]]\nshape = {{ {} }}\nmaterial = \"a\"\nplace = \"as-drawn\"\nposition = [0, 0, {}]\n"
                  "fixed = true\n[[body]]\nshape = {{ {} }}\nmaterial = \"a\"\nposition = [0.1, 0.2, 0.12]\n"
                  "orientation = [{:.17g}, {:.17g}, {:.17g}, {:.17g}]\nvelocity = [0.2, 0.1, -1]\n"
                  "angular_velocity = [{}, {}, {}]\n",
                  young, e, floor, floor.starts_with("box") ? -0.2 : 0.0, shape, turn.w(), turn.x(), turn.y(), turn.z(),
                  spin.x(), spin.y(), spin.z()));
  run.advance_to(0);
  REQUIRE(run.failure.empty());
  return std::abs(run.energy_error());
}

}  // namespace

TEST_CASE("what lands on a wide face with more than four points keeps its energy, flat landings too",
          "[physics][polyhedra][energy][long]") {
  // four of the points that touch, chosen anew in each step, lost or gained up to 0.18 where another set was deeper
  const std::string plane = "half_space = { normal = [0, 0, 1] }", box = "box = { size = [6, 6, 0.4] }";
  Random random(643, 2);
  for (int draw = 0; draw < 48; ++draw) {
    const int floor_kind = draw / 4 % 3;
    const std::string floor = floor_kind == 0 ? plane : floor_kind == 1 ? box : mesh_floor(random, draw);
    const std::string shape = draw % 4 == 3 ? solid_of_parts(random, draw / 4) : body_of_many_points(random, draw % 4);
    const double e = draw < 24 ? 1.0 : random.uniform(0.3, 1.0);
    INFO("draw " << draw << ", " << floor << ", " << shape << ", e " << e);
    CHECK(error_of_landing(random, draw / 4, floor, shape, e) < (e < 1.0 ? 5e-5 : 2e-6));  // second order in the step
  }
}

TEST_CASE("the overlap-volume law refuses shapes without sharp faces by name", "[physics][polyhedra][errors]") {
  const auto message = [](const std::string& shape) {
    try {
      prepare_scene(std::string(EPAFI_SOURCE_DIR) + "/tests/data/scenes/elastic_polyhedra.toml", {shape});
    } catch (const SceneError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  CHECK_THAT(message("shape.stone.rounding=1e-3"),
             Catch::Contains("needs sharp polyhedra") && Catch::Contains("not a rounded polyhedron"));
}

TEST_CASE("elastic bodies with flat sides under a law without a potential are refused, others are not",
          "[physics][polyhedra][errors]") {
  const auto refused = [](const std::vector<std::string>& overrides) {
    try {
      prepare_scene(std::string(EPAFI_SOURCE_DIR) + "/tests/data/scenes/elastic_polyhedra.toml", overrides);
    } catch (const SceneError& error) {
      CHECK_THAT(error.what(),
                 Catch::Contains("write law = \"overlap-volume\"") && Catch::Contains("restitution = 0.9"));
      return true;
    }
    return false;
  };
  for (const std::string law : {"hertz", "hertz-mindlin", "tsuji"}) {
    const std::string use = "contact.smooth.law=" + law;
    CHECK(refused({use}));
    CHECK_FALSE(refused({use, "contact.restitution=0.9"}));
    CHECK_FALSE(refused({use, "contact.method=nonsmooth"}));
    CHECK_FALSE(refused({use, "body.s.fixed=true", "body.s.velocity=[0,0,0]"}));  // nothing that moves meets another
  }
  CHECK_FALSE(refused({}));
}

TEST_CASE("an elastic pair of materials is refused only where two such bodies with flat sides may meet",
          "[physics][polyhedra][errors]") {
  const std::string head =
      "[run]\nduration = 0.01\n[material]\na = { density = 1e3, youngs_modulus = 1e7, poissons_ratio = 0.2 }\n"
      "b = { density = 1e3, youngs_modulus = 1e7, poissons_ratio = 0.2 }\n"
      "[contact]\nmethod = \"smooth\"\nrestitution = 0.5\nfriction = 0\n";
  const auto body = [](const std::string& shape, const std::string& material, double x) {
    return fmt::format("[[body]]\nshape = {{ {} }}\nmaterial = \"{}\"\nposition = [{}, 0, 0]\n", shape, material, x);
  };
  const std::string box = "box = { size = [0.1, 0.1, 0.1] }", ball = "sphere = { radius = 0.05 }";
  const auto refused_at = [&](const std::string& between, const std::string& bodies) {
    const std::string pair = "[[contact.pair]]\nbetween = " + between + "\nrestitution = 1\n";
    try {
      prepare(read_scene_text(head + pair + bodies, "scene.toml", {}, full_registry()));
    } catch (const SceneError& error) {
      return error.problems().front().place.line;
    }
    return 0;
  };
  const std::string boxes = body(box, "a", 0) + body(box, "b", 1);
  CHECK(refused_at("[\"a\", \"b\"]", boxes) == 10);
  CHECK(refused_at("[\"a\", \"a\"]", boxes) == 0);
  CHECK(refused_at("[\"a\", \"a\"]", boxes + body(box, "a", 2)) == 10);
  CHECK(refused_at("[\"a\", \"b\"]", body(box, "a", 0) + body(box, "a", 2) + body(ball, "b", 1)) == 0);
}

TEST_CASE("what to write for a potential is known to the watch over the balance", "[physics][polyhedra][errors]") {
  SceneRun run = prepare_scene(std::string(EPAFI_SOURCE_DIR) + "/tests/data/scenes/elastic_polyhedra.toml",
                               {"contact.smooth.law=hertz", "contact.restitution=0.9"});
  CHECK_THAT(way_to_a_potential(*run.assembly), Catch::Contains("law 'hertz' has no potential"));
  SceneRun with_potential =
      prepare_scene(std::string(EPAFI_SOURCE_DIR) + "/tests/data/scenes/elastic_polyhedra.toml", {});
  CHECK(way_to_a_potential(*with_potential.assembly).empty());
}

TEST_CASE("restitution below critical damping acts as that of critical damping, said so",
          "[physics][polyhedra][errors]") {
  ReadResult read = read_scene(std::string(EPAFI_SOURCE_DIR) + "/tests/data/scenes/elastic_polyhedra.toml",
                               {"contact.restitution=0"}, full_registry());
  REQUIRE(read.scene);
  const auto problems = check_smooth({"overlap-volume", "", "", material_table(*read.scene)});
  REQUIRE(problems.size() == 1);
  CHECK_THAT(problems[0].text, Catch::Contains("acts as 0.135335"));
}

TEST_CASE("damped polyhedra with friction come to rest and their ledger closes", "[physics][polyhedra][energy][slow]") {
  SceneRun run = prepare_scene(std::string(EPAFI_SOURCE_DIR) + "/tests/data/scenes/elastic_polyhedra.toml",
                               {"contact.restitution=0", "contact.friction=0.5", "run.duration=3"});
  run.simulation().start();
  run.advance_to(0);
  CHECK(run.failure.empty());
  const Energy& e = run.simulation().ledger.measure(run.simulation().world);
  CHECK(e.kinetic < 1e-5 * e.dissipated);  // 2e-7: what springs of friction, which have no dashpot, still swing
  CHECK(std::abs(run.energy_error()) < 1e-4);
  CHECK(e.losses.viscous > 0.0);
  CHECK(e.losses.frictional > 0.0);
}
