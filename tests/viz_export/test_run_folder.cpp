// What a folder without a run of its own is said to hold; rows of measures.csv read back; run files that are cut.
#include <fmt/format.h>

#include <chrono>
#include <fstream>
#include <random>

#include "engine/units/error.h"
#include "tests/support/catch.h"
#include "tests/viz_export/small_scene.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/run_folder.h"
#include "viz_export/files/run_mark.h"
#include "viz_export/files/side_file.h"
#include "viz_export/hdf5/stored_run.h"
#include "viz_export/measures/measure_rows.h"
#include "viz_export/measures/measures_csv.h"
#include "viz_export/view/view_source.h"

using namespace epafi;
using Catch::Contains;
namespace fs = std::filesystem;

TEST_CASE("a folder of runs and tables is told by what it holds and who takes it", "[viz_export][run_folder]") {
  const TemporaryFolder folder;
  const std::string name = folder.path().string();
  CHECK_THAT(no_run_text(folder / "none", "view"), Contains("there is no folder"));
  CHECK_THAT(no_run_text(folder.path(), "view"), Contains("run.h5 is missing"));
  std::ofstream(folder / "chart.csv") << "method\n";
  CHECK_THAT(no_run_text(folder.path(), "watch"), Contains("it holds chart.csv; `epafi report " + name + "`"));
  for (int k = 0; k < 6; ++k) {
    const fs::path one = folder / fmt::format("case_{:04}", k);
    fs::create_directories(one);
    std::ofstream(one / (k % 2 == 0 ? "run.h5" : "summary.json")) << "{}";
  }
  const std::string text = no_run_text(folder.path(), "render");
  CHECK_THAT(text, Contains("chart.csv and 6 runs") && Contains("`epafi report " + name + "`"));
  CHECK_THAT(text, Contains("`epafi render " + name + "/case_0000`") && Contains("case_0003 ...)"));
  CHECK(runs_in(folder.path()).size() == 6);
  CHECK(runs_in(folder.path(), "run.h5") ==
        std::vector<fs::path>{folder / "case_0000", folder / "case_0002", folder / "case_0004"});
  CHECK_THROWS_WITH(open_run(folder.path(), "view"), Contains("is no single run") && Contains("epafi report"));
  CHECK_THAT(no_run_text(folder / "chart.csv", "view"), Contains("is a file"));
}

TEST_CASE("rows of measures are read back as they were written, whatever their names", "[viz_export][measure_rows]") {
  const TemporaryFolder folder;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1e3, 1e3);
  const std::vector<std::string> names{"plain", "with, comma", "with \"quotes\"", "\u00b5", "a,\"b\",c"};
  std::vector<MeasureRow> written;
  {
    MeasuresCsv csv(folder / "measures.csv");
    for (int k = 0; k < 200; ++k) {
      written.push_back({0.001 * k, names[random() % names.size()], k % 2 == 0 ? "x" : "y", any(random)});
      csv.add(written.back().time, written.back().measure, written.back().component, written.back().value);
    }
  }
  std::ofstream(folder / "measures.csv", std::ios::app) << "0.3,plain,x,1";  // torn
  const auto read = measure_rows(folder / "measures.csv");
  REQUIRE(read.size() == written.size());
  for (std::size_t k = 0; k < read.size(); ++k) {
    CHECK(read[k].time == written[k].time);
    CHECK(read[k].measure == written[k].measure);
    CHECK(read[k].component == written[k].component);
    CHECK(read[k].value == written[k].value);
  }
  CHECK(measure_rows(folder / "measures.csv", 0.0995).size() == 100);
  CHECK(measure_rows(folder / "none.csv").empty());
}

TEST_CASE("garbled rows of measures are counted, with the line of the first", "[viz_export][measure_rows]") {
  std::mt19937 random(6);
  for (int k = 0; k < 20; ++k) {
    const TemporaryFolder folder;
    const std::vector<std::string> wrong{"0.1,a,x,1e", "zero,a,x,1", "0.1,x,1", "\x01\xff", "0.1;a;x;1", ""};
    std::size_t first = 0, count = 0;
    {
      std::ofstream out(folder / "progress.csv");
      out << "time,measure,component,value\n";
      for (std::size_t line = 2; line < 60; ++line) {
        const bool bad = k > 0 && random() % 20 == 0;
        first = bad && count == 0 ? line : first;
        count += bad ? 1 : 0;
        out << (bad ? wrong[random() % wrong.size()] : "0.1,a,x," + std::to_string(line)) << "\n";
      }
      out << "0.1,a,";  // torn: no fault
    }
    GarbledRows garbled;
    CHECK(measure_rows(folder / "progress.csv", 0.0, &garbled).size() == 58 - count);
    CHECK(garbled.count == count);
    CHECK(garbled.first_line == first);
    const std::string text = garbled.text(folder / "progress.csv");
    CHECK(text.empty() == (count == 0));
    if (count > 0) CHECK_THAT(text, Contains("progress.csv:" + std::to_string(first) + ": "));
  }
}

TEST_CASE("a run file cut at any place is told in plain words, with what still serves", "[viz_export][damaged]") {
  const TemporaryFolder folder;
  const fs::path path = folder / "run.h5";
  SmallScene scene(5);
  SurfaceCache surfaces(scene.shapes);
  {
    RunFile file(path, {"0", "beef", "title", "text", {}});
    for (std::uint64_t step = 0; step < 3; ++step)
      file.add_snapshot({step, 0.1 * static_cast<double>(step), "", true}, body_records(scene.world, surfaces));
  }
  std::ofstream(folder / "measures.csv") << "time,measure,component,value\n0.25,fall,z,1\n";
  std::ofstream(folder / "checkpoint.h5") << "there";
  fs::last_write_time(folder / "measures.csv", fs::file_time_type::clock::now() - std::chrono::seconds(60));
  const std::string good = read_whole_file(path);
  std::mt19937 random(11);
  for (int k = 0; k < 40; ++k) {
    const std::size_t size = k == 0 ? good.size() - 1 : 1 + random() % (good.size() - 1);
    write_whole_file(path, {std::string_view(good).substr(0, size)});
    fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::seconds(60));
    std::string said;
    try {
      const StoredRun run(path);
    } catch (const FileError& e) {
      said = e.what();
    }
    INFO(size << " of " << good.size() << ": " << said);
    CHECK_THAT(said, Contains("run.h5: is cut short") && Contains(std::to_string(size)));
    if (size >= 56) CHECK_THAT(said, Contains(fmt::format("{} of its {} bytes", size, good.size())));
    CHECK_THAT(said, Contains("measures.csv up to t = 0.25 s") && Contains("epafi resume " + folder.path().string()));
    CHECK_THAT(said, !Contains("eof") && !Contains("superblock") && !Contains("signature"));
    // what a resumed run says of it is the damage alone
    CHECK_THAT(damage_of(path), Contains("is cut short") && !Contains("resume"));
  }
  {
    const RunMark mark(folder.path());  // somebody is about to write it
    CHECK_THROWS_WITH(StoredRun(path), Contains("try again") && !Contains("resume"));
  }
  write_whole_file(path, {""});
  CHECK_THROWS_WITH(StoredRun(path), Contains("run.h5: is empty"));
  std::ofstream(folder / "summary.json") << "{}";
  CHECK_THROWS_WITH(StoredRun(path), Contains("`epafi run` with the scene makes it again"));
}
