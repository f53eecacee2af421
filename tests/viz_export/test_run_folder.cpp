// What a folder without a run of its own is said to hold; rows of measures.csv read back; run files that are cut.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <random>

#include "engine/units/error.h"
#include "tests/support/catch.h"
#include "tests/viz_export/small_scene.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/files/page_target.h"
#include "viz_export/files/run_folder.h"
#include "viz_export/files/run_mark.h"
#include "viz_export/files/side_file.h"
#include "viz_export/files/study_mark.h"
#include "viz_export/hdf5/run_file.h"
#include "viz_export/hdf5/stored_run.h"
#include "viz_export/measures/measure_rows.h"
#include "viz_export/measures/measures_csv.h"
#include "viz_export/report/report.h"
#include "viz_export/report/report_table.h"
#include "viz_export/view/view_source.h"

using namespace epafi;
using Catch::Contains;
namespace fs = std::filesystem;

TEST_CASE("a folder of runs and tables is named by what it holds and which command takes it",
          "[viz_export][run_folder]") {
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

TEST_CASE("a folder that is no run is named for what it is", "[viz_export][run_folder]") {
  const TemporaryFolder folder;
  const std::string name = folder.path().string();
  CHECK_THAT(no_run_text(folder.path(), "view"), Contains("it is empty"));
  std::ofstream(folder / "notes.txt") << "-";
  CHECK_THAT(no_run_text(folder.path(), "view"), Contains("it holds notes.txt"));
  for (const char* scene : {"b.toml", "a.toml", "c.toml", "d.toml", "e.toml", "f.toml"})
    std::ofstream(folder / scene) << "title = 'a'";
  CHECK_THAT(no_run_text(folder.path(), "render"),
             Contains("a.toml, b.toml, c.toml, d.toml and 2 more") && Contains("`epafi run " + name + "/a.toml`"));
  const fs::path run = folder / "run";
  fs::create_directories(run / "frames");
  std::ofstream(run / "run.h5") << "-";
  for (const char* command : {"view", "render", "report", "watch"}) {
    const std::string takes = "`epafi " + std::string(command) + " " + run.string() + "` takes it";
    CHECK_THAT(no_run_text(run / "frames", command), Contains("a part of the run") && Contains(takes));
    CHECK_THAT(no_run_text(run / "frames/", command), Contains(takes));
    CHECK_THAT(no_run_text(run / "run.h5", command), Contains("a file of the run") && Contains(takes));
  }
  fs::remove(run / "run.h5");
  for (const char* left : {"summary.json", "checkpoint.h5", "progress.csv"}) {
    std::ofstream(run / left) << "-";
    CHECK(was_run(run));
    std::ofstream(run / "measures.csv") << "time,measure,component,value\n0.5,a,x,1\n";
    fs::last_write_time(run / "measures.csv", fs::file_time_type::clock::now() - std::chrono::hours(1));
    const std::string text = no_run_text(run, "report");
    CHECK_THAT(text, Contains("the folder of a run, but run.h5 is missing") && Contains("up to t = 0.5 s"));
    CHECK_THAT(text, !Contains("epafi report"));  // which would say the same
    CHECK_THAT(text, Contains(left == std::string("checkpoint.h5") ? "`epafi resume" : "`epafi run`"));
    fs::remove(run / left);
  }
  CHECK(!was_run(run));
}

TEST_CASE("a study that has not come to its end says what is missing", "[viz_export][run_folder]") {
  const TemporaryFolder folder;
  CHECK(!read_study_mark(folder.path()));
  std::mt19937 random(3);
  for (int k = 0; k < 20; ++k) {
    const char* kind = k % 3 == 0 ? "chart" : k % 3 == 1 ? "limits" : "sweep";
    StudyMark mark{kind, "epafi " + std::string(kind) + " a\"b.toml", random() % 50};
    write_study_mark(folder.path(), mark);
    const auto read = read_study_mark(folder.path());
    REQUIRE(read);
    CHECK(read->kind == mark.kind);
    CHECK(read->command == mark.command);
    CHECK(read->cases == mark.cases);
    CHECK(!read->finished);
    const std::size_t ended = random() % 50;
    const bool is_over = mark.kind == "sweep" && ended >= mark.cases;
    CHECK(unfinished_text(*read, ended).empty() == is_over);
    if (!is_over && mark.cases > 0)
      CHECK_THAT(unfinished_text(*read, ended), Contains(fmt::format("{} of its {} cases", ended, mark.cases)));
    mark.finished = true;
    write_study_mark(folder.path(), mark);
    CHECK(unfinished_text(*read_study_mark(folder.path()), 0).empty());
  }
  for (const char* torn : {"", "{", "[1]", "{\"cases\": 3}", "\xff"}) {
    std::ofstream(folder / "study.json") << torn;
    CHECK(!read_study_mark(folder.path()));
  }
}

TEST_CASE("a report draws the curves of a measure, or says how many it leaves out", "[viz_export][report]") {
  if (std::system("command -v gnuplot > /dev/null") != 0) {
    WARN("skipped: no gnuplot here");
    return;
  }
  for (const std::size_t width : {1, 8, 9, 30, 32, 33, 100}) {
    const TemporaryFolder folder;
    {
      RunFile run(folder / "run.h5", {"0.1.0", "00ff", "t", "", {}});
      std::vector<std::string> components;
      for (std::size_t c = 0; c < width; ++c) components.push_back(fmt::format("velocity_{}", c));
      const std::size_t measure = run.define_measure("profile", components, "profile");
      for (int k = 0; k < 5; ++k) {
        std::vector<double> row;
        for (std::size_t c = 0; c < width; ++c) row.push_back(k + 0.1 * static_cast<double>(c));
        run.add_measure(measure, k, row);
      }
      run.flush();
    }
    write_whole_file(folder / "summary.json", {R"({"status": "completed"})"});
    const std::string page = read_whole_file(write_report(folder.path(), ""));
    std::size_t figures = 0;
    for (std::size_t at = page.find("alt=\"profile\""); at != page.npos; at = page.find("alt=\"profile\"", at + 1))
      ++figures;
    const bool all = width <= 32;
    CHECK(figures == (all ? (width + 7) / 8 : 1));
    CHECK((page.find(fmt::format("; 8 of {} curves are drawn", width)) == page.npos) == all);
    if (all && width > 8) CHECK_THAT(page, Contains(fmt::format("(1 of {})", (width + 7) / 8)));
  }
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

TEST_CASE("a run file cut at any place is reported in plain words, with what is left", "[viz_export][damaged]") {
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

TEST_CASE("a run file that may not be read is not called damaged", "[viz_export][damaged]") {
  const TemporaryFolder folder;
  const fs::path path = folder / "run.h5";
  { const RunFile file(path, {"0", "beef", "title", "text", {}}); }
  std::ofstream(folder / "summary.json") << "{}";
  fs::permissions(folder.path(), fs::perms::all);
  fs::permissions(path, fs::perms::none);
  const bool almighty = ::geteuid() == 0;  // who may read all: another user cannot
  if (almighty) REQUIRE(::seteuid(65534) == 0);
  std::string said;
  try {
    (void)open_run(folder.path());
  } catch (const FileError& e) {
    said = e.what();
  }
  const std::string damage = damage_of(path);
  if (almighty) REQUIRE(::seteuid(0) == 0);
  CHECK_THAT(said,
             Contains("run.h5: cannot be read: Permission denied") && !Contains("again") && !Contains("cut short"));
  CHECK_THAT(damage, Contains("Permission denied"));
}

TEST_CASE("what reads another file of a run says that this one is missing", "[viz_export]") {
  const TemporaryFolder folder;
  for (const char* file : {"run.h5", "summary.json"}) std::ofstream(folder / file) << "x";
  const std::string text = no_run_text(folder.path(), "watch", "measures.csv");
  CHECK_THAT(text, Contains("measures.csv is missing") && Contains("run.h5 is there"));
  fs::remove(folder / "run.h5");
  CHECK_THAT(no_run_text(folder.path(), "watch", "measures.csv"), Contains("run.h5 is missing"));
}

TEST_CASE("pages have the ending of pages", "[viz_export]") {
  const TemporaryFolder folder;
  for (const char* name : {"a.html", "b.HTM", "c.x.html"}) CHECK_NOTHROW(require_page_target(folder / name));
  for (const char* name : {"a.pdf", "b", "c.html.pdf", "d.png", "e."}) {
    INFO(name);
    CHECK_THROWS_WITH(require_page_target(folder / name), Contains("expected an ending .html"));
  }
  CHECK_NOTHROW(require_page_target("/dev/null"));
}

TEST_CASE("the page of unfinished limits counts its cases as its table has them", "[viz_export][run_folder]") {
  std::mt19937 random(36);
  for (int round = 0; round < 6; ++round) {
    const TemporaryFolder folder;
    const std::size_t cases = 1 + random() % 8;
    for (std::size_t k = 0; k < cases; ++k) {
      const fs::path one = folder / fmt::format("penalty_step={}", k);
      fs::create_directories(one);
      std::ofstream(one / "summary.json") << "{\"status\": \"" << (k % 3 == 2 ? "failed" : "completed") << "\"}";
    }
    write_study_mark(folder.path(), {"limits", "epafi limits a.toml"});
    const std::string page = read_whole_file(write_report(folder.path(), ""));
    CHECK_THAT(page, Contains(fmt::format(": {} case{}</p>", cases, cases > 1 ? "s" : "")));
    CHECK_THAT(page, Contains(fmt::format("{} of its cases ha{} ended", cases, cases > 1 ? "ve" : "s")));
  }
}

TEST_CASE("tables write six digits of numbers that have more", "[viz_export]") {
  TableColumn column{"step", {"0.123456789012345", "3", "", "12345678", "1e-05"}};
  column.shorten();
  CHECK(column.cells == std::vector<std::string>{"0.123457", "3", "", "12345678", "1e-05"});
  TableColumn words{"name", {"0.123456789012345", "steel"}};
  words.shorten();
  CHECK(words.cells.front() == "0.123456789012345");
}
