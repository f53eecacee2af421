// The law of impact as a key of the scene (case A24), and where the three differ.
#include <filesystem>
#include <fstream>
#include <sstream>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/support/scene_text.h"

using namespace epafi;
using namespace epafi::experiments;

TEST_CASE("the cradle of the library answers as its law of impact says (A24)", "[physics][impact][A24]") {
  const auto run = [](const std::string& law) {
    return run_scene("impact/cradle.toml", {"contact.nonsmooth.impact=" + law});
  };
  const auto sequential = run("sequential");
  CHECK(sequential.last("striker", "x") == Approx(0.0).margin(1e-10));
  CHECK(sequential.last("second", "x") == Approx(0.0).margin(1e-10));
  CHECK(sequential.last("last", "x") == Approx(1.0).epsilon(1e-10));
  for (const std::string law : {"newton", "poisson"}) {
    const auto spread = run(law);
    CHECK(spread.last("striker", "x") == Approx(-0.6).epsilon(1e-9));
    CHECK(spread.last("last", "x") == Approx(0.4).epsilon(1e-9));
  }
}

TEST_CASE("Poisson's law gives back a shock through contacts that did not approach, Newton's does not",
          "[physics][impact]") {
  // Two touching balls meet a wall with 1 m/s; e = 0 at the wall, 1 between them. Compression: impulses 2 m at the wall
  // and m between the balls. Poisson: the latter comes back, the outer ball leaves with 1 m/s. Newton: 1 times an
  // approach of 0.
  const auto path = std::filesystem::temp_directory_path() / "epafi_two_balls.toml";
  std::ofstream(path) << R"(
run = { duration = 0.1, time_step = 1e-3 }
material.ball = { density = 1000.0 }
material.wall = { density = 1000.0 }
[contact]
method = "nonsmooth"
restitution = 1.0
friction = 0.0
nonsmooth = { iterations = 1000, tolerance = 1e-12 }
[[contact.pair]]
between = ["ball", "wall"]
restitution = 0.0
[[body]]
name = "wall"
shape = { half_space = { normal = [1, 0, 0] } }
material = "wall"
fixed = true
[[body]]
name = "inner"
shape = { sphere = { radius = 0.05 } }
material = "ball"
position = [0.06, 0, 0]
velocity = [-1, 0, 0]
[[body]]
name = "outer"
shape = { sphere = { radius = 0.05 } }
material = "ball"
position = [0.16, 0, 0]
velocity = [-1, 0, 0]
)" << velocity_measure("inner")
                      << velocity_measure("outer");
  for (const auto& [law, outer] : {std::pair("newton", 0.0), {"poisson", 1.0}}) {
    auto run = prepare_scene(path.string(), {std::string("contact.nonsmooth.impact=") + law});
    run.simulation().start();
    run.advance_to(0);
    INFO(law);
    CHECK(run.failure.empty());
    CHECK(run.last("inner", "x") == Approx(0.0).margin(1e-9));
    CHECK(run.last("outer", "x") == Approx(outer).margin(1e-9));
  }
  std::filesystem::remove(path);
}

namespace {
/// Apexes of the ball of impact/bounce.toml above the floor, from the parabola through the three highest places [m].
std::vector<double> apexes(double e, const std::string& law, const std::string& dt) {
  experiments::SceneRun run = experiments::run_scene(
      "impact/bounce.toml", {"params.restitution=" + std::to_string(e), "contact.nonsmooth.impact=" + law,
                             "run.time_step=" + dt, "run.duration=\"= 1/240\"", "run.output_interval=" + dt});
  Simulation& sim = run.simulation();
  const auto height = [&] {
    for (Slot s = 0; s < sim.world.size(); ++s)
      if (sim.world.is_movable(s)) return sim.world.position[s].z() - 0.5;
    return 0.0;
  };
  std::vector<double> found;
  double h[3] = {height(), height(), height()};
  while (found.size() < 3 && sim.world.time < 5.0) {
    REQUIRE(!sim.advance(false));
    h[0] = h[1];
    h[1] = h[2];
    h[2] = height();
    const bool fell = sim.world.time > 0.4;  // the first apex is the start
    if (fell && h[1] >= h[0] && h[1] > h[2]) {
      const double a = 0.5 * (h[2] - 2.0 * h[1] + h[0]), b = 0.5 * (h[2] - h[0]);
      found.push_back(h[1] - 0.25 * b * b / a);
    }
  }
  return found;
}
}  // namespace

TEST_CASE("a bouncing ball returns to e^2 of its height where impacts are located in the step", "[physics][impact]") {
  for (const double e : {0.5, 0.9}) {
    const auto located = apexes(e, "sequential", "\"= 1/240\"");
    REQUIRE(located.size() == 3);
    for (int k = 0; k < 3; ++k)
      CHECK(located[static_cast<std::size_t>(k)] == Approx(std::pow(e, 2 * (k + 1))).epsilon(1e-12));
    // impacts at the middle of the step miss the first apex by more than all three here together
    const auto middle = apexes(e, "newton", "\"= 1/240\"");
    CHECK(std::abs(middle.at(0) - e * e) > 4.0 * std::abs(located[0] - e * e));
  }
}

