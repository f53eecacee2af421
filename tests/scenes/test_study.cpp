// Charts, limits and sweeps: what is read, what is refused, and that the numbers in them are those of the runs.
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>

#include "scenes/cli/commands.h"
#include "scenes/study/atlas.h"
#include "scenes/study/atlas_page.h"
#include "scenes/study/chart.h"
#include "scenes/study/chart_rows.h"
#include "scenes/study/limits.h"
#include "scenes/study/sweep.h"
#include "tests/support/captured.h"
#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/side_file.h"

using namespace epafi;

namespace {

const std::string program = std::string(EPAFI_BINARY_DIR) + "/bin/epafi";
const std::string library = std::string(EPAFI_SOURCE_DIR) + "/scenes/library/";

std::string write(const TemporaryFolder& folder, const std::string& text) {
  const auto file = folder / "study.toml";
  std::ofstream(file) << text;
  return file.string();
}

std::string problems_of(const std::string& path) {
  try {
    read_study(path, {});
  } catch (const SceneError& e) {
    return e.what();
  }
  return {};
}

const auto silent = [](const std::string&) {};

}  // namespace

TEST_CASE("vary makes every combination of its lists, named after the method", "[scenes][study]") {
  const TemporaryFolder folder;
  const Study study = read_study(write(folder, R"(
scene = "scene.toml"
error = "drift"
vary = [ { "contact.nonsmooth.solver" = ["pgs", "nsgs"], "contact.nonsmooth.iterations" = [10, 50, 200] },
         { name = "soft", contact.method = "smooth" } ]
)"),
                                 {});
  REQUIRE(study.methods.size() == 7);
  CHECK(study.methods[0].name == "pgs");
  CHECK(study.methods[5].settings() == "contact.nonsmooth.solver=\"nsgs\"; contact.nonsmooth.iterations=200");
  CHECK(study.methods[6].name == "soft");
  CHECK(study.scene == (folder / "scene.toml").string());
}

TEST_CASE("a wrong study is answered with place and nearest key", "[scenes][study]") {
  const TemporaryFolder folder;
  const std::string file = write(
      folder,
      "scene = \"a.toml\"\nrepeat = 3\nparameter = { key = \"params.n\", from = 5, to = 1 }\ntime_limit = \"soon\"\n");
  const std::string text = problems_of(file);
  CHECK_THAT(text,
             Catch::Contains(file + ":2:1: error: unknown key 'repeat'") && Catch::Contains("did you mean 'repeats'"));
  CHECK_THAT(text, Catch::Contains(":3:13: error: parameter 'params.n': from < to is needed"));
  CHECK_THAT(text, Catch::Contains("time_limit 'soon' is no duration"));
}

TEST_CASE("a scene or a patch case is no study, said once", "[scenes][study]") {
  const TemporaryFolder folder;
  const std::string scene = write(folder, "params = { n = 2 }\n[run]\nduration = 1\n[world]\n");
  CHECK(problems_of(scene) == scene + ":2:1: error: 'run': this file is a scene, not a study; it is for epafi run");
  CHECK_THAT(problems_of(library + "wheel_rail/hertz.toml"), Catch::Contains("is a patch case, not a study"));
}

TEST_CASE("an error that the scene does not measure is refused before anything runs", "[scenes][study]") {
  const TemporaryFolder folder;
  Study study = read_study(
      write(folder,
            "scene = \"" + library +
                "stacking/column.toml\"\nerror = \"drfit\"\nvary = [ { \"contact.nonsmooth.solver\" = \"pgs\" } ]\n"),
      {});
  CHECK_THROWS_WITH(run_chart(study, folder.path(), silent), Catch::Contains("unknown error 'drfit'"));
}

