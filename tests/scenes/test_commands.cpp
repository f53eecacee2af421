// The commands of the program: what they print, and with which code they end.
#include "scenes/cli/commands.h"

#include <cmath>
#include <fstream>
#include <new>
#include <random>
#include <stdexcept>

#include "engine/units/error.h"
#include "scenes/assemble.h"
#include "scenes/cli/library.h"
#include "scenes/cli/new_scene.h"
#include "scenes/cli/study_commands.h"
#include "scenes/folder_lock.h"
#include "scenes/full_registry.h"
#include "scenes/predicted_time.h"
#include "scenes/reader/scene_reader.h"
#include "tests/support/captured_run.h"
#include "tests/support/catch.h"
#include "tests/support/document.h"
#include "tests/support/scene_text.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/files/side_file.h"

using namespace epafi;
using experiments::half_space_floor;
namespace fs = std::filesystem;

namespace {

const std::string root = EPAFI_SOURCE_DIR;

/// A ball that falls onto a floor for 0.1 s.
fs::path ball_in(const TemporaryFolder& folder, const std::string& more = {}) {
  const fs::path file = folder / "ball.toml";
  std::ofstream(file) << R"(run = { duration = 0.1, time_step = 1e-3, output_interval = 0.05 }
world = { gravity = [0, 0, -9.81] }
material.m = { density = 2500.0, youngs_modulus = "5 MPa", poissons_ratio = 0.3 }
contact = { method = "nonsmooth", restitution = 0.5, friction = 0.5 }
)" << half_space_floor("m")
                      << R"([[body]]
name = "ball"
shape = { sphere = { radius = 0.01 } }
material = "m"
position = [0, 0, 0.02]
velocity = [0.5, 0, 0]
)" << more;
  return file;
}

}  // namespace

TEST_CASE("lists, schema and reference are printed by the program as the tree has them", "[scenes][commands]") {
  const Captured scenes = captured([] { return command_list("scenes"); });
  CHECK(scenes.code == exit_done);
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(library_folder())) {
    if (entry.path().extension() != ".toml") continue;
    ++files;
    CHECK_THAT(scenes.out, Catch::Contains("  " + entry.path().lexically_relative(library_folder()).string()));
  }
  CHECK(std::count(scenes.out.begin(), scenes.out.end(), '\n') == static_cast<std::ptrdiff_t>(files) + 1);
  CHECK_THAT(captured([] { return command_list("solvers"); }).out, Catch::Contains("pgs"));
  CHECK(captured([] { return command_schema(); }).out == support::read_text(root + "/scenes/scene.schema.json"));
  const TemporaryFolder folder;
  CHECK(command_reference((folder / "pages").string(), root + "/tests/data/broken") == exit_done);
  std::size_t pages = 0;
  for (const auto& entry : fs::directory_iterator(folder / "pages")) {
    ++pages;
    CHECK(support::read_text(entry.path()) ==
          support::read_text(root + "/docs/reference/" + entry.path().filename().string()));
  }
  CHECK(pages > 5);
}

TEST_CASE("a starter scene is printed, checked, explained and run by the program", "[scenes][commands]") {
  const TemporaryFolder folder;
  for (const std::string& kind : starter_kinds()) {
    INFO(kind);
    const fs::path file = folder / (kind + ".toml");
    std::ofstream(file) << captured([&] { return command_new(kind); }).out;
    const Captured check = captured([&] { return command_check({file.string(), {}}); });
    CHECK(check.code == exit_done);
    CHECK_THAT(check.out, Catch::Contains("time step") && Catch::Contains("memory"));
    CHECK_THAT(captured([&] { return command_explain({file.string(), {}}); }).out, Catch::Contains("broad phase"));
    RunOptions few;
    few.out = (folder / kind).string();
    few.steps = 5;
    few.quiet = true;
    few.json = true;
    few.threads = 1;
    const Captured run = run_of(file, few);
    CHECK(run.code == exit_done);
    CHECK_THAT(run.out, Catch::Contains("\"steps\": 5"));
  }
}

