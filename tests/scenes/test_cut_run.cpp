// A run that is killed at any moment: report, page, watch and resume know it, and say until when it went.
#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <random>

#include "scenes/cli/watch.h"
#include "tests/support/captured.h"
#include "tests/support/catch.h"
#include "tests/support/document.h"
#include "tests/support/scene_text.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/files/run_mark.h"
#include "viz_export/measures/measure_rows.h"
#include "viz_export/report/run_facts.h"
#include "viz_export/view/page.h"

using namespace epafi;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

const std::string falling = R"toml(
title = "Ten balls on a floor"
[run]
duration = 1000.0
time_step = 2e-6
output_interval = 0.005
checkpoint_interval = 0.004
)toml" + experiments::soft_glass() +
                            experiments::half_space_floor("glass") + R"toml(
[[body]]
name = "ball"
repeat = 10
shape = { sphere = { radius = 0.05 } }
material = "glass"
position = ["= 0.2*i", 0, "= 0.06 + 0.01*i"]
[[measure]]
name = "first"
kind = "position"
body = "ball[0]"
interval = 1e-4
)toml";

constexpr const char* program = EPAFI_BINARY_DIR "/bin/epafi";

/// `epafi run` or `resume` as a process that can be killed.
class RunningProgram {
 public:
  explicit RunningProgram(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), program);
    std::vector<char*> raw;
    for (std::string& a : arguments) raw.push_back(a.data());
    raw.push_back(nullptr);
    child_ = ::fork();
    if (child_ != 0) return;
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, 1);
    ::dup2(nowhere, 2);
    ::execv(program, raw.data());
    ::_exit(127);
  }
  ~RunningProgram() { kill(); }
  void kill() {
    if (child_ <= 0) return;
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
    child_ = -1;
  }

 private:
  pid_t child_ = -1;
};

