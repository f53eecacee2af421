// Springs of a run as tables of a scene that starts from its bodies: what they carry, by random bodies and springs.
#include <fmt/format.h>

#include <fstream>

#include "engine/units/random.h"
#include "scenes/session.h"
#include "scenes/spring_file.h"
#include "scenes/start_run.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/output/export.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

std::string vec(Random& random, double low, double high) {
  const double x = random.uniform(low, high), y = random.uniform(low, high), z = random.uniform(low, high);
  return fmt::format("[{:.9g}, {:.9g}, {:.9g}]", x, y, z);
}

std::string head(bool smooth) {
  return fmt::format(R"(run = {{ duration = 0.02, time_step = 1e-5, output_interval = 0.01 }}
world = {{ gravity = [0, 0, -9.81] }}
material.m = {{ density = 2000, youngs_modulus = "10 MPa", poissons_ratio = 0.25 }}
shape.brick = {{ box = {{ size = [0.03, 0.02, 0.01] }} }}
contact = {{ method = "{}", restitution = 0.3, friction = 0.3{} }}
[[body]]
name = "arm"
shape = "brick"
material = "m"
position = [0, 0, 1]
motion = {{ velocity = [0.1, 0, 0] }}
)",
                     smooth ? "smooth" : "nonsmooth", smooth ? ", smooth = { law = \"hertz\" }" : "");
}

/// A lone brick and a row of them, 0.1 m apart and in no contact.
std::string bricks(Random& random) {
  std::string text = fmt::format(
      "[[body]]\nname = \"lone\"\nshape = \"brick\"\nmaterial = \"m\"\nposition = [0, 0.5, "
      "1]\nvelocity = {}\nangular_velocity = {}\neuler_deg = {}\n",
      vec(random, -1, 1), vec(random, -5, 5), vec(random, -90, 90));
  return text + fmt::format(
                    "[[body]]\nname = \"row\"\nrepeat = 3\nshape = \"brick\"\nmaterial = \"m\"\nposition = "
                    "[\"= 0.1*i\", 0, 0.7]\nvelocity = {}\nangular_velocity = {}\neuler_deg = {}\n",
                    vec(random, -1, 1), vec(random, -5, 5), vec(random, -90, 90));
}

std::string spring(Random& random, const std::string& body, const std::string& to) {
  return fmt::format(
      "[[spring]]\nname = \"s\"\nbody = \"{}\"\n{}attachment = {}\nstiffness = {}\ndamping = {}\npreload = {}\n", body,
      to.empty() ? fmt::format("speed = {:.9g}\n", random.uniform(-1, 1)) : "to = \"" + to + "\"\n",
      vec(random, -0.02, 0.02), vec(random, 10, 100), vec(random, 0, 0.1), vec(random, -0.1, 0.1));
}

std::unique_ptr<Assembly> assembled(const std::string& text, const std::filesystem::path& folder) {
  ReadResult read = read_scene_text(text, (folder / "scene.toml").string(), {}, full_registry());
  for (const Problem& p : read.problems) UNSCOPED_INFO(p.to_string());
  REQUIRE(read.scene);
  return assemble(std::move(*read.scene));
}

void advance(Simulation& sim, std::uint64_t steps) {
  for (std::uint64_t k = 0; k < steps; ++k) REQUIRE(!sim.advance(false));
}

}  // namespace

