// What a scene file can do: fill its output folder, nothing else. Names that look like paths or commands stay names.
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "detection/convex_corpus.h"
#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/session.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/hdf5/problem_file.h"
#include "viz_export/report/charts.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

const char* hostile = R"TOML(
title = '`touch TOUCHED` $(touch TOUCHED) "; system("touch TOUCHED")'
run = { duration = 0.01, time_step = 1e-3, output_interval = 5e-3 }
world = { gravity = [0, 0, -9.81] }
material."../../m" = { density = 2500.0, youngs_modulus = "5 MPa", poissons_ratio = 0.3 }
contact = { method = "nonsmooth", restitution = 0.5, friction = 0.5 }
output = { problems = { every = 1e-3 } }
[shape."../../../s"]
sphere = { radius = 0.01 }
[[body]]
name = "../../../floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "../../m"
fixed = true
[[body]]
name = "/tmp/`touch TOUCHED`\n\"x\", ..\\..\\y"
shape = "../../../s"
material = "../../m"
position = [0, 0, 0.0099]
[[measure]]
name = "../../../../measure/../../x"
kind = "position"
body = "/tmp/`touch TOUCHED`\n\"x\", ..\\..\\y"
[[measure]]
name = "/etc/passwd"
kind = "energy"
)TOML";

std::set<std::string> tree(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    names.insert(fs::relative(entry.path(), folder).string());
  return names;
}

}  // namespace

TEST_CASE("a scene writes into its output folder and nowhere else, whatever its names say", "[scenes][security]") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "deep/er/out");
  const fs::path before = fs::current_path();
  fs::current_path(folder / "deep");
  ReadResult read = read_scene_text(hostile, "../../scene.toml", {}, full_registry());
  INFO((read.problems.empty() ? "" : read.problems[0].to_string()));
  REQUIRE(read.scene);
  Session session(assemble(std::move(*read.scene)), {}, folder / "deep/er/out");
  CHECK(session.run({}, true) == Ending::completed);
  write_summary(folder / "deep/er/out/summary.json", session.summary());
  fs::current_path(before);
  for (const std::string& name : tree(folder.path())) {
    INFO(name);
    CHECK((name == "deep" || name == "deep/er" || name.rfind("deep/er/out", 0) == 0));
    CHECK(name.find("TOUCHED") == std::string::npos);
  }
  const auto inside = tree(folder / "deep/er/out");
  CHECK(inside.count("run.h5") == 1);
  CHECK(inside.count("problems") == 1);
}

TEST_CASE("a chart's titles and file names run no command", "[scenes][security]") {
  const TemporaryFolder folder;
  const std::string text = "`touch TOUCHED` \\`touch TOUCHED\\` $(touch TOUCHED) \"\nsystem('touch TOUCHED')\n";
  LinePlot plot;
  plot.title = plot.x_label = plot.y_label = text;
  plot.lines.push_back({text, {{0, 1}, {1, 2}}, {}});
  draw(plot, folder / "it's'; system('touch TOUCHED'); '");
  for (const std::string& name : tree(folder.path())) CHECK(name != "TOUCHED");
}

TEST_CASE("pipes and devices are refused where a file is wanted, not waited for", "[scenes][security]") {
  const TemporaryFolder folder;
  for (const char* name : {"pipe", "pipe.dat", "pipe.csv"}) REQUIRE(::mkfifo((folder / name).c_str(), 0600) == 0);
  const auto path = [&](const char* name) { return (folder / name).string(); };
  CHECK_THROWS_WITH(read_corpus(path("pipe")), Catch::Contains("there is no file"));
  CHECK_THROWS_WITH(read_corpus("/dev/zero"), Catch::Contains("there is no file '/dev/zero'"));
  CHECK_THROWS_WITH(read_problem(path("pipe.dat")), Catch::Contains("cannot be opened"));
  CHECK_THROWS_AS(read_problem(path("pipe")), FileError);
  CHECK_FALSE(read_scene(path("pipe"), {}, full_registry()).scene);
  const std::string scene = path("scene.toml");
  for (const char* body : {"[[body]]\nshape = { mesh = { file = \"pipe\" } }\nmaterial = \"m\"\nfixed = true\n",
                           "[[bodies]]\nname = \"p\"\nmaterial = \"m\"\nfile = \"pipe.csv\"\n"}) {
    std::ofstream(scene)
        << "run = { duration = 1.0 }\ncontact = { method = \"smooth\", restitution = 0.5, friction = 0.1 }\n"
           "material.m = { density = 2500.0, youngs_modulus = 1e6, poissons_ratio = 0.3 }\n"
        << body;
    const ReadResult read = read_scene(scene, {}, full_registry());
    REQUIRE(read.problems.size() == 1);
    CHECK_THAT(read.problems[0].text, Catch::Contains("there is no file"));
  }
}
