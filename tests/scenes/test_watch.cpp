// `epafi watch`: rows of measures.csv as last values and courses.
#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>

#include "engine/units/error.h"
#include "scenes/cli/watch.h"
#include "tests/support/captured.h"
#include "tests/support/catch.h"
#include "viz_export/hdf5/run_file.h"

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
  for (std::string line; std::getline(lines, line);) CHECK(line.size() < 120);
  const Captured one = captured([&] { return command_watch(run, {"fall"}); });
  CHECK(one.out.find("fall,z") != one.out.npos);
  CHECK(one.out.find("other,z") == one.out.npos);
  CHECK(one.out.find("run: energy,kinetic") != one.out.npos);
  CHECK_THROWS_AS(command_watch(run, {"fal"}), SceneError);
}

TEST_CASE("every value of watch has its unit, and every course its least and largest value", "[scenes][watch]") {
  const TemporaryFolder folder;
  std::ofstream(folder / "summary.json") << R"({"status": "completed"})";
  {
    RunFile run(folder / "run.h5", {"0.1.0", "00ff", "t", "", {}});
    run.add_measure(run.define_measure("wall", {"x"}, "force"), 0.5, {1});
    run.flush();
  }
  std::ofstream csv(folder / "progress.csv");
  csv << "time,measure,component,value\n";
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  double low = 1, high = -1;
  for (int k = 0; k < 3000; ++k) {
    const double value = any(random);
    low = std::min(low, value);
    high = std::max(high, value);
    csv << fmt::format("{},energy,kinetic,{}\n{},contacts,number,7\n", 0.5 + k, value, 0.5 + k);
  }
  csv.close();
  std::ofstream(folder / "measures.csv") << "time,measure,component,value\n0.5,wall,x,1e-6\n0.5,new,overlap,1\n";
  const std::string out = captured([&] { return command_watch(folder.path().string()); }).out;
  CHECK(out.find("energy,kinetic [J]") != out.npos);
  CHECK(out.find("wall,x [N]") != out.npos);
  CHECK(out.find("new,overlap [m]") != out.npos);                           // not in run.h5: by its component
  CHECK(out.find(fmt::format("{:.4g} to {:.4g}", low, high)) != out.npos);  // also of what was thinned out
  CHECK(out.find("always 7") != out.npos);
  CHECK(out.find("courses from 0.5 s on") != out.npos);
}

TEST_CASE("the whole course stays in sight, however many rows there are", "[scenes][watch]") {
  for (const int rows : {3, 39, 41, 399, 401, 5000}) {
    const TemporaryFolder folder;
    std::ofstream(folder / "summary.json") << R"({"status": "completed"})";
    std::ofstream csv(folder / "measures.csv");
    csv << "time,measure,component,value\n";
    for (int k = 0; k < rows; ++k) csv << 0.001 * k << ",rise,z," << k << "\n";  // rises all the time
    csv.close();
    const std::string out = captured([&] { return command_watch(folder.path().string()); }).out;
    const std::size_t first = out.find("▁"), last = out.find("█");
    INFO(rows << out);
    REQUIRE(first != out.npos);
    CHECK(last > first);
    CHECK((last != out.npos || rows > 400));  // the last bar may be of a row that is thinned out
    CHECK(out.find(fmt::format("0 to {}", rows - 1)) != out.npos);
  }
}

TEST_CASE("a summary that is cut is reported by watch, after the values", "[scenes][watch]") {
  const std::string whole = R"({"epafi": "1", "status": "completed", "steps": 3})";
  for (std::size_t kept = 0; kept < whole.size(); ++kept) {
    const TemporaryFolder folder;
    std::ofstream(folder / "summary.json") << whole.substr(0, kept);
    std::ofstream(folder / "measures.csv") << "time,measure,component,value\n0.25,fall,z,3\n";
    const Captured said = captured([&] { return command_watch(folder.path().string()); });
    INFO(kept);
    CHECK(said.code == 4);
    CHECK(said.out.find("fall,z") != said.out.npos);
    CHECK(said.out.find("its last row is of t = 0.25 s; how it ended is not known") != said.out.npos);
  }
}

TEST_CASE("a folder without a run cannot be watched", "[scenes][watch]") {
  const TemporaryFolder folder;
  CHECK_THROWS_AS(command_watch(folder.path().string()), FileError);
}
