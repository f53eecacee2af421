// What is told of stages to come before they begin, and of scenes that a run goes on with.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "scenes/cli/commands.h"
#include "scenes/session.h"
#include "scenes/stage_check.h"
#include "tests/support/captured.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/viz_export/temporary_folder.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

const std::string told_scene =
    "[run]\ntime_step = 1e-3\noutput_interval = 0.1\n[material.m]\ndensity = 2000\nyoungs_modulus = 1e6\n"
    "poissons_ratio = 0.3\n[contact]\nmethod = \"smooth\"\nrestitution = 0.5\nfriction = 0.5\n[[body]]\nname = \"a\"\n"
    "shape = { sphere = { radius = 0.1 } }\nmaterial = \"m\"\n[[body]]\nname = \"b\"\n"
    "shape = { sphere = { radius = 0.1 } }\nposition = [1, 0, 0]\nmaterial = \"m\"\n[[spring]]\nname = \"s\"\n"
    "body = \"a\"\nto = \"b\"\nstiffness = [10, 10, 10]\n[[measure]]\nname = \"e\"\nkind = \"energy\"\n"
    "[[stage]]\nname = \"one\"\nduration = 0.02\n";

fs::path told_file(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
  std::ofstream(folder / name) << text;
  return folder / name;
}

template <class Command>
Captured told_by(const Command& command) {
  return captured([&] { return guarded(command); });
}

}  // namespace

TEST_CASE("check and run tell of a step that is longer than a later stage, once", "[scenes][stages][warnings]") {
  const TemporaryFolder folder;
  const fs::path scene = told_file(folder, "short.toml",
                                   told_scene +
                                       "[[stage]]\nname = \"two\"\nduration = 1e-4\n[[stage]]\nname = "
                                       "\"three\"\nduration = 0.01\n[[stage]]\nname = \"four\"\nduration = 2e-4\n");
  CommonOptions common;
  common.scene = scene.string();
  const Captured check = told_by([&] { return command_check(common); });
  CHECK(check.code == exit_done);
  for (const char* length : {"longer than the 0.0001 s", "longer than the 0.0002 s"}) {
    const auto first = check.err.find(length);
    CHECK(first != std::string::npos);
    CHECK(check.err.find(length, first + 1) == std::string::npos);
  }
  RunOptions run;
  run.out = (folder / "out").string();
  run.threads = 1;
  CHECK_THAT(told_by([&] { return command_run(common, run); }).err, Catch::Contains("longer than the 0.0002 s"));
}

TEST_CASE("a spring whose body a stage removes is reported", "[scenes][stages][warnings]") {
  const TemporaryFolder folder;
  CommonOptions common;
  common.scene = told_file(folder, "lost.toml",
                           told_scene + "[[stage]]\nname = \"two\"\nduration = 0.01\nbody.b = { remove = true }\n")
                     .string();
  RunOptions run;
  run.out = (folder / "out").string();
  run.threads = 1;
  const Captured told = told_by([&] { return command_run(common, run); });
  CHECK(told.code == exit_done);
  CHECK_THAT(told.err, Catch::Contains("stage 'two': dropped: 1 of 1 springs: a body that they hold is gone"));
  std::ifstream summary(folder / "out" / "summary.json");
  const std::string written{std::istreambuf_iterator<char>(summary), {}};
  CHECK_THAT(written, Catch::Contains("dropped: 1 of 1 springs"));
}