TEST_CASE("a check counts what is poured in later, and does not tell the time of a step that is not there yet",
          "[scenes][commands]") {
  const TemporaryFolder folder;
  const auto check = [&](const std::string& more) {
    const Captured c = captured([&] { return command_check({ball_in(folder, more).string(), {}}); });
    REQUIRE(c.code == exit_done);
    return c.out;
  };
  const auto megabytes = [](const std::string& text) { return std::stod(text.substr(text.find("about ") + 6)); };
  const std::string one = check("");
  CHECK_THAT(one, Catch::Contains("1 free, 1 fixed or driven\n") && Catch::Contains("wall time     about"));
  const std::string many = check(R"([[fill]]
name = "rain"
shape = "drop"
material = "m"
count = 100000
method = "pour"
rate = 1e6
region = { box = { min = [-1, -1, 0.5], max = [1, 1, 1] } }
[shape.drop]
sphere = { radius = 0.001 }
)");
  CHECK_THAT(many, Catch::Contains("1 free, 1 fixed or driven, 100000 poured in later") &&
                       Catch::Contains("wall time     unknown: nearly all bodies enter"));
  // a state of 100 bytes and a contact of 100 each at least
  CHECK(megabytes(many.substr(many.find("memory"))) > megabytes(one.substr(one.find("memory"))) + 20.0);
}

TEST_CASE("output is predicted by the points that its frames draw, of the bodies that stay", "[scenes][predicted]") {
  const TemporaryFolder folder;
  const fs::path file = folder / "outputs.toml";
  const auto output = [&](const std::string& shape, int count, const std::string& domain = "") {
    std::ofstream(file)
        << "run = { duration = 1e-3, time_step = 1e-5, output_interval = 1e-5 }\nworld = { gravity = [0, 0, -9.81]" +
               domain + " }\nmaterial.m = { density = 2500, youngs_modulus = \"1 MPa\", poissons_ratio = 0.3 }\n" +
               "contact = { method = \"smooth\", restitution = 0.5, friction = 0 }\nshape.s = { " + shape +
               " }\n[[fill]]\nshape = \"s\"\nmaterial = \"m\"\ncount = " + std::to_string(count) +
               "\nregion = { box = { min = [0, 0, 0], max = [1, 1, 1] } }\n";
    const std::string text = captured([&] { return command_check({file.string(), {}}); }).out;
    const std::size_t end = text.find(" s of output"), begin = text.rfind(' ', end - 1);
    REQUIRE(end != std::string::npos);
    return std::stod(text.substr(begin));
  };
  const double spheres = output("sphere = { radius = 0.01 }", 400),
               boxes = output("box = { size = [0.02, 0.02, 0.02] }", 400);
  const double clumps = output("clump = { spheres = [[-0.01, 0, 0, 0.01], [0.01, 0, 0, 0.01]] }", 400);
  CHECK(boxes > 1.5 * spheres);
  CHECK(clumps > 5.0 * boxes);  // 124 points for 8
  CHECK(output("clump = { spheres = [[-0.01, 0, 0, 0.01], [0.01, 0, 0, 0.01]] }", 100) < 0.5 * clumps);
  const double most_leave = output("clump = { spheres = [[-0.01, 0, 0, 0.01], [0.01, 0, 0, 0.01]] }", 400,
                                   ", domain = { min = [0, 0, 0], max = [0.1, 1, 1], outside = \"delete\" }");
  CHECK(most_leave < 0.4 * clumps);
}

