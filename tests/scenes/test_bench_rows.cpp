// What a row of `epafi bench` holds.
#include "scenes/study/bench.h"

#include <sstream>

#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/json_reader.h"

using namespace epafi;

TEST_CASE("rows of a benchmark hold time, error and one hash for all threads", "[scenes][study]") {
  const TemporaryFolder folder;
  std::vector<BenchRow> rows;
  std::string remarks;
  run_bench(
      {std::string(EPAFI_SOURCE_DIR) + "/scenes/library/stacking/column.toml",
       {},
       {1, 2},
       1,
       folder / "b",
       true,
       std::string(EPAFI_BINARY_DIR) + "/bin/epafi"},
      [&](const BenchRow& row) { rows.push_back(row); }, [&](const std::string& lines) { remarks += lines; });
  REQUIRE(rows.size() == 2);
  CHECK_THAT(remarks, Catch::StartsWith("# ") && Catch::Contains("2 threads: ") && Catch::Contains("serial ") &&
                          Catch::Contains("as if "));
  CHECK_THAT(remarks, Catch::Contains("# machine, 2 threads: arithmetic ") && Catch::Contains("triad ") &&
                          Catch::Contains("x, round trip of a cache line ") &&
                          Catch::Contains("# machine, 2 copies of the scene at once, one thread each: together "));
  CHECK(std::stod(remarks.substr(remarks.rfind("together ") + 9)) > 0);
  CHECK(rows[0].error_measure == "energy");
  CHECK(rows[0].state_hash == rows[1].state_hash);
  CHECK(rows[0].ns_per_body_step > 0);
  // CSV and JSON hold the same under the same names
  const FlatJson json = flat_json("{\"rows\": " + bench_json(rows) + "}");
  std::istringstream names(bench_header()), cells(bench_csv(rows[1]));
  std::size_t columns = 0;
  for (std::string name, cell; std::getline(names, name, ',') && std::getline(cells, cell, ','); ++columns) {
    if (name.back() == '\n') name.pop_back();
    if (cell.back() == '\n') cell.pop_back();
    INFO(name);
    const std::string path = "rows.1." + name;
    if (const auto number = json.number(path))
      CHECK(std::stod(cell) == Approx(*number).epsilon(1e-5));  // CSV has six digits
    else
      CHECK(cell == (name == "size" ? "\"" + json.text(path) + "\"" : json.text(path)));
  }
  CHECK(columns == 9 + rows[1].stage_seconds.size());
}