int program_result(const std::string& arguments) {
  const int status = std::system((std::string(program) + " " + arguments + " > /dev/null 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

template <class Holds>
bool holds_soon(const Holds& holds) {
  for (int k = 0; k < 400; ++k) {
    if (holds()) return true;
    ::usleep(50'000);
  }
  return false;
}

std::size_t frames_in(const fs::path& run) {
  std::error_code none;
  std::size_t out = 0;
  for (const auto& entry : fs::directory_iterator(run / "frames", none)) out += entry.exists() ? 1 : 0;
  return out;
}

/// The report and the page say that the run was cut, and hold all that it wrote.
void check_report_of_cut(const fs::path& run) {
  REQUIRE(program_result("report " + run.string()) == 0);
  const std::string page = support::read_text(run / "report.html");
  const std::size_t told = page.find("The run was cut off after t = ");
  CHECK(told < page.find("class='cards'"));
  for (const char* part : {"Pictures", "Energy balance", "Measures", "Settings"})
    CHECK_THAT(page, Contains(std::string("<h2>") + part + "</h2>"));
  if (page_parts().three[0] != '\0') CHECK_THAT(page, Contains("<h2>In three dimensions</h2>"));
  CHECK_THAT(page, Contains("data:image/png") && Contains("epafi resume") && !Contains("Where the time went"));

  const Captured watched = captured([&] { return command_watch(run.string()); });
  CHECK(watched.code == 4);
  CHECK_THAT(watched.out, Contains("the run was cut off after t = ") && Contains("run: energy,kinetic"));
  CHECK_THAT(watched.out, Contains("run: contacts,number") && Contains("first,z"));
}

void check_page_of_cut(const fs::path& run, const fs::path& file) {
  if (page_parts().three[0] == '\0') return;
  REQUIRE(program_result("view " + run.string() + " --out " + file.string()) == 0);
  const std::string mailed = support::read_text(file);
  CHECK_THAT(mailed, Contains("\"running\": false") || Contains("\"running\":false"));
  CHECK_THAT(mailed, Contains("the run was cut off after t = "));
}

/// It goes on to `end` [s].
void check_resumed_until(const fs::path& run, double end) {
  REQUIRE(program_result("resume " + run.string() + " -q --until " + std::to_string(end)) == 0);
  CHECK(run_state(run).life == RunLife::over);
  CHECK_FALSE(fs::exists(run / ".running"));
  CHECK(open_run(run)->cut_text().empty());
  // each time has been written once
  double before = -1;
  for (const MeasureRow& row : measure_rows(run / "progress.csv")) {
    if (row.measure != "contacts" || row.component != "number") continue;
    CHECK(row.time > before);
    before = row.time;
  }
  CHECK(before == Approx(end).epsilon(1e-4));
}

}  // namespace

TEST_CASE("a killed run has the full report, told as cut, and can be resumed", "[scenes][cut_run][long]") {
  std::mt19937 random(21);
  for (int round = 0; round < 2; ++round) {
    const TemporaryFolder folder;
    const fs::path run = folder / "run";
    std::ofstream(folder / "scene.toml") << falling;
    {
      RunningProgram running({"run", (folder / "scene.toml").string(), "-q", "-t", "1", "-o", run.string()});
      REQUIRE(holds_soon([&] { return frames_in(run) > 6 && measure_rows(run / "progress.csv").size() > 20; }));
      CHECK(run_state(run).life == RunLife::running);
      CHECK(open_run(run)->is_running());
      ::usleep(static_cast<useconds_t>(1000 * (random() % 700)));
      running.kill();
    }
    REQUIRE_FALSE(fs::exists(run / "summary.json"));
    const auto source = open_run(run);
    CHECK_FALSE(source->is_running());
    CHECK_THAT(source->cut_text(), Contains("was cut off after t = "));
    // nothing of what was written is left out: the last row of measures.csv is later than the last frame, or as late
    const double last = source->last_time();
    CHECK(last >= source->times().back());
    CHECK(last >= measure_rows(run / "measures.csv").back().time);
    const FlatJson facts = run_facts(run, *source);
    CHECK(facts.text("status") == "cut");
    CHECK(facts.number("bodies").value() == 11);
    // run.h5 is written first: it may be ahead by one frame
    const MeasureRow row = measure_rows(run / "measures.csv").back();
    const ViewFrame frame = source->frame(source->times().size() - 1);
    const double height = row.time >= frame.time ? row.value : frame.bodies[1].pose.position.z();
    CHECK(facts.number("measures.first.z.last").value() == Approx(height));
    CHECK(facts.number("energy.kinetic").has_value());

    check_report_of_cut(run);
    check_page_of_cut(run, folder / "page.html");
    check_resumed_until(run, last + 0.01);
  }
}

TEST_CASE("a resumed run is running, not over by its earlier end; killed, it is cut", "[scenes][cut_run][long]") {
  const TemporaryFolder folder;
  const fs::path run = folder / "run";
  std::ofstream(folder / "scene.toml") << falling;
  REQUIRE(program_result("run " + (folder / "scene.toml").string() + " -q -t 1 --until 0.02 -o " + run.string()) == 0);
  CHECK(run_state(run).life == RunLife::over);
  RunningProgram running({"resume", run.string(), "-q", "-t", "1"});
  REQUIRE(holds_soon([&] { return run_state(run).life == RunLife::running; }));
  running.kill();
  CHECK(run_state(run).life == RunLife::cut);
}

TEST_CASE("the energies that a run tells of itself are those that its scene would measure", "[scenes][cut_run]") {
  const TemporaryFolder folder;
  const fs::path run = folder / "run";
  std::ofstream(folder / "scene.toml") << falling
                                       << "[[measure]]\nname = \"balance\"\nkind = \"energy\"\ninterval = 0\n";
  REQUIRE(program_result("run " + (folder / "scene.toml").string() + " -q -t 1 --set run.duration=0.02 -o " +
                         run.string()) == 0);
  std::map<std::pair<double, std::string>, double> measured;
  for (const MeasureRow& row : measure_rows(run / "measures.csv"))
    if (row.measure == "balance") measured[{row.time, row.component}] = row.value;
  std::size_t compared = 0;
  for (const MeasureRow& row : measure_rows(run / "progress.csv")) {
    const auto same = measured.find({row.time, row.component});
    if (row.measure != "energy" || same == measured.end()) continue;
    CHECK(row.value == same->second);
    ++compared;
  }
  CHECK(compared > 10);
  // the scene's own measure stands in the page, not the same twice
  int energies = 0;
  for (const StoredMeasure& m : open_run(run)->measures()) energies += m.kind == "energy" ? 1 : 0;
  CHECK(energies == 1);
}