TEST_CASE("a chart repeats its errors bit for bit, marks its front and recommends what holds when run",
          "[scenes][study]") {
  const TemporaryFolder folder;
  // the exact rebound is 10 m/s; the error falls with the time step
  Study study = read_study(write(folder, "scene = \"" + library + R"(impact/chung_ooi_1.toml"
error = { measure = "rebound", component = "x", exact = 10.0, relative = true }
repeats = 2
set = { "bounds.energy_error" = 1.0, "accuracy.energy_error" = 1e-4, "run.time_step" = 1e-6 }
vary = [ { "run.time_step" = [4e-6, 4e-7, 4e-8] },
         { name = "wrong", "run.time_step" = 4e-7, "bounds.energy_error" = 1e-9 } ]
)"),
                           {});
  study.program = program;
  const Chart chart = run_chart(study, folder.path(), silent), again = run_chart(study, folder.path(), silent);
  REQUIRE(chart.points.size() == 4);
  for (std::size_t k = 0; k < 4; ++k) {
    CHECK(chart.points[k].error == again.points[k].error);
    CHECK(chart.points[k].state_hash == again.points[k].state_hash);
  }
  CHECK(chart.points[2].error < chart.points[1].error);
  CHECK(chart.points[1].error < chart.points[0].error);
  CHECK(chart.points[2].pareto);  // the most accurate is always on the front
  CHECK(chart.points[3].status == "bound_violated");
  CHECK_FALSE(chart.points[3].pareto);
  REQUIRE(chart.recommended);
  CHECK(*chart.recommended != 0);  // 3.5e-4 of energy error is outside [accuracy]
  const std::string text = recommended_scene(chart, folder.path());
  std::ofstream(folder / "recommended.toml") << text;
  const CaseResult run =
      run_case((folder / "recommended.toml").string(), {{}, folder / "again"}, {program, 1, 0.0, true});
  CHECK(run.completed());
  CHECK(run.number("accuracy.energy_error.ok", 0.0) == 1.0);
}

