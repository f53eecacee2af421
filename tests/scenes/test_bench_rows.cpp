// What a row of `epafi bench` holds.
#include "scenes/study/bench.h"
#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"

using namespace epafi;

TEST_CASE("rows of a benchmark hold time, error and one hash for all threads", "[scenes][study]") {
  const TemporaryFolder folder;
  std::vector<std::string> rows;
  run_bench({std::string(EPAFI_SOURCE_DIR) + "/scenes/library/stacking/column.toml",
             {},
             {1, 2},
             1,
             folder / "b",
             true,
             std::string(EPAFI_BINARY_DIR) + "/bin/epafi"},
            [&](const std::string& row) { rows.push_back(row); });
  REQUIRE(rows.size() == 3);
  CHECK_THAT(rows[2], Catch::StartsWith("# ") && Catch::Contains("2 threads: ") && Catch::Contains("serial ") &&
                          Catch::Contains("as if "));
  CHECK_THAT(rows[2], Catch::Contains("# machine, 2 threads: arithmetic ") && Catch::Contains("triad ") &&
                          Catch::Contains("x, round trip of a cache line ") &&
                          Catch::Contains("# machine, 2 copies of the scene at once, one thread each: together "));
  CHECK(std::stod(rows[2].substr(rows[2].rfind("together ") + 9)) > 0);
  const auto cell = [](const std::string& row, int k) {
    std::size_t at = 0;
    while (k-- > 0) at = row.find(',', at) + 1;
    return row.substr(at, row.find(',', at) - at);
  };
  CHECK(cell(rows[0], 10) == "energy");
  CHECK(cell(rows[0], 12) == cell(rows[1], 12));  // state hash
  CHECK(std::stod(cell(rows[0], 3)) > 0);
}