TEST_CASE("bodies that are no balls are predicted by what their contacts cost", "[scenes][predicted]") {
  const TemporaryFolder folder;
  const fs::path file = folder / "kinds.toml";
  const auto steps = [&](const std::string& shape) {
    std::ofstream(file) << "run = { duration = 2.0, time_step = 1e-5 }\nworld = { gravity = [0, 0, -9.81] }\n"
                           "material.m = { density = 2500, youngs_modulus = \"1 MPa\", poissons_ratio = 0.3 }\n"
                           "contact = { method = \"smooth\", restitution = 0.5, friction = 0 }\nshape.s = { " +
                               shape +
                               " }\n[[fill]]\nshape = \"s\"\nmaterial = \"m\"\ncount = 400\nregion = { box = { min "
                               "= [0, 0, 0], max = [1, 1, 1] } }\n";
    const std::string text = captured([&] { return command_check({file.string(), {}}); }).out;
    const std::size_t end = text.find(" s of steps"), begin = text.rfind(' ', end - 1);
    REQUIRE(end != std::string::npos);
    return std::stod(text.substr(begin));
  };
  const double ellipsoids = steps("ellipsoid = { semi_axes = [0.01, 0.02, 0.01] }");
  CHECK(ellipsoids > 3.0 * steps("sphere = { radius = 0.01 }"));
  CHECK(ellipsoids > 1.5 * steps("capsule = { radius = 0.01, length = 0.01 }"));
  CHECK(steps("superquadric = { semi_axes = [0.01, 0.02, 0.01], across = 4, along = 4 }") > 1.5 * ellipsoids);
}

TEST_CASE("loops over few bodies are not shared out over threads", "[scenes][predicted]") {
  CHECK(wall_seconds(10.0, 60.0, 8.0) == 10.0);
  CHECK(wall_seconds(10.0, 1024.0, 8.0) == Approx(5.0));
  CHECK(wall_seconds(10.0, 1e6, 8.0) == Approx(1.25));
  CHECK(wall_seconds(10.0, 1e6, 1.0) == 10.0);
}

TEST_CASE("a run whose steps were all made takes what they took, its start and its output", "[scenes][predicted]") {
  const FirstSteps first{.start = 0.5, .seconds = 2.0, .made = 100, .present = 1.0, .later = 0.1};
  RunCounts run{.steps = 100, .bodies = 10, .loose = 1.0};
  const PredictedTime alone = predict_time(run, first, 1.0);
  CHECK(alone.steps == 2.0);
  CHECK(alone.output == 0.0);
  CHECK(alone.start >= 0.5);
  run.outputs = 100;
  const double some = predict_time(run, first, 1.0).output;
  run.outputs = 200;
  CHECK(predict_time(run, first, 1.0).output == Approx(2.0 * some));
  // half as fast a machine takes twice as long for what is priced, not for what was measured
  CHECK(predict_time(run, first, 0.5).output == Approx(4.0 * some));
  CHECK(predict_time(run, first, 0.5).steps == 2.0);
}

TEST_CASE("steps to come cost as the last ones, with what the bodies lack of a packing", "[scenes][predicted]") {
  const FirstSteps first{.seconds = 1.0, .made = 100, .present = 0.5, .later = 0.02};
  RunCounts run{.steps = 1100, .bodies = 1000, .polyhedra = 1000, .sweeps = 50};
  // half of the bodies are there: all cost twice as much
  CHECK(predict_time(run, first, 1.0).steps == Approx(1.0 + 1000 * 0.04));
  run.loose = 1.0;
  const double packed = predict_time(run, first, 1.0).steps - 41.0;
  CHECK(packed > 0.0);
  run.loose = 0.5;
  CHECK(predict_time(run, first, 1.0).steps == Approx(41.0 + 0.5 * packed));
  run.falling = 0.75;
  CHECK(predict_time(run, first, 1.0).steps == Approx(41.0 + 0.125 * packed));
  // sweeps over its contacts are the larger part of a pile by a solver that sweeps
  run.sweeps = 0.0;
  run.loose = 1.0;
  run.falling = 0.0;
  CHECK(predict_time(run, first, 1.0).steps - 41.0 < packed);
  run.polyhedra = 0.0;
  const double balls = predict_time(run, first, 1.0).steps;
  CHECK(balls - 41.0 < 0.1 * packed);
  run.reading = 2.0;
  const double read = predict_time(run, first, 1.0).steps - balls;
  CHECK(read > 0.0);
  run.reading = 0.5;
  CHECK(predict_time(run, first, 1.0).steps - balls == Approx(0.25 * read));
}