TEST_CASE("rows of others stand on the chart and its front, and are never recommended", "[scenes][study]") {
  const TemporaryFolder folder;
  Chart chart;
  chart.asks_accuracy = true;
  chart.points.resize(2);
  for (ChartPoint& p : chart.points) p.status = "completed";
  chart.points[0].method = {"pgs", {"contact.nonsmooth.iterations=50"}};
  chart.points[0].time = 1.0;
  chart.points[0].error = 1e-3;
  chart.points[0].accurate = true;
  chart.points[1].method = {"newton", {}};
  chart.points[1].time = 2.0;
  chart.points[1].error = 1e-6;
  chart.points[1].accurate = true;
  mark_front(chart);
  CHECK(chart.points[0].pareto);
  // quicker at no larger error than pgs; dearer than newton; failed; without time
  std::ofstream(folder / "rows.csv") << "method,settings,time,error,status\nBullet,\"dt=1/60, nncg\",0.5,1e-3,ok\n"
                                        "ODE,,3,1e-5,completed\nJolt,,0.1,,aborts\nRapier,,,1e-9,\n";
  add_rows(chart, read_rows(chart.study, (folder / "rows.csv").string()));
  REQUIRE(chart.points.size() == 6);
  CHECK(front_of(chart, 0) == std::vector<std::size_t>{2, 1});
  CHECK(chart.points[2].pareto);
  CHECK_FALSE(chart.points[0].pareto);
  CHECK(*chart.recommended == 0);
  CHECK_THAT(chart_csv(chart), Catch::Contains("\"Bullet\",\"dt=1/60, nncg\",0.5,0.001,0,completed,"));
  CHECK(chart.points[4].status == "aborts");
  CHECK(chart.points[5].status == "not_run");
  // what it writes it reads
  std::ofstream(folder / "again.csv") << chart_csv(chart);
  const auto again = read_rows(chart.study, (folder / "again.csv").string());
  REQUIRE(again.size() == 6);
  CHECK(again[2].method.settings() == "dt=1/60, nncg");
  CHECK(again[1].error == 1e-6);

  const auto trouble = [&](const std::string& text) {
    std::ofstream(folder / "wrong.csv") << text;
    try {
      read_rows(chart.study, (folder / "wrong.csv").string());
    } catch (const SceneError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK_THAT(trouble("method,seconds,error\n"), Catch::Contains("wrong.csv:1:1: error: no column 'time'"));
  CHECK_THAT(trouble("method,time,error\nODE,1\n"), Catch::Contains("wrong.csv:2:1: error: 2 cells below 3 columns"));
  CHECK_THAT(trouble("method,time,error\n\nODE,1,-2\n"), Catch::Contains("wrong.csv:3:7: error: '-2' found as error"));
  CHECK_THROWS_AS(read_rows(chart.study, (folder / "none.csv").string()), FileError);
}

TEST_CASE("methods take turns, and several errors of a run have a column and a front each", "[scenes][study]") {
  const TemporaryFolder folder;
  Study study = read_study(write(folder, "scene = \"" + library + R"(stacking/stack.toml"
error = [ { measure = "drift", component = "distance" }, { measure = "drift", component = "sag" } ]
repeats = 1
set = { "params.n" = 3, "params.jitter" = 0.002, "run.duration" = 0.2 }
reference = { "contact.nonsmooth.solver" = "newton", "contact.nonsmooth.tolerance" = 1e-12 }
again = { "run.seed" = 7 }
vary = [ { "contact.nonsmooth.solver" = "pgs", "contact.nonsmooth.iterations" = [5, 100] },
         { "contact.nonsmooth.solver" = "newton" } ]
)"),
                           {});
  CHECK(order_of_turns(study) == std::vector<std::size_t>{0, 2, 1});
  study.program = program;
  const Chart chart = run_chart(study, folder.path(), silent);
  REQUIRE(chart.points.size() == 3);
  for (const ChartPoint& p : chart.points) REQUIRE(p.more_errors.size() == 1);
  CHECK(chart.points[0].more_errors[0] > chart.points[1].more_errors[0]);  // sags less with more sweeps
  CHECK_THAT(chart_csv(chart), Catch::Contains(",accurate,error:drift.sag\n"));
  REQUIRE(chart.accuracy);
  CHECK(*chart.accuracy == 0.005);  // of the scene: drift
  REQUIRE(chart.again);
  CHECK(chart.again->holds);
  CHECK_THAT(chart_verdict(chart), Catch::Contains("run again with [run.seed=7]: meets [accuracy]"));
  const auto hash = [&](const char* run) { return read_json(folder / run / "summary.json").text("state_hash"); };
  CHECK(hash("again") != chart.points[*chart.recommended].state_hash);  // another start, not the same run
}

TEST_CASE("every broad phase finds the pairs that looking at all of them finds, over the axis of a chart",
          "[scenes][study]") {
  const TemporaryFolder folder;
  Study study = read_study(library + "studies/broad_phase.toml", {"set.params.n=300", "repeats=1"});
  std::erase_if(study.methods, [](const StudyMethod& m) {
    return m.settings().find("ratio=1\0") == std::string::npos && m.settings().find("ratio=10") == std::string::npos;
  });
  study.program = program;
  const Chart chart = run_chart(study, folder.path(), silent);
  REQUIRE(chart.points.size() == 12);
  for (const ChartPoint& p : chart.points) {
    INFO(p.method.settings() << ' ' << p.trouble);
    CHECK(p.good());
    REQUIRE(p.at);
    CHECK(p.error == 0.0);
    CHECK((p.time > 1e-9 && p.time < 1e-3));
  }
}

TEST_CASE("a budget ends a study coarse, and says so", "[scenes][study]") {
  const TemporaryFolder folder;
  Study study = read_study(library + "studies/stack_height_iterations.toml", {"parameters.0.values=[5]"});
  study.program = program;
  study.budget = 1e-6;
  const LimitMap map = run_limits(study, folder.path(), 1, silent);
  CHECK_FALSE(map.whole);
  CHECK(map.cases.empty());
  CHECK_THAT(limits_verdict(map), Catch::Contains("the budget was spent"));
  Study chart_study = read_study(library + "studies/impact_laws.toml", {});
  chart_study.program = program;
  chart_study.budget = 1e-6;
  const Chart chart = run_chart(chart_study, folder.path(), silent);
  for (const ChartPoint& p : chart.points) CHECK(p.status == "not_run");
  CHECK_FALSE(chart.recommended);
}

TEST_CASE("every study has a page with its picture, its table and what they say", "[scenes][study]") {
  const std::filesystem::path atlas = std::string(EPAFI_SOURCE_DIR) + "/docs/atlas";
  CHECK(read_whole_file(atlas / "README.md") == atlas_index(library + "studies"));
  for (const auto& entry : std::filesystem::directory_iterator(library + "studies")) {
    if (entry.path().extension() != ".toml") continue;
    const std::string stem = entry.path().stem().string();
    INFO(stem);
    REQUIRE(std::filesystem::exists(atlas / (stem + ".md")));
    const std::string page = read_whole_file(atlas / (stem + ".md"));
    CHECK(page.find("](" + stem + ".csv)") != std::string::npos);
    std::size_t pictures = 0, words = 0;
    for (std::size_t at = page.find("!["); at != std::string::npos; at = page.find("![", at + 1)) {
      const std::size_t from = page.find("](", at) + 2, to = page.find(')', from);
      INFO(page.substr(from, to - from));
      CHECK(std::filesystem::exists(atlas / page.substr(from, to - from)));
      ++pictures;
    }
    CHECK(pictures > 0);
    const std::string said = page.substr(0, page.find("<!-- measured"));  // two paragraphs by hand, below the title
    for (std::size_t at = said.find("\n\n"); at != std::string::npos; at = said.find("\n\n", at + 2)) ++words;
    CHECK(words >= 3);
    CHECK(page_with(page, "", "new\n").find("](" + stem + ".csv)") == std::string::npos);
  }
}

TEST_CASE("the longest stable step is 2/omega within 2 %", "[scenes][study][long]") {
  const TemporaryFolder folder;
  Study study = read_study(library + "studies/time_step_stiffness.toml", {"parameters.0.values=[1e4]"});
  study.program = program;
  const LimitMap map = run_limits(study, folder.path(), 1, silent);
  REQUIRE(map.limits.size() == 2);
  for (const Limit& l : map.limits) {
    REQUIRE(l.theory);
    CHECK(*l.theory == Approx(2.0 * std::sqrt(1e-3 / 1e4)));
    CHECK(*l.last_good == Approx(*l.theory).epsilon(0.02));
    CHECK(*l.first_failing == Approx(*l.theory).epsilon(0.02));
    CHECK(l.kind == "energy grew");
  }
}

TEST_CASE("a chart of convex pairs has the errors that their exact answers show", "[scenes][study]") {
  const TemporaryFolder folder;
  const std::string corpus = std::string(EPAFI_SOURCE_DIR) + "/tests/data/convex_pairs.bin";
  Study study = read_study(write(folder, "scene = \"" + corpus + R"("
error = "depth"
repeats = 1
vary = [ { name = "all", "narrow.method" = ["auto", "gjk-epa"] },
         { name = "deep", "narrow.method" = "auto", "narrow.category" = "deep_overlap" } ]
)"),
                           {});
  const Chart chart = chart_of(study, folder.path(), silent);
  REQUIRE(chart.points.size() == 3);
  for (const ChartPoint& p : chart.points) {
    CHECK(p.good());
    CHECK(p.time > 0.0);
  }
  CHECK(chart.points[0].error < 1e-12);
  CHECK(chart.points[2].error <= chart.points[0].error);
  study.methods[0].overrides = {"narrow.method=\"mpr\""};
  CHECK_THROWS_WITH(chart_of(study, folder.path(), silent), Catch::Contains("'mpr' is none of auto, sat, gjk-epa"));
}

namespace {

/// A loaded wheel on a rail, rolling.
constexpr const char* patch_case = R"(params = { load = 80e3 }
[material.steel]
shear_modulus = "82 GPa"
poissons_ratio = 0.28
[contact]
friction = 0.3
[patch]
radii = { x1 = 0.46, x2 = inf, y1 = inf, y2 = 0.3 }
load = "= load"
creepage = { longitudinal = -0.002 }
)";

}  // namespace

TEST_CASE("a chart of a wheel-rail case has Hertz' errors against boundary elements", "[scenes][study]") {
  const TemporaryFolder folder;
  std::ofstream(folder / "case.toml") << patch_case;
  const std::string head =
      "scene = \"case.toml\"\nreference = { \"patch.normal\" = \"half-space\", \"patch.tangential\" = \"fastsim\" }\n";
  const std::string vary =
      "vary = [ { name = \"hertz\", \"patch.normal\" = \"hertz\", \"patch.tangential\" = [\"fastsim\", "
      "\"kalker-linear\"] } ]\n";
  const Study study = read_study(
      write(folder,
            head + vary + "error = { measure = \"patch\" }\naccuracy = 0.05\nagain = { \"params.load\" = 60e3 }\n"),
      {});
  REQUIRE(is_patch_study(study));
  const Chart chart = run_patch_chart(study, silent);
  REQUIRE(chart.points.size() == 2);
  CHECK(chart.points[0].error < 0.02);                   // of the same geometry: cells against the closed form
  CHECK(chart.points[1].error > chart.points[0].error);  // no saturation
  REQUIRE(chart.recommended);
  CHECK(*chart.recommended == 0);
  REQUIRE(chart.again);
  CHECK(chart.again->holds);
  CHECK(chart.reference_error > 0.0);

  const Study pressure =
      read_study(write(folder, head + vary + "error = \"pressure\"\nfails_when = { force = 0.05 }\n"), {});
  const Chart peak = run_patch_chart(pressure, silent);
  CHECK(peak.points[0].error == peak.points[1].error);  // the same normal model
  CHECK(judge_patch_case(pressure, 0, {"params.load=80e3"}, {}).status == "ok");
  const LimitCase linear = judge_patch_case(pressure, 1, {"params.load=80e3"}, {});
  CHECK(linear.status == "failed");
  CHECK_THAT(linear.kind, Catch::Contains("wrong and flagged") || Catch::Contains("wrong and not flagged"));

  CHECK_THROWS_WITH(run_patch_chart(read_study(write(folder, head + vary + "error = \"drift\"\n"), {}), silent),
                    Catch::Contains("unknown error 'drift'; write pressure, area, force or patch"));
  CHECK_THROWS_WITH(
      run_patch_chart(read_study(write(folder, "scene = \"case.toml\"\nerror = \"area\"\n" + vary), {}), silent),
      Catch::Contains("needs a reference"));
  CHECK_THROWS_WITH(
      run_patch_chart(
          read_study(write(folder, head + "error = \"area\"\nvary = [ { \"patch.normal\" = "
                                          "\"hertz\", \"patch.tangential\" = [[\"fastsim\", \"polach\"]] } ]\n"),
                     {}),
          silent),
      Catch::Contains("pairs of models"));
}

TEST_CASE("an atlas tells what has moved against its stored tables", "[scenes][study][long]") {
  const std::string header = "method,settings,time,error,error_spread,status,time_spread\n";
  const std::string stored =
      header + "\"a\",\"x=1\",1.0,1e-3,0,completed,0.1\n\"b\",\"x=\"\"q\"\"\",1.0,1e-3,1e-4,completed,0.1\n";
  CHECK(moved_rows(stored, stored).empty());
  const auto moved = moved_rows(stored, header +
                                            "\"a\",\"x=1\",1.1,2e-3,0,completed,0.1\n\"b\",\"x=\"\"q\"\"\",3.0,1.05e-3,"
                                            "0,completed,0.1\n\"c\",\"\",1,1,0,completed,0\n");
  REQUIRE(moved.size() == 3);
  CHECK(moved[0] == "a [x=1]: worse: error 0.002, stored 0.001");
  CHECK(moved[1] == "b [x=\"q\"]: slower: time 3, stored 1");
  CHECK(moved[2] == "c []: new");

  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "studies");
  std::filesystem::copy_file(library + "studies/time_step_stiffness.toml", folder / "studies/step.toml");
  std::string text = read_whole_file(folder / "studies/step.toml");
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("../limits", library + "limits");
  replace("[1e3, 1e4, 1e5, 1e6, 1e7]", "[1e6]");
  replace("tolerance = 0.005", "tolerance = 0.2");
  write_whole_file(folder / "studies/step.toml", {text});
  std::vector<std::string> said;
  AtlasOrder order{folder / "studies", folder / "atlas", folder / "work", 60.0, 1};
  order.program = program;
  CHECK(draw_atlas(order, false, [&](const std::string& line) { said.push_back(line); }));
  CHECK(said.back() == "step: new in the atlas");
  CHECK(std::filesystem::exists(folder / "atlas/step.csv"));
  CHECK(draw_atlas(order, false, [&](const std::string& line) { said.push_back(line); }));
  CHECK(said.back() == "step: 0 rows moved against the stored table");
  CHECK(studies_in(folder / "studies", true).empty());
}