TEST_CASE("a run is not continued with a scene or change whose conditions ask for what is not there",
          "[scenes][stages][restart]") {
  const TemporaryFolder folder;
  CommonOptions common;
  common.scene = told_file(folder, "first.toml", told_scene).string();
  RunOptions run;
  run.out = (folder / "out").string();
  run.threads = 1;
  run.quiet = true;
  REQUIRE(told_by([&] { return command_run(common, run); }).code == exit_done);
  const std::string until = "until = { measure = \"e\", component = \"kinetc\", above = 1.0, at_most = 0.1 }\n";
  std::string at_once = told_scene, later = told_scene + "[[stage]]\nname = \"two\"\n" + until;
  at_once.replace(at_once.find("duration"), std::string::npos, until);
  for (const std::string& next : {at_once, later}) {
    ResumeChanges changes;
    changes.scene = told_file(folder, "next.toml", next).string();
    const Captured refused = told_by([&] { return command_resume(run.out, run, changes); });
    CHECK(refused.code == exit_usage);
    CHECK_THAT(refused.err, Catch::Contains("unknown component 'kinetc' of the measure 'e'"));
  }
  ResumeChanges changes;
  changes.overrides = {"bounds.measure=[{ measure = \"e\", component = \"kinetc\", below = 1.0 }]"};
  run.until = 0.05;
  const Captured refused = told_by([&] { return command_resume(run.out, run, changes); });
  CHECK(refused.code == exit_usage);
  CHECK_THAT(refused.err, Catch::Contains("unknown component 'kinetc'"));
  changes.overrides = {"contact.friction=0.1"};  // the folder is as it was
  CHECK(told_by([&] { return command_resume(run.out, run, changes); }).code == exit_done);
}

namespace {

struct ChangeOfLaw {
  std::string law, key;
  double low, high;
};

/// Balls that have fallen into a narrow box, by the loop of spheres or the generic one, and a change two steps before
/// the end.
std::string changed_bed(const ChangeOfLaw& change, bool fused, std::mt19937& engine) {
  const auto draw = [&](double low, double high) { return std::uniform_real_distribution(low, high)(engine); };
  std::string text =
      "run = { time_step = 2e-5, output_interval = 0.1 }\nworld = { gravity = [" + std::to_string(draw(-2, 2)) +
      ", 0, -9.81] }\nmaterial.m = { density = 2500.0, youngs_modulus = \"5 MPa\", poissons_ratio = 0.3 }\n"
      "[contact]\nmethod = \"smooth\"\nrestitution = 0.2\nfriction = 0.5\nrolling_friction = 0.1\nsmooth = { " +
      change.law + " }\n";
  for (const char* wall : {"[0, 0, 1]", "[1, 0, 0]", "[-1, 0, 0]", "[0, 1, 0]", "[0, -1, 0]"})
    text += std::string("[[body]]\nmaterial = \"m\"\nfixed = true\nshape = { half_space = { normal = ") + wall +
            " } }\nposition = " +
            (wall[1] == '-'   ? "[0.02, 0, 0]\n"
             : wall[4] == '-' ? "[0, 0.02, 0]\n"
                              : "[0, 0, 0]\n");
  if (fused)
    text +=
        "[shape.g]\nsphere = { radius = 0.003 }\n[[fill]]\nshape = \"g\"\nmaterial = \"m\"\ncount = 27\nvelocity = "
        "[0, 0, -1]\nregion = { box = { min = [0, 0, 0], max = [0.02, 0.02, 0.05] } }\n";
  else
    text +=
        "[[body]]\nname = \"g\"\nrepeat = [3, 3, 3]\nshape = { sphere = { radius = 0.003 } }\nmaterial = "
        "\"m\"\nvelocity "
        "= [0, 0, -1]\nposition = [\"= 0.0035 + 0.0064*i + 0.0001*k\", \"= 0.0033 + 0.0063*j + 0.0002*k\", \"= 0.0035 "
        "+ "
        "0.0064*k + 0.0002*i\"]\n";
  return text + "[[stage]]\nname = \"settle\"\nduration = 0.1\n[[stage]]\nname = \"change\"\nduration = 4e-5\n" +
         change.key + " = " + std::to_string(draw(change.low, change.high)) + "\n";
}

double balance_of(const RunSummary::Energy& e) {
  return e.kinetic + e.potential + e.elastic.value_or(0.0) + e.dissipated - e.work;
}

}  // namespace