TEST_CASE("a run that starts from exported bodies and springs goes on with their energies", "[scenes][export]") {
  for (std::uint64_t draw = 0; draw < 12; ++draw) {
    Random random(41, draw);
    const bool smooth = draw % 2 == 0;
    INFO("draw " << draw);
    const TemporaryFolder folder;
    std::string springs = spring(random, "lone", "") + spring(random, "row[1]", "arm");
    springs += spring(random, "row[0]", "row[1]") + spring(random, "row[2]", "lone");
    const std::string bodies = bricks(random), path = (folder.path() / "scene.toml").string();
    std::ofstream(path) << head(smooth) << bodies << springs;
    ReadResult read = read_scene(path, {}, full_registry());
    REQUIRE(read.scene);
    Session run(assemble(std::move(*read.scene)), {}, folder / "out");
    REQUIRE(run.run({}, true) == Ending::completed);
    export_run(folder / "out", ExportFormat::csv);
    CHECK_THAT(export_springs(folder / "out"), Catch::Contains("springs.toml holds"));
    auto again = assembled(
        "include = [\"out/springs.toml\"]\n" + head(smooth) + "[[bodies]]\nfile = \"out/bodies.csv\"\n", folder.path());
    Simulation &was = *run.assembly().simulation, &is = *again->simulation;
    is.start();
    REQUIRE(again->scene.springs.size() == 4);
    const Energy before = was.ledger.measure(was.world), after = is.ledger.measure(is.world);
    CHECK(before.elastic > 0.0);
    // a non-smooth step tells its springs at the pose of its middle gone on for half a step: (dt omega)^2, 1e-8
    CHECK(after.elastic == Approx(before.elastic).epsilon(smooth ? 1e-9 : 1e-7));
    CHECK(after.kinetic == Approx(before.kinetic).epsilon(1e-9));
  }
}

TEST_CASE("exported springs carry on as those of the run do, beside a standing arm", "[scenes][export]") {
  for (std::uint64_t draw = 0; draw < 8; ++draw) {
    Random random(42, draw);
    const bool smooth = draw % 2 == 0;
    INFO("draw " << draw);
    const TemporaryFolder folder;
    std::string standing = head(smooth);
    standing.replace(standing.find("motion = { velocity = [0.1, 0, 0] }"), 35, "fixed = true");
    const std::string text = standing + bricks(random) + spring(random, "row[1]", "arm") +
                             spring(random, "row[0]", "row[1]") + spring(random, "row[2]", "lone");
    const std::string path = (folder.path() / "scene.toml").string();
    std::ofstream(path) << text;
    ReadResult read = read_scene(path, {}, full_registry());
    REQUIRE(read.scene);
    Session run(assemble(std::move(*read.scene)), {}, folder / "out");
    REQUIRE(run.run({}, true) == Ending::completed);
    export_run(folder / "out", ExportFormat::csv);
    export_springs(folder / "out");
    auto again = assembled("include = [\"out/springs.toml\"]\n" + standing + "[[bodies]]\nfile = \"out/bodies.csv\"\n",
                           folder.path());
    Simulation &was = *run.assembly().simulation, &is = *again->simulation;
    is.start();
    advance(was, 200);
    advance(is, 200);
    for (Slot s = 0; s < was.world.size(); ++s) {
      const Slot t = is.world.slot_of(was.world.id[s]);
      // rounding of the files, 1e-16 m, grows with the oscillation of 200 steps at most
      CHECK((was.world.position[s] - is.world.position[t]).norm() < 1e-10);
    }
  }
}

TEST_CASE("resuming the folder of a sweep names the runs that are not complete", "[scenes][resume]") {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "scene.toml").string();
  Random random(43, 0);
  std::ofstream(path) << head(true) << bricks(random);
  for (const std::string name : {"case_0000", "case_0001", "case_0002"}) {
    ReadResult read = read_scene(path, {}, full_registry());
    REQUIRE(read.scene);
    std::filesystem::create_directories(folder / "sweep" / name);
    SessionLimits limits;
    if (name != "case_0000") limits.steps = 50;  // of 2000
    Session run(assemble(std::move(*read.scene)), {}, folder / "sweep" / name);
    const bool ended = run.run(limits, true) == Ending::completed;
    std::ofstream(folder / "sweep" / name / "summary.json") << (ended ? R"({"status": "completed"})" : "{}");
  }
  CHECK_NOTHROW(check_is_run(folder / "sweep/case_0000"));
  CHECK_THROWS_WITH(check_is_run(folder / "sweep"), Catch::Contains("is the folder of a sweep, with 3 runs") &&
                                                        Catch::Contains("case_0001', '") &&
                                                        Catch::Contains("case_0002'") && !Catch::Contains("case_0000"));
  CHECK_THROWS_WITH(check_is_run(folder.path()), Catch::Contains("there is no run in"));
}