TEST_CASE("the limit of Gauss-Seidel on a column lies within a fifth of 0.93 n^2 sweeps per decade",
          "[scenes][study][long]") {
  const TemporaryFolder folder;
  Study study = read_study(library + "studies/stack_height_iterations.toml", {"parameters.0.values=[5, 20]"});
  study.program = program;
  const LimitMap map = run_limits(study, folder.path(), 1, silent);
  REQUIRE(map.limits.size() == 2 * study.methods.size());
  for (const Limit& l : map.limits) {
    if (study.methods[l.method].name != "pgs") continue;
    REQUIRE(l.last_good);
    CHECK(*l.last_good == Approx(0.93 * *l.at * *l.at * 6).epsilon(0.2));
    CHECK(l.kind == "did not converge");
  }
  const std::size_t cases = map.cases.size();
  const auto before = std::filesystem::last_write_time(folder.path() / "method_00_5_10" / "summary.json");
  CHECK(run_limits(study, folder.path(), 1, silent).cases.size() == cases);  // nothing is run again
  CHECK(std::filesystem::last_write_time(folder.path() / "method_00_5_10" / "summary.json") == before);
}

TEST_CASE("a sweep lists its cases, skips finished ones and collects a row each", "[scenes][study]") {
  const TemporaryFolder folder;
  const std::string scene = (folder / "scene.toml").string();
  std::ofstream(scene) << "include = [\"" << library
                       << "stacking/column.toml\"]\n[sweep]\n\"params.n\" = [2, 3]\n\"contact.nonsmooth.solver\" = "
                          "[\"pgs\", \"nsgs\"]\n";
  const SweepPlan sweep = plan_sweep(scene, {}, folder / "out");
  REQUIRE(sweep.cases.size() == 4);
  CHECK_THAT(list_sweep(sweep), Catch::Contains("3 open params.n=3 contact.nonsmooth.solver=\"nsgs\""));
  run_cases(scene, {sweep.cases[3]}, {program, 1, 0.0, true}, 2, [](std::size_t, const CaseResult&) {});
  CHECK_THAT(list_sweep(sweep), Catch::Contains("3 completed") && Catch::Contains("0 open"));
  CHECK_THAT(collect_sweep(sweep), Catch::Contains("\n3,completed,3,nsgs,"));
}

