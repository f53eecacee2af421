// `epafi watch`: rows of measures.csv as last values and courses.
#include <cstdlib>
#include <fstream>
#include <sstream>

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

TEST_CASE("watch shows what was chosen beside the run's own values, and long names in their column",
          "[scenes][watch]") {
  const TemporaryFolder folder;
  std::ofstream(folder / "summary.json") << R"({"status": "completed"})";
  std::ofstream progress(folder / "progress.csv");
  progress << "time,measure,component,value\n2,energy,kinetic,0.25\n2,contacts,number,7\n2,solver,residual,1e-9\n";
  progress.close();
  const std::string name(60, 'n');
  std::ofstream csv(folder / "measures.csv");
  csv << "time,measure,component,value\n1,fall,z,3\n1,other,z,4\n1," << name << ",distance,5\n";
  csv.close();
  const std::string run = folder.path().string();
  const Captured all = captured([&] { return command_watch(run); });
  for (const char* part : {"run: energy,kinetic", "run: contacts,number", "run: solver,residual", "fall,z", "other,z"})
    CHECK(all.out.find(part) != all.out.npos);
  CHECK(all.out.find("t = 2 s") != all.out.npos);
  CHECK(all.out.find(name) == all.out.npos);
  CHECK(all.out.find("..,distance") != all.out.npos);  // the component stays
  std::istringstream lines(all.out);
  for (std::string line; std::getline(lines, line);) CHECK(line.size() < 60);
  const Captured one = captured([&] { return command_watch(run, {"fall"}); });
  CHECK(one.out.find("fall,z") != one.out.npos);
  CHECK(one.out.find("other,z") == one.out.npos);
  CHECK(one.out.find("run: energy,kinetic") != one.out.npos);
  CHECK_THROWS_AS(command_watch(run, {"fal"}), SceneError);
}

TEST_CASE("a folder without a run cannot be watched", "[scenes][watch]") {
  const TemporaryFolder folder;
  CHECK_THROWS_AS(command_watch(folder.path().string()), FileError);
}