namespace {
/// Boxes of side `edge` under non-smooth contact, with gravity along -z and perhaps along x.
struct RandomBoxes {
  double edge, restitution, friction, dt;
  std::string law = "energetic";
  double slope = 0.0;  ///< acceleration along x [m/s^2]
};

std::string boxes_head(const RandomBoxes& x, double duration) {
  std::ostringstream out;
  out << "run = { duration = " << duration << ", time_step = " << x.dt << ", output_interval = " << 100 * x.dt << " }\n"
      << "world = { gravity = [" << x.slope << ", 0, -9.81] }\n"
      << "material.m = { density = 2000.0 }\n"
      << "contact = { method = \"nonsmooth\", restitution = " << x.restitution << ", friction = " << x.friction
      << ", nonsmooth = { impact = \"" << x.law << "\" } }\n";
  return out.str();
}

std::string half_space(const std::string& normal, const std::string& position) {
  return "[[body]]\nshape = { half_space = { normal = [" + normal +
         "] } }\nmaterial = \"m\"\nfixed = true\nposition = [" + position + "]\n";
}
}  // namespace

TEST_CASE("stacks at rest stay at rest whatever the restitution, the law of impact and the step",
          "[physics][impact][rest]") {
  // A support that is let go for a step sinks by g dt^2 = 1e-3 to 1e-5 of the box. Gaps at the start are those that a
  // stack closes with less than the threshold of impacts.
  const std::string laws[] = {"energetic", "newton", "poisson", "sequential"};
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    Random random(19, seed);
    const double edge = std::pow(10.0, random.uniform(-2, 1)), height = 0.3 * edge;
    RandomBoxes x{.edge = edge,
                  .restitution = random.uniform(0.3, 1.0),
                  .friction = random.uniform(0.3, 0.9),
                  .dt = std::sqrt(edge) * std::pow(10.0, random.uniform(-3, -2)),
                  .law = laws[seed % 4],
                  .slope = seed % 3 == 0 ? 1.0 : 0.0};
    const int count = 2 + static_cast<int>(seed % 6);
    const double gap = seed % 2 == 0 ? 0.0 : 1e-9 * edge;
    std::ostringstream scene;
    scene.precision(17);
    scene << boxes_head(x, 100 * x.dt) << half_space("0, 0, 1", "0, 0, 0");
    for (int i = 0; i < count; ++i)
      scene << "[[body]]\nshape = { box = { size = [" << edge << ", " << edge * random.uniform(0.6, 1.0) << ", "
            << height << "] } }\nmaterial = \"m\"\nposition = [" << 0.1 * edge * random.uniform(-1, 1) << ", "
            << 0.1 * edge * random.uniform(-1, 1) << ", " << (i + 0.5) * height + (i + 1) * gap
            << "]\neuler_deg = [0, 0, " << random.uniform(0, 20) << "]\n";
    SceneRun run = start_text(scene.str());
    const World& world = run.simulation().world;
    std::vector<Vec3> before;
    for (Slot s = 0; s < world.size(); ++s) before.push_back(world.position[s]);
    run.advance_to(0);
    INFO("seed " << seed << ": " << count << " boxes of " << edge << " m, e " << x.restitution << ", " << x.law
                 << ", step " << x.dt);
    REQUIRE(run.failure.empty());
    for (Slot s = 0; s < world.size(); ++s) CHECK((world.position[s] - before[s]).norm() < 1e-6 * edge);
    CHECK(run.simulation().ledger.last().correction == 0.0);
  }
}

TEST_CASE("piles of forty boxes with e = 0.9 gain no energy in any step", "[physics][impact][energy]") {
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    Random random(23, seed);
    RandomBoxes x{.edge = 0.1, .restitution = 0.9, .friction = 0.2 + 0.4 * static_cast<double>(seed), .dt = 4e-3};
    std::ostringstream scene;
    scene << boxes_head(x, 0.18) << half_space("0, 0, 1", "0, 0, 0") << half_space("1, 0, 0", "-0.2, 0, 0")
          << half_space("-1, 0, 0", "0.2, 0, 0") << half_space("0, 1, 0", "0, -0.2, 0")
          << half_space("0, -1, 0", "0, 0.2, 0");
    for (int i = 0; i < 40; ++i)
      scene << "[[body]]\nshape = { box = { size = [0.1, 0.08, 0.06] } }\nmaterial = \"m\"\nposition = ["
            << -0.13 + 0.13 * (i % 3) << ", " << -0.13 + 0.13 * (i / 3 % 3) << ", " << 0.08 + 0.14 * (i / 9)
            << "]\neuler_deg = [" << random.uniform(-180, 180) << ", " << random.uniform(-180, 180)
            << ", 0]\nvelocity = [" << random.uniform(-1, 1) << ", " << random.uniform(-1, 1) << ", "
            << random.uniform(-5, -3) << "]\n";
    SceneRun run = start_text(scene.str());
    Simulation& sim = run.simulation();
    sim.ledger.measure(sim.world);
    const double start = sim.ledger.last().kinetic;
    double gained = 0.0, touching = 0.0;
    while (sim.steps() < run.assembly->steps) {
      REQUIRE(!sim.advance(false));
      gained = std::max(gained, -sim.work.report.dissipated);
      touching = std::max(touching, static_cast<double>(sim.work.report.touching));
    }
    INFO("seed " << seed << ": gained " << gained / start << ", contacts " << touching);
    CHECK(gained < 1e-7 * start);  // the solver's tolerance of 1e-6, by the speed of what is left in the contacts
    CHECK(touching > 25);
  }
}