TEST_CASE("half of the bodies that fall from up to a height are down after the fall from its half",
          "[scenes][predicted]") {
  CHECK(falling_share(2.0, 10.0, 1.0, 0.0) == Approx(std::sqrt(0.2)));
  // the bounces of Zeno's ball last 2 e/(1 - e) of the fall
  CHECK(falling_share(2.0, 10.0, 10.0, 0.5) == Approx(0.3 * std::sqrt(0.2)));
  CHECK(falling_share(2.0, 10.0, 1.0, 1.0) == 1.0);
  CHECK(falling_share(2.0, 10.0, 0.1, 0.0) == 1.0);
  CHECK(falling_share(2.0, 0.0, 1.0, 0.0) == 0.0);
  CHECK(falling_share(0.0, 10.0, 1.0, 1.0) == 0.0);
}

TEST_CASE("more bodies than memory holds are refused before they take it", "[scenes][commands]") {
  const TemporaryFolder folder;
  for (const char* method : {"lattice", "random", "pour"}) {
    INFO(method);
    const std::string fill =
        std::string("[[fill]]\nname = \"sand\"\nshape = \"drop\"\nmaterial = \"m\"\ncount = 1e12\nmethod = \"") +
        method + "\"\nregion = { box = { min = [0, 0, 0], max = [1e3, 1e3, 1e3] } }\n" +
        (std::string(method) == "pour" ? "rate = 1e9\n" : "") + "[shape.drop]\nsphere = { radius = 0.001 }\n";
    const fs::path scene = ball_in(folder, fill);
    const Captured c = captured([&] { return guarded([&] { return command_check({scene.string(), {}}); }); });
    CHECK(c.code == exit_usage);
    CHECK_THAT(c.err, Catch::Contains("[[fill]] 'sand': 1e+12 bodies take") && Catch::Contains("GB are there"));
  }
}

TEST_CASE("a run that ends early tells the overlap it was left with", "[scenes][commands]") {
  const TemporaryFolder folder;
  RunOptions o = quiet_into(folder / "out");
  o.steps = 5;
  const Captured run = run_of(ball_in(folder), o,
                              {"contact.method=smooth", "run.time_step=1e-5", "run.output_interval=1e-5",
                               "body.ball.position=[0, 0, 0.01]", "body.ball.velocity=[0, 0, -1]"});
  CHECK(run.code == exit_done);
  // 1 m/s for 5 steps of 1e-5 s, hardly braked yet: looked at after the fourth or the fifth
  const double overlap = read_json(folder / "out" / "summary.json").number("overlap.max").value();
  CHECK(overlap > 3.9e-5);
  CHECK(overlap < 5.1e-5);
}

TEST_CASE("a run that its condition ended is left as it is, and told how it goes on", "[scenes][commands]") {
  const TemporaryFolder folder;
  const fs::path scene = ball_in(folder, R"([[measure]]
name = "place"
kind = "position"
body = "ball"
[[stage]]
name = "roll"
until = { measure = "place", component = "x", above = 0.01, at_most = 0.1 }
)");
  std::string text = read_whole_file(scene);
  text.replace(text.find("duration = 0.1, "), 16, "");
  std::ofstream(scene) << text;
  RunOptions o;
  o.out = (folder / "out").string();
  o.quiet = true;
  REQUIRE(run_of(scene, o).code == exit_done);
  const auto steps = read_json(folder / "out" / "summary.json").number("steps");
  REQUIRE(steps.value() < 50);
  const auto resume = [&](const RunOptions& options) {
    return captured([&] { return guarded([&] { return command_resume(o.out, options); }); });
  };
  const Captured nothing = resume({});
  CHECK(nothing.code == exit_done);
  CHECK_THAT(nothing.err, Catch::Contains("it ended by its condition: --set KEY=VALUE") && !Catch::Contains("--steps"));
  RunOptions more;
  more.steps = 7;
  CHECK(resume(more).code == exit_usage);
  CHECK(read_json(folder / "out" / "summary.json").number("steps") == steps);
}