TEST_CASE("a study removes its own cases and nothing else, and tells of trouble also when quiet", "[scenes][study]") {
  const TemporaryFolder folder;
  const auto text = [&](const char* name) { return read_whole_file(folder / name); };
  const std::string scene = (folder / "scene.toml").string();
  std::ofstream(scene) << "include = [\"" << library << "stacking/column.toml\"]\n[sweep]\n\"params.n\" = [2, 3]\n";
  std::filesystem::create_directories(folder / "case_0001");
  write_whole_file(folder / "case_0001" / "letters.txt", {"kept"});
  const auto sweep = [&](const std::string& more = {}) {
    const std::string line = program + " sweep " + scene + " -q --force -o " + folder.path().string() + more;
    return captured([&] { return WEXITSTATUS(std::system(line.c_str())); });
  };
  const Captured in_the_way = sweep();
  CHECK(in_the_way.code == exit_file);
  CHECK_THAT(in_the_way.err, Catch::Contains("case_0001' is in the way of a case of that name"));
  CHECK(text("case_0001/letters.txt") == "kept");
  std::filesystem::rename(folder / "case_0001", folder / "mine");
  CHECK(sweep().code == exit_done);
  CHECK(std::filesystem::exists(folder / "case_0001" / "summary.json"));
  remove_cases(folder.path());
  CHECK_FALSE(std::filesystem::exists(folder / "case_0000"));
  CHECK(text("mine/letters.txt") == "kept");
  CHECK(std::filesystem::exists(scene));
  const Captured refused = sweep(" --set contact.nonsmooth.iterations=0");
  CHECK(refused.code != exit_done);
  CHECK_THAT(refused.err, Catch::Contains("[contact.nonsmooth] iterations"));
  const Captured failed = sweep(" --set 'world.gravity=[1e160, 0, 0]'");
  CHECK(failed.code == exit_failed);
  CHECK_THAT(failed.err, Catch::Contains("case 0: failed: ") && Catch::Contains("became non-finite"));
}