TEST_CASE("the ledger closes where a stage changes the law, as it does between steps", "[scenes][stages][warnings]") {
  const std::string hertz = "law = \"hertz\"", linear = "law = \"linear\", stiffness = 3000.0";
  const std::vector<ChangeOfLaw> changes{
      {hertz, "contact.friction", 0.02, 0.2},
      {hertz, "contact.rolling_friction", 0.002, 0.05},
      {hertz, "material.m.youngs_modulus", 1e6, 2e7},
      {linear, "contact.smooth.stiffness", 1000, 9000},
      {linear, "contact.smooth.tangential_ratio", 0.1, 1.5},
      {"law = \"walton-braun\", stiffness = 3000.0", "contact.friction", 0.02, 0.2},
      {"law = \"jkr\", work_of_adhesion = 0.01", "contact.smooth.work_of_adhesion", 0.001, 0.05}};
  std::mt19937 engine(4);
  for (const ChangeOfLaw& change : changes)
    for (const bool fused : {true, false}) {
      const TemporaryFolder folder;
      const std::string text = changed_bed(change, fused, engine);
      INFO(text);
      ReadResult read = read_scene_text(text, "s.toml", {}, full_registry());
      REQUIRE(read.scene);
      Session session(assemble(std::move(*read.scene)), {}, folder / "out");
      SessionLimits limits;
      limits.until = 0.1;
      REQUIRE(session.run(limits, true) == Ending::until);
      const RunSummary::Energy before = *session.summary().energy;
      REQUIRE(session.run({}, true) == Ending::completed);
      const double gap = std::abs(balance_of(*session.summary().energy) - balance_of(before));
      // contacts that began in the step before count in whole where forces are found anew; 0.04 to 0.15 of double
      // springs
      CHECK(gap < 0.02 * std::abs(before.elastic.value()));
    }
}

TEST_CASE("a cell that ends without its pressure has it in its warnings", "[scenes][stages][warnings]") {
  const TemporaryFolder folder;
  std::mt19937 random(23);
  for (int draw = 0; draw < 4; ++draw) {
    const double pressure = std::pow(10.0, 3.0 + 2.0 * std::uniform_real_distribution<double>()(random));
    std::string cell = told_scene;
    const std::size_t spring = cell.find("[[spring]]");
    cell.erase(spring, cell.find("[[measure]]") - spring);
    cell.replace(
        cell.find("[material.m]"), 0,
        fmt::format("[world]\ndomain = {{ min = [-0.2, -0.2, -0.2], max = [2, 2, 2], periodic = [\"x\", \"y\", "
                    "\"z\"], pressure = {} }}\n",
                    pressure));
    CommonOptions common;
    common.scene = told_file(folder, "cell.toml", cell).string();
    RunOptions run;
    run.out = (folder / fmt::format("out{}", draw)).string();
    run.threads = 1;
    run.quiet = true;
    const Captured told = told_by([&] { return command_run(common, run); });
    CHECK(told.code == exit_done);
    CHECK_THAT(told.err, Catch::Contains(fmt::format("not of {:.3g} Pa", pressure)));
  }
}

TEST_CASE("rolling friction without friction is told and does nothing", "[scenes][warnings]") {
  const TemporaryFolder folder;
  std::mt19937 random(24);
  for (const char* law : {"", "[contact.smooth]\nrolling = \"spring\"\n"}) {
    std::string scene = told_scene;
    const double mu = std::uniform_real_distribution<double>(0.01, 1.0)(random);
    scene.replace(scene.find("friction = 0.5"), 14, fmt::format("friction = 0\nrolling_friction = {}\n{}", mu, law));
    CommonOptions common;
    common.scene = told_file(folder, "rolls.toml", scene).string();
    const Captured check = told_by([&] { return command_check(common); });
    CHECK(check.code == exit_done);
    CHECK_THAT(check.err, Catch::Contains("rolling_friction does nothing without friction"));
  }
}