TEST_CASE("a run goes on from where it ended, to the bits of an uncut one", "[scenes][commands]") {
  const TemporaryFolder folder;
  const fs::path scene = ball_in(folder);
  RunOptions o;
  o.out = (folder / "out").string();
  o.threads = 1;
  o.steps = 40;
  o.verbose = true;
  const Captured first = run_of(scene, o);
  CHECK(first.code == exit_done);
  CHECK_THAT(first.err, Catch::Contains("time step 0.001 s: as written") && Catch::Contains("40 steps, t = 0.04 s"));
  RunOptions rest;
  rest.threads = 1;
  const Captured resumed = captured([&] { return guarded([&] { return command_resume(o.out, rest); }); });
  CHECK(resumed.code == exit_done);
  RunOptions whole = quiet_into(folder / "whole");
  CHECK(run_of(scene, whole).code == exit_done);
  const auto hash = [&](const std::string& run) {
    return read_json(fs::path(run) / "summary.json").text("state_hash");
  };
  CHECK(hash(o.out) == hash(whole.out));

  const auto bytes = [&] {
    std::string all;
    for (const char* file : {"run.h5", "checkpoint.h5", "summary.json", "frames.pvd"})
      all += read_whole_file(fs::path(o.out) / file);
    return all;
  };
  const std::string before = bytes();
  const Captured nothing = captured([&] { return guarded([&] { return command_resume(o.out, rest); }); });
  CHECK(nothing.code == exit_done);
  CHECK_THAT(nothing.err, Catch::Contains("is complete: 100 steps, t = 0.1 s; nothing is changed"));
  CHECK(bytes() == before);
  RunOptions seven = rest;
  seven.steps = 7;
  CHECK(captured([&] { return guarded([&] { return command_resume(o.out, seven); }); }).code == exit_done);
  CHECK(read_json(fs::path(o.out) / "summary.json").number("steps") == 107.0);

  std::ofstream(scene, std::ios::app) << "# \n[[measure]]\nname = \"more\"\nkind = \"energy\"\n";
  const Captured changed = captured([&] { return guarded([&] { return command_resume(o.out, rest); }); });
  CHECK(changed.code == exit_usage);
  CHECK_THAT(changed.err, Catch::Contains("has changed since the run was started"));
}

TEST_CASE("a run ends with the code of what ended it", "[scenes][commands]") {
  const TemporaryFolder folder;
  const fs::path scene = ball_in(folder);
  RunOptions whole = quiet_into(folder / "whole");
  CHECK(run_of(scene, whole).code == exit_done);
  CHECK(run_of(scene, whole).code == exit_usage);  // the folder is not empty
  whole.force = true;
  whole.time_limit = "never";
  CHECK_THAT(run_of(scene, whole).err, Catch::Contains("--time-limit 'never' is no duration"));
  whole.time_limit = "";
  whole.cpu_limit = "0.001s";
  CHECK(run_of(scene, whole, {"run.duration=1e4", "run.output_interval=1e3"}).code == exit_time_limit);
  whole.cpu_limit = "";
  CHECK(run_of(ball_in(folder, "[bounds]\noverlap_relative = -1.0\n"), whole).code == exit_usage);
  CHECK(run_of(ball_in(folder,
                       "[[measure]]\nname = \"fall\"\nkind = \"drift\"\nbody = \"ball\"\n[bounds]\n"
                       "drift = { body = \"ball\", below = 1e-3 }\n"),
               whole)
            .code == exit_bound);
  const Captured lost = run_of(ball_in(folder), whole, {"world.domain={ min = [-1, -1, 0.015], max = [1, 1, 1] }"});
  CHECK(lost.code == exit_failed);
  CHECK_THAT(lost.err, Catch::Contains("body"));
}

