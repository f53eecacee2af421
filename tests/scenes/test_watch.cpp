// `epafi watch`: rows of measures.csv as last values and courses.
#include <cstdlib>
#include <fstream>

#include "engine/units/error.h"
#include "scenes/cli/watch.h"
#include "tests/support/captured.h"
#include "tests/support/catch.h"

using namespace epafi;

TEST_CASE("watch shows the last value of each component, and ends with the run", "[scenes][watch]") {
  const TemporaryFolder folder;
  std::ofstream csv(folder / "measures.csv");
  csv << "time,measure,component,value\n";
  for (int k = 0; k <= 1000; ++k) csv << 0.001 * k << ",fall,z," << 1.0 - 0.001 * k << "\n";
  csv << "1.001,fall,z,0.5";  // torn: not yet a row
  csv.close();
  std::ofstream(folder / "summary.json") << R"({"status": "completed"})";
  const Captured said = captured([&] { return command_watch(folder.path().string()); });
  CHECK(said.code == 0);
  CHECK(said.out.find("t = 1 s") != said.out.npos);
  CHECK(said.out.find("fall,z") != said.out.npos);
  CHECK(said.out.find("▁") != said.out.npos);  // it ends at its least value
  CHECK(said.out.find("completed") != said.out.npos);
  CHECK(said.out.find("0.5 ") == said.out.npos);
}

TEST_CASE("a folder without a run cannot be watched", "[scenes][watch]") {
  const TemporaryFolder folder;
  CHECK_THROWS_AS(command_watch(folder.path().string()), FileError);
}
