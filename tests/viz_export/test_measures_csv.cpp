#include "viz_export/measures/measures_csv.h"

#include <fstream>

#include "engine/units/error.h"
#include "tests/support/catch.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/side_file.h"

using namespace epafi;

TEST_CASE("measures.csv is long, keeps 17 digits and quotes what needs it", "[viz_export][csv]") {
  const TemporaryFolder folder;
  {
    MeasuresCsv csv(folder / "m.csv");
    csv.add(0.1, "outflow", "rate", 1.0 / 3.0);
    csv.add(0.2, "a,\"b\"", "x", -0.0);
  }
  CHECK(read_whole_file(folder / "m.csv") ==
        "time,measure,component,value\n"
        "0.10000000000000001,outflow,rate,0.33333333333333331\n"
        "0.20000000000000001,\"a,\"\"b\"\"\",x,-0\n");
}

TEST_CASE("a continued measures.csv equals the one of an uninterrupted run", "[viz_export][csv]") {
  const TemporaryFolder folder;
  const auto fill = [](MeasuresCsv& csv, int from, int to) {
    for (int k = from; k < to; ++k) {
      csv.add(k * 0.1, "energy", "kinetic", 1.0 / k);
      csv.add(k * 0.1, "two\nlines", "x", k);
    }
  };
  {
    MeasuresCsv straight(folder / "straight.csv"), stopped(folder / "stopped.csv");
    fill(straight, 1, 5000);
    fill(stopped, 1, 3000);
  }
  std::ofstream(folder / "stopped.csv", std::ios::app) << "300.0,energy,kine";  // torn by a crash
  {
    MeasuresCsv resumed(folder / "stopped.csv", 1999 * 0.1);  // checkpoint after sample 1999
    fill(resumed, 2000, 5000);
  }
  CHECK(read_whole_file(folder / "stopped.csv") == read_whole_file(folder / "straight.csv"));
}

TEST_CASE("a file that is not measures.csv is not cut", "[viz_export][csv]") {
  const TemporaryFolder folder;
  write_whole_file(folder / "m.csv", {"1,2,3\n4,5,6\n"});
  CHECK_THROWS_WITH(MeasuresCsv(folder / "m.csv", 1.0), Catch::Contains("first line"));
  CHECK(read_whole_file(folder / "m.csv") == "1,2,3\n4,5,6\n");
}