TEST_CASE("a folder that a run writes into is refused to others until it has ended, and keeps what is not of a run",
          "[scenes][commands]") {
  const TemporaryFolder folder;
  const fs::path scene = ball_in(folder);
  RunOptions o;
  o.out = (folder / "out").string();
  o.threads = 1;
  o.steps = 40;
  o.quiet = o.force = true;
  REQUIRE(run_of(scene, o).code == exit_done);
  std::ofstream(folder / "out" / "frames" / "notes.txt") << "kept";  // neither is it taken with the frames
  std::ofstream(folder / "out" / "frames" / "bodies_999999.vtp") << "gone";
  REQUIRE(run_of(scene, o).code == exit_done);
  CHECK(support::read_text(folder / "out" / "frames" / "notes.txt") == "kept");
  CHECK_FALSE(fs::exists(folder / "out" / "frames" / "bodies_999999.vtp"));
  const std::string before = support::read_text(folder / "out" / "summary.json");
  RunOptions rest;
  rest.threads = 1;
  rest.quiet = true;
  const auto resumed = [&] { return captured([&] { return guarded([&] { return command_resume(o.out, rest); }); }); };
  {
    const FolderLock other(o.out);
    for (const Captured& refused : {run_of(scene, o), resumed()}) {
      CHECK(refused.code == exit_file);
      CHECK_THAT(refused.err, Catch::Contains("another run is writing into"));
    }
    CHECK(support::read_text(folder / "out" / "summary.json") == before);
  }
  CHECK(resumed().code == exit_done);
}

TEST_CASE("numbers whose steps or energies no number holds are refused", "[scenes][commands]") {
  const TemporaryFolder folder;
  const fs::path scene = ball_in(folder);
  RunOptions o = quiet_into(folder / "out");
  const auto refused = [&](const std::string& override) {
    const Captured c = run_of(scene, o, {override});
    CHECK(c.code == exit_usage);
    return c.err;
  };
  CHECK_THAT(refused("run.time_step=1e-320"), Catch::Contains("[run] duration = 0.1 s is inf time steps of"));
  CHECK_THAT(refused("run.duration=1e300"), Catch::Contains("[run] duration = 1e+300 s is 1e+303 time steps of"));
  CHECK_THAT(refused("body.ball.velocity=[0, 0, 1e200]"),
             Catch::Contains("ball: a speed of 1e+200 m/s has no finite energy"));
  o.force = true;
  for (const std::optional<std::uint64_t> steps :
       {std::optional<std::uint64_t>(), {1}}) {  // also where a run is cut off
    o.steps = steps;
    const Captured c = run_of(scene, o, {"world.gravity=[1e160, 0, 0]"});
    CHECK(c.code == exit_failed);
    CHECK_THAT(c.err, Catch::Contains("the energy became non-finite in step") && Catch::Contains("fastest is body 1"));
  }
  const Captured heavy = run_of(scene, o, {"material.m.density=1e300", "body.ball.position=[0, 0, 0.01]"});
  CHECK(heavy.code == exit_failed);
  CHECK_THAT(heavy.err, Catch::Contains("the solver's residual became non-finite in step"));
}

TEST_CASE("results are exported and reported by the program", "[scenes][commands]") {
  const TemporaryFolder folder;
  RunOptions o = quiet_into(folder / "out");
  REQUIRE(run_of(ball_in(folder), o).code == exit_done);
  const Captured csv = captured([&] { return command_export(o.out, "csv"); });
  CHECK_THAT(csv.err, Catch::Contains("3 snapshots") && Catch::Contains("not what contacts remember"));
  CHECK(fs::exists(folder / "out/snapshots.csv"));
  const Captured page = captured([&] { return command_report(o.out, (folder / "page.html").string()); });
  CHECK(page.code == exit_done);
  CHECK_THAT(support::read_text(folder / "page.html"), Catch::Contains("<html"));
}