TEST_CASE("chart and limits judge overlaps by the largest of all steps", "[scenes][study]") {
  // Hertz: the largest overlap d of an elastic impact is that of m v^2/2 = 8/15 E* sqrt(R) d^(5/2); here the contact
  // has come and gone between two pictures of the run
  const TemporaryFolder folder;
  std::ofstream(folder / "fall.toml") << R"(
params = { v = 0.41 }
run = { duration = 5e-4, time_step = 1e-6, output_interval = 2e-4 }
material.m = { density = 3000.0, youngs_modulus = 1e10, poissons_ratio = 0.2 }
contact = { method = "smooth", restitution = 1.0, friction = 0.0, smooth = { law = "hertz" } }
[[body]]
shape = { half_space = { normal = [0, 0, 1] } }
material = "m"
fixed = true
[[body]]
shape = { sphere = { radius = 0.01 } }
material = "m"
position = [0, 0, 0.010001]
velocity = [0, 0, "= -v"]
)";
  const double radius = 0.01, mass = 3000.0 * 4.0 / 3.0 * M_PI * std::pow(radius, 3);
  const double modulus = 1e10 / (2.0 * (1.0 - 0.2 * 0.2));
  const auto energy = [&](double overlap) { return 8.0 / 15.0 * modulus * std::sqrt(radius) * std::pow(overlap, 2.5); };
  const auto study = [&](const std::string& rest) {
    Study out = read_study(write(folder, "scene = \"fall.toml\"\nvary = [{ name = \"hertz\" }]\n" + rest), {});
    out.program = program;
    return out;
  };
  const Chart chart = run_chart(study("error = \"overlap\"\nrepeats = 1\n"), folder / "chart", silent);
  REQUIRE(chart.points.size() == 1);
  CHECK(energy(chart.points[0].error * radius) == Approx(0.5 * mass * 0.41 * 0.41).epsilon(5e-3));
  const LimitMap map =
      run_limits(study("parameter = { key = \"params.v\", from = 0.01, to = 40, scale = \"log\", search = "
                       "\"bisect\", tolerance = 0.01 }\nfails_when = { overlap_relative = 1e-3 }\n"),
                 folder / "limits", 1, silent);
  REQUIRE(map.limits.size() == 1);
  REQUIRE(map.limits[0].last_good);
  const double exact = std::sqrt(2.0 * energy(1e-3 * radius) / mass);
  CHECK(*map.limits[0].last_good == Approx(exact).epsilon(0.012));
}
