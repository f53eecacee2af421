// Charts, limits and sweeps: what is read, what is refused, and that the numbers in them are those of the runs.
#include <fstream>

#include "scenes/study/bench.h"
#include "scenes/study/chart.h"
#include "scenes/study/limits.h"
#include "scenes/study/sweep.h"
#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"

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
vary = [ { "contact.nonsmooth.solver" = ["pgs", "nsgs"], "contact.nonsmooth.iterations" = [10, 50, 200] }, { name = "soft", contact.method = "smooth" } ]
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

TEST_CASE("an error that the scene does not measure is refused before anything runs", "[scenes][study]") {
  const TemporaryFolder folder;
  Study study = read_study(
      write(folder,
            "scene = \"" + library +
                "stacking/column.toml\"\nerror = \"drfit\"\nvary = [ { \"contact.nonsmooth.solver\" = \"pgs\" } ]\n"),
      {});
  CHECK_THROWS_WITH(run_chart(study, folder.path(), silent), Catch::Contains("'drfit' is no measure"));
}

TEST_CASE("a chart repeats its errors bit for bit, marks its front and recommends what holds when run",
          "[scenes][study]") {
  const TemporaryFolder folder;
  // the exact rebound is 10 m/s; the error falls with the time step
  Study study = read_study(write(folder, "scene = \"" + library + R"(impact/chung_ooi_1.toml"
error = { measure = "rebound", component = "x", exact = 10.0, relative = true }
repeats = 2
set = { "bounds.energy_error" = 1.0, "accuracy.energy_error" = 1e-4 }
vary = [ { "run.time_step" = [4e-6, 4e-7, 4e-8] }, { name = "wrong", "run.time_step" = 4e-7, "bounds.energy_error" = 1e-9 } ]
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

TEST_CASE("the limit of Gauss-Seidel on a column lies within a fifth of 0.93 n^2 sweeps per decade",
          "[scenes][study]") {
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
  const auto before = std::filesystem::last_write_time(folder.path() / "method_00_5_1" / "summary.json");
  CHECK(run_limits(study, folder.path(), 1, silent).cases.size() == cases);  // nothing is run again
  CHECK(std::filesystem::last_write_time(folder.path() / "method_00_5_1" / "summary.json") == before);
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

TEST_CASE("rows of a benchmark hold time, error and one hash for all threads", "[scenes][study]") {
  const TemporaryFolder folder;
  std::vector<std::string> rows;
  run_bench({library + "stacking/column.toml", {}, {1, 2}, 1, folder / "b", program},
            [&](const std::string& row) { rows.push_back(row); });
  REQUIRE(rows.size() == 2);
  const auto cell = [](const std::string& row, int k) {
    std::size_t at = 0;
    while (k-- > 0) at = row.find(',', at) + 1;
    return row.substr(at, row.find(',', at) - at);
  };
  CHECK(cell(rows[0], 9) == "energy");
  CHECK(cell(rows[0], 11) == cell(rows[1], 11));  // state hash
  CHECK(std::stod(cell(rows[0], 3)) > 0);
}