TEST_CASE("what a command throws becomes a message and a code", "[scenes][commands]") {
  const auto ended = [](const auto& command) { return captured([&] { return guarded(command); }); };
  const Captured scene = ended([]() -> int { throw SceneError("no such key"); });
  CHECK(scene.code == exit_usage);
  CHECK_THAT(scene.err, Catch::Contains("no such key"));
  const Captured file = ended([]() -> int { throw FileError("a.h5: torn"); });
  CHECK(file.code == exit_file);
  CHECK(file.err == "epafi: a.h5: torn\n");
  CHECK(ended([]() -> int { throw std::bad_alloc(); }).code == exit_file);
  CHECK_THAT(ended([]() -> int { throw std::length_error("vector"); }).err, Catch::Contains("not enough memory"));
  const Captured gone = ended([] { return command_check({"nowhere.toml", {}}); });
  CHECK(gone.code == exit_file);
  CHECK_THAT(gone.err, Catch::Contains("'nowhere.toml' does not exist"));
  const Captured folder = ended([]() -> int {
    fs::copy("/nowhere/at/all", "/nowhere/else");
    return 0;
  });
  CHECK(folder.code == exit_file);
}

TEST_CASE("every command that takes a scene takes the names of the library", "[scenes][commands]") {
  for (const char* name : {"wheel_rail/hertz", "wheel_rail/hertz.toml", "studies/box_stack", "tutorials/05_sweep"}) {
    const fs::path file = existing_scene_file(name);
    CHECK(fs::equivalent(file, fs::path(root) / "scenes/library" / (fs::path(name).replace_extension() += ".toml")));
  }
  CHECK(captured([] { return command_patch({"wheel_rail/hertz", {}}, {}); }).code == exit_done);
  const Captured cases = captured([] {
    StudyOptions sweep;
    sweep.files = {"tutorials/05_sweep"};
    SweepOptions list;
    list.list = true;
    return command_sweep(sweep, list);
  });
  CHECK_THAT(cases.out, Catch::Contains("params.mu"));
  for (const auto command : {command_chart, command_limits}) {
    StudyOptions nowhere;
    nowhere.files = {"studies/nowhere"};
    const Captured gone = captured([&] { return guarded([&] { return command(nowhere); }); });
    CHECK(gone.code == exit_file);
    CHECK_THAT(gone.err, Catch::Contains("'studies/nowhere' does not exist; `epafi list scenes`"));
  }
}

TEST_CASE("a polyhedron is the hull of the corners of a file, with faces or without", "[scenes][commands]") {
  const TemporaryFolder folder;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  for (int k = 0; k < 10; ++k) {
    std::ofstream obj(folder / "corners.obj");
    obj.precision(17);
    Vec3 v[4];
    for (Vec3& x : v) {
      x = Vec3(place(random), place(random), place(random));
      obj << "v " << x.x() << " " << x.y() << " " << x.z() << "\n";
    }
    obj.close();
    ReadResult read = read_scene_text(
        "run = { duration = 0.1, time_step = 0.01 }\nmaterial.a = { density = 1000.0 }\n"
        "contact = { method = \"nonsmooth\", restitution = 0.0, friction = 0.5 }\n[[body]]\n"
        "shape = { polyhedron = { file = \"" +
            (folder / "corners.obj").string() + "\" } }\nmaterial = \"a\"\n",
        "scene.toml", {}, full_registry());
    REQUIRE(read.scene);
    const auto assembly = assemble(std::move(*read.scene));
    const double volume = std::abs((v[1] - v[0]).cross(v[2] - v[0]).dot(v[3] - v[0])) / 6.0;
    CHECK(1.0 / assembly->simulation->world.inverse_mass[0] == Approx(1000.0 * volume).epsilon(1e-9));
  }
}
