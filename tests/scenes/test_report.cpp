// The report page: complete in itself, every part there; in a real browser (slow) it shows what it says.
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/document.h"

namespace fs = std::filesystem;

namespace {

int shell(const std::string& command) { return std::system(command.c_str()); }

/// A run of the first tutorial's scene cut short, with its page.
struct ReportedRun {
  fs::path folder = fs::temp_directory_path() / ("epafi-report-" + std::to_string(::getpid()));
  std::string page;
  explicit ReportedRun(const std::string& name = "tutorials/04_stones.toml",
                       const std::string& options = "--set params.n=5 --until 0.2") {
    fs::remove_all(folder);
    const std::string program = std::string(EPAFI_BINARY_DIR) + "/bin/epafi";
    const std::string scene = std::string(EPAFI_SOURCE_DIR) + "/scenes/library/" + name;
    REQUIRE(shell(program + " run " + scene + " -q " + options + " -o " + folder.string() + " 2>/dev/null") == 0);
    REQUIRE(shell(program + " report " + folder.string() + " 2>/dev/null") == 0);
    page = epafi::support::read_text(folder / "report.html");
  }
  ~ReportedRun() { fs::remove_all(folder); }
};

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("a report has all its parts and asks for nothing from outside", "[scenes][report][long]") {
  const ReportedRun run;
  for (const char* part : {"Pictures", "In three dimensions", "Energy balance", "Measures", "Overlap and checks",
                           "Where the time went", "Settings"})
    CHECK(count(run.page, std::string("<h2>") + part + "</h2>") == 1);
  CHECK(count(run.page, "src='data:image/png;base64,") >=
        5);                                                 // the run has five snapshots; contacts where they are few
  CHECK(run.page.find("energy [J]") != run.page.npos);      // one quantity with its unit on each axis
  CHECK(count(run.page, "params.n=5") >= 1);                // the override
  CHECK(run.page.find("solid = { file") != run.page.npos);  // the scene
  // nothing is fetched: every source is in the page, no style sheet, no import; the only script stands within the frame
  // in three dimensions
  CHECK(count(run.page, "src='") == count(run.page, "src='data:image/"));
  for (const char* outside : {"<script", "<link", "@import", "url("}) CHECK(count(run.page, outside) == 0);
  if (shell("command -v gnuplot > /dev/null") == 0) CHECK(count(run.page, "src='data:image") >= 2);
  const std::string state = epafi::support::read_text(run.folder / "summary.json");
  const auto at = state.find("\"state_hash\": \"");
  REQUIRE(at != state.npos);
  CHECK(run.page.find(state.substr(at + 15, 16)) != run.page.npos);
}

TEST_CASE("a report names the stages of a run, how each ended, and the stage of each picture", "[scenes][report]") {
  const ReportedRun run("stages/clamp.toml", "");
  CHECK(count(run.page, "<h2>Stages</h2>") == 1);
  for (const char* row : {"<td>close</td><td class='n'>0</td><td class='n'>2.5</td><td>duration</td>",
                          "<td>clamp</td><td class='n'>2.5</td><td class='n'>3</td><td>duration</td>",
                          "<td>ease</td><td class='n'>3</td><td class='n'>3.5</td><td>duration</td>"})
    CHECK(count(run.page, row) == 1);
  CHECK(count(run.page, "t = 0 s, stage 'close'") == 1);
  CHECK(count(run.page, "t = 3.5 s, stage 'ease'") >= 1);
  CHECK(count(run.page, " s, stage 'clamp'") >= 1);  // it is short, and has a picture all the same
  CHECK(ReportedRun().page.find("<h2>Stages</h2>") == std::string::npos);
}

TEST_CASE("a report elsewhere leaves the run's folder as it is", "[scenes][report]") {
  const ReportedRun run;
  const std::string command = std::string(EPAFI_BINARY_DIR) + "/bin/epafi report " + run.folder.string() + " -o ";
  const fs::path elsewhere = fs::path(run.folder) += "-elsewhere";
  fs::remove_all(elsewhere);
  CHECK(shell(command + (elsewhere / "page.html").string() + " 2> /dev/null") != 0);  // there is no such folder
  CHECK_FALSE(fs::exists(elsewhere));
  fs::create_directories(elsewhere);
  const auto before = fs::last_write_time(run.folder);
  REQUIRE(shell(command + (elsewhere / "page.html").string() + " 2> /dev/null") == 0);
  CHECK(fs::last_write_time(run.folder) == before);  // nothing came or went
  CHECK(std::distance(fs::directory_iterator(elsewhere), fs::directory_iterator()) == 1);
  fs::remove_all(elsewhere);
}

TEST_CASE("run.h5 needs h5py alone: the example reads the energy of the summary", "[scenes][report]") {
  const std::string python = "/usr/bin/python3";
  if (!fs::exists(python) || shell(python + " -c 'import h5py' 2> /dev/null") != 0) {
    WARN("skipped: no python3-h5py here");
    return;
  }
  const ReportedRun run;
  const fs::path said = run.folder / "said";
  REQUIRE(shell(python + " " + EPAFI_SOURCE_DIR + "/examples/read_run.py " + run.folder.string() + " > " +
                said.string()) == 0);
  const std::string text = epafi::support::read_text(said),
                    summary = epafi::support::read_text(run.folder / "summary.json");
  CHECK(count(text, "t = ") == 5);  // at 0, 0.05, 0.1, 0.15, 0.2 s
  CHECK(text.find("measure energy ") != text.npos);
  const double last = std::stod(text.substr(text.rfind("kinetic energy ") + 15));
  const double expected = std::stod(summary.substr(summary.find("\"kinetic\": ") + 11));
  CHECK(last == Approx(expected).epsilon(1e-5));  // six digits are printed
}

TEST_CASE("a folder of cases and tables shows how each case ended and folds long tables", "[scenes][report][long]") {
  const ReportedRun run;
  const fs::path folder = fs::temp_directory_path() / ("epafi-cases-" + std::to_string(::getpid()));
  fs::remove_all(folder);
  fs::create_directories(folder);
  for (const char* name : {"first", "second"}) fs::copy(run.folder, folder / name, fs::copy_options::recursive);
  std::ofstream(folder / "short.csv") << "a,b\n1,<2>\n";
  std::ofstream longer(folder / "long.csv");
  longer << "a\n";
  for (int k = 0; k < 100; ++k) longer << k << "\n";
  longer.close();
  REQUIRE(shell(std::string(EPAFI_BINARY_DIR) + "/bin/epafi report " + folder.string() + " 2>/dev/null") == 0);
  const std::string page = epafi::support::read_text(folder / "report.html");
  CHECK(count(page, "src='data:image/png;base64,") == 2);
  CHECK(count(page, "<figcaption>first</figcaption>") == 1);
  CHECK(count(page, "<td>&lt;2&gt;</td>") == 1);
  CHECK(count(page, "<summary>100 rows</summary>") == 1);
  // heads stand over their columns: of both tables, and of the cases
  CHECK(count(page, "<th class='n'>a</th>") == 2);
  CHECK(count(page, "<th>b</th>") == 1);
  CHECK(count(page, "<th class='n'>bodies</th>") == 1);
  CHECK(count(page, "<th>status</th>") == 1);
  CHECK(count(page, "<details>") == 1);
  fs::remove_all(folder);
}

TEST_CASE("tables of a study can be read: short numbers, the picture first, constants below", "[scenes][report]") {
  const fs::path folder = fs::temp_directory_path() / ("epafi-study-report-" + std::to_string(::getpid()));
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::mt19937_64 random(3);
  std::ofstream table(folder / "chart.csv");
  table << "method,settings,time,count,status,reasons\n";
  std::vector<std::string> numbers, counts;
  const std::string settings = "contact.nonsmooth.iterations=5; contact.nonsmooth.tolerance=1e-9";
  for (int row = 0; row < 6; ++row) {
    char number[64];
    std::snprintf(number, sizeof number, "%.17g", std::ldexp(static_cast<double>(random()), -60 - row));
    numbers.emplace_back(number);
    counts.push_back(std::to_string(random() % 1000000 + 1000000000));
    table << "m" << row << "," << settings << row << "," << numbers.back() << "," << counts.back() << ",completed,\n";
  }
  table.close();
  std::ofstream(folder / "chart.json") << R"({"title": "Speed & accuracy"})";
  std::ofstream(folder / "chart.svg") << "<svg xmlns='http://www.w3.org/2000/svg'></svg>";
  REQUIRE(shell(std::string(EPAFI_BINARY_DIR) + "/bin/epafi report " + folder.string() + " 2>/dev/null") == 0);
  const std::string page = epafi::support::read_text(folder / "report.html");
  CHECK(page.find("<h1>Speed &amp; accuracy</h1>") != page.npos);
  CHECK(page.find("data:image/svg+xml") < page.find("<table"));
  CHECK(page.find("The same in all rows: status = completed<") != page.npos);
  CHECK(page.find("Empty in all rows: reasons<") != page.npos);
  CHECK(count(page, "<td>completed</td>") == 0);
  CHECK(count(page, "<div class='long'>" + settings) == 6);
  for (const std::string& number : numbers) {
    CHECK(page.find(number) == page.npos);
    char shown[64];
    std::snprintf(shown, sizeof shown, "<td class='n'>%.6g</td>", std::stod(number));
    CHECK(page.find(shown) != page.npos);
  }
  for (const std::string& whole : counts) CHECK(page.find("<td class='n'>" + whole + "</td>") != page.npos);
  fs::remove_all(folder);
}

TEST_CASE("the report of a sweep plots what came out over what was swept", "[scenes][report][long]") {
  const fs::path folder = fs::temp_directory_path() / ("epafi-sweep-report-" + std::to_string(::getpid()));
  fs::remove_all(folder);
  const std::string program = std::string(EPAFI_BINARY_DIR) + "/bin/epafi";
  const std::string scene = std::string(EPAFI_SOURCE_DIR) + "/scenes/library/tutorials/05_sweep.toml";
  REQUIRE(shell(program + " sweep " + scene + " -q --set params.n=20 --set run.duration=0.1 -o " + folder.string() +
                " > /dev/null 2>&1") == 0);
  REQUIRE(shell(program + " report " + folder.string() + " 2>/dev/null") == 0);
  const std::string page = epafi::support::read_text(folder / "report.html");
  CHECK(page.find("This table moves sideways") != page.npos);
  CHECK(std::distance(fs::directory_iterator(folder), fs::directory_iterator()) == 8);  // cases, mark, page: no parts
  if (shell("command -v gnuplot > /dev/null") != 0) {
    CHECK(page.find("gnuplot is not installed") != page.npos);
  } else {
    CHECK(count(page, "<h2>What came out</h2>") == 1);
    for (const char* axis : {"x", "y", "z"})  // of the heap: over the friction, not over the seed
      CHECK(count(page, std::string("<figcaption>heap.") + axis + " at the end [m] over params.mu</figcaption>") == 1);
    CHECK(count(page, "data:image/svg+xml;base64,") == count(page, "over params.mu</figcaption>"));
  }
  fs::remove_all(folder);
}

TEST_CASE("a folder of runs has the title of their scene, of several scenes its own name", "[scenes][report]") {
  const fs::path folder = fs::temp_directory_path() / ("epafi-titles-" + std::to_string(::getpid())) / "collection";
  for (const bool same : {true, false}) {
    fs::remove_all(folder);
    fs::create_directories(folder);
    for (const char* name : {"one", "two"}) {
      const std::string title = same || name[0] == 'o' ? "A falling ball" : "Another ball";
      std::ofstream(folder / "scene.toml")
          << "title = \"" << title
          << "\"\n[run]\nduration = 0.01\ntime_step = 1e-3\noutput_interval = 0.005\n[material.m]\ndensity = 1000\n"
             "[[body]]\nshape = { sphere = { radius = 0.1 } }\nmaterial = \"m\"\n";
      REQUIRE(shell(std::string(EPAFI_BINARY_DIR) + "/bin/epafi run " + (folder / "scene.toml").string() + " -q -o " +
                    (folder / name).string() + " 2>/dev/null") == 0);
    }
    REQUIRE(shell(std::string(EPAFI_BINARY_DIR) + "/bin/epafi report " + folder.string() + " 2>/dev/null") == 0);
    const std::string page = epafi::support::read_text(folder / "report.html");
    CHECK(count(page, same ? "<h1>A falling ball</h1>" : "<h1>collection</h1>") == 1);
  }
  fs::remove_all(folder.parent_path());
}

TEST_CASE("warnings of cases stand above the chart, many of them folded up", "[scenes][report]") {
  const fs::path folder = fs::temp_directory_path() / ("epafi-warned-report-" + std::to_string(::getpid()));
  for (const int warnings : {0, 1, 3, 4, 60}) {
    fs::remove_all(folder);
    fs::create_directories(folder / "case_000");
    std::string list;
    for (int k = 0; k < warnings; ++k) list += (k > 0 ? ", \"w" : "\"w") + std::to_string(k) + " is wrong\"";
    std::ofstream(folder / "case_000" / "summary.json") << R"({"status": "completed", "warnings": [)" << list << "]}";
    std::ofstream(folder / "chart.csv") << "method,time\na,1\nb,2\n";
    std::ofstream(folder / "chart.json") << R"({"title": "warned"})";
    std::ofstream(folder / "chart.svg") << "<svg xmlns='http://www.w3.org/2000/svg'></svg>";
    REQUIRE(shell(std::string(EPAFI_BINARY_DIR) + "/bin/epafi report " + folder.string() + " 2>/dev/null") == 0);
    const std::string page = epafi::support::read_text(folder / "report.html");
    CHECK(count(page, "is wrong</p>") == static_cast<std::size_t>(warnings));
    CHECK(count(page, "<details class='warnings'>") == (warnings > 3 ? 1 : 0));
    if (warnings > 0) CHECK(page.rfind("is wrong</p>") < page.find("data:image/svg+xml"));
    if (warnings > 3) CHECK(page.find("<details class='warnings'>") < page.find("w3 is wrong"));
  }
  fs::remove_all(folder);
}

TEST_CASE("a folder without a run has no report, and the message says why", "[scenes][report]") {
  const fs::path folder = fs::temp_directory_path() / ("epafi-no-report-" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const std::string command =
      std::string(EPAFI_BINARY_DIR) + "/bin/epafi report " + folder.string() + " 2> " + (folder / "said").string();
  CHECK(WEXITSTATUS(shell(command)) == 3);
  CHECK(epafi::support::read_text(folder / "said").find("run.h5 is missing") != std::string::npos);
  fs::remove_all(folder);
}

TEST_CASE("a browser shows the report without a network", "[scenes][report][slow]") {
  std::string browser;
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
    if (browser.empty() && shell(std::string("command -v ") + name + " > /dev/null") == 0) browser = name;
  if (browser.empty()) {
    WARN("skipped: no Chromium here");
    return;
  }
  const ReportedRun run;
  const std::string common =
      "cd " + run.folder.string() + " && timeout 120 " + browser +
      " --headless --no-sandbox --disable-gpu --user-data-dir=profile --host-resolver-rules='MAP * ~NOTFOUND'"
      " --window-size=1100,2400 ";
  REQUIRE(shell(common + "--dump-dom report.html > dom.html 2> log") == 0);
  const std::string dom = epafi::support::read_text(run.folder / "dom.html");
  for (const char* part : {"Pictures", "Energy balance", "Measures", "Where the time went", "Settings"})
    CHECK(dom.find(part) != std::string::npos);
  CHECK(count(dom, "<figure>") == count(run.page, "<figure>"));  // parsed as written: nothing left open
  REQUIRE(shell(common + "--hide-scrollbars --screenshot=page.png report.html 2> log") == 0);
  CHECK(fs::file_size(run.folder / "page.png") > 60000);  // a blank page of this size takes 12 kB
}
