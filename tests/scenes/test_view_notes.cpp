// What pictures, pages and reports say of a run that is not whole: contacts that are gone, an early end, cases of a
// sweep without one.
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <random>
#include <set>

#include "tests/support/catch.h"
#include "tests/support/document.h"
#include "tests/support/scene_text.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/view/fields.h"
#include "viz_export/view/page.h"

using namespace epafi;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

std::string resting_balls(double duration, double step) {
  return "title = \"Balls on a floor\"\n[run]\nduration = " + std::to_string(duration) +
         "\ntime_step = " + std::to_string(step) + "\noutput_interval = " + std::to_string(duration / 10) +
         "\ncheckpoint_interval = " + std::to_string(duration / 10) + "\n" + experiments::soft_glass() +
         experiments::half_space_floor("glass") + R"toml(
[[body]]
name = "ball"
repeat = 3
shape = { sphere = { radius = 0.05 } }
material = "glass"
position = ["= 0.2*i", 0, 0.049999]
[view]
field = "force"
)toml";
}

/// Code and what was said on the error stream.
struct Said {
  int code;
  std::string text;
};

Said told_by(const TemporaryFolder& folder, const std::string& arguments, const std::string& before = "") {
  const fs::path file = folder / "said";
  const std::string command = before + EPAFI_BINARY_DIR "/bin/epafi " + arguments + " > /dev/null 2> " + file.string();
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, support::read_text(file)};
}

std::multiset<std::string> drawings_of(const std::string& page) {
  const std::string mark = "data:image/svg+xml;base64,";
  std::multiset<std::string> out;
  for (std::size_t at = page.find(mark); at != page.npos; at = page.find(mark, at + 1))
    out.insert(page.substr(at, page.find('\'', at) - at));
  return out;
}

}  // namespace

TEST_CASE("a run whose files of contacts are gone has no fields of contacts, and says so", "[scenes][view]") {
  const TemporaryFolder folder;
  const fs::path run = folder / "run";
  std::ofstream(folder / "scene.toml") << resting_balls(0.01, 1e-5);
  REQUIRE(told_by(folder, "run " + (folder / "scene.toml").string() + " -q -t 1 -o " + run.string()).code == 0);
  const std::string render = "render " + run.string() + " --size 96x64 --out " + (folder / "a.png").string();
  const Said whole = told_by(folder, render);
  CHECK(whole.code == 0);
  CHECK_THAT(whole.text, !Contains("note") && !Contains("warning"));
  CHECK_THAT(told_by(folder, render + " --camera scene").text, Contains("the scene has no [view] camera"));

  std::vector<fs::path> files;
  for (const auto& file : fs::directory_iterator(run / "frames"))
    if (file.path().filename().string().starts_with("contacts_")) files.push_back(file.path());
  REQUIRE(files.size() > 4);
  std::mt19937 random(51);
  fs::remove(files[random() % files.size()]);
  CHECK_THAT(told_by(folder, render).text, Contains("1 of its") && Contains("files of contacts is missing"));
  CHECK(open_run(run)->has_contacts());

  fs::remove_all(run / "frames");
  const auto source = open_run(run);
  CHECK_FALSE(source->has_contacts());
  for (const ViewField& field : view_fields(*source))
    for (const char* of_contacts : {"force", "pressure", "stress", "contacts"}) CHECK(field.name != of_contacts);
  const Said bare = told_by(folder, render);
  CHECK(bare.code == 0);
  CHECK_THAT(bare.text, Contains("contacts are not stored in this folder"));
  CHECK_THAT(bare.text, Contains("there is no field 'force' here, which [view] field names: colours show speed"));
  const Said refused = told_by(folder, render + " --field stress");
  CHECK(refused.code != 0);
  CHECK_THAT(refused.text, Contains("no field 'stress'"));
  REQUIRE(told_by(folder, "report " + run.string()).code == 0);
  const std::string report = support::read_text(run / "report.html");
  CHECK_THAT(report, Contains("contacts are not stored in this folder") && Contains("colours show speed"));
}

TEST_CASE("an interrupted run says in picture, page and report how far it came", "[scenes][view][long]") {
  const TemporaryFolder folder;
  const fs::path run = folder / "run";
  std::ofstream(folder / "scene.toml") << resting_balls(1000, 1e-5);
  std::mt19937 random(53);
  std::uniform_real_distribution<> wait(0, 0.05);
  for (const char* signal : {"INT", "TERM"}) {
    fs::remove_all(run);
    // once for the program and once for its group, as `timeout` and terminals do
    const std::string kill = "kill -s " + std::string(signal) + " $! 2> /dev/null; ";
    const std::string until_begun = "while [ ! -f " + (run / "run.h5").string() + " ]; do sleep 0.01; done; ";
    const std::string start = EPAFI_BINARY_DIR "/bin/epafi run " + (folder / "scene.toml").string() + " -q -t 1 -o " +
                              run.string() + " 2> /dev/null & " + until_begun;
    const auto pause = [&] { return "sleep " + std::to_string(wait(random)) + "; "; };
    CHECK(std::system((start + pause() + kill + pause() + kill + "wait $!").c_str()) != 0);
    const auto source = open_run(run);
    const std::string said = source->stop_text();
    INFO(said);
    CHECK(said.rfind("interrupted at ", 0) == 0);
    CHECK_THAT(said, Contains(" of 1000 s"));
    CHECK(std::stod(said.substr(15)) == Approx(source->last_time()).epsilon(1e-3));
    if (page_parts().three[0] != '\0') {
      REQUIRE(told_by(folder, "view " + run.string() + " --out " + (folder / "a.html").string()).code == 0);
      CHECK_THAT(support::read_text(folder / "a.html"), Contains("the run has ended early: " + said));
    }
    REQUIRE(told_by(folder, "report " + run.string()).code == 0);
    CHECK_THAT(support::read_text(run / "report.html"), Contains("The run has ended early: " + said));
    const double until = source->last_time() + 1e-3;
    REQUIRE(told_by(folder, "resume " + run.string() + " -q --until " + std::to_string(until)).code == 0);
    CHECK(open_run(run)->stop_text().empty());
  }
}

TEST_CASE("a case of a sweep that was interrupted is neither plotted nor counted as ended", "[scenes][report][long]") {
  const TemporaryFolder folder;
  const fs::path sweep = folder / "sweep";
  const std::string scene = std::string(EPAFI_SOURCE_DIR) + "/scenes/library/tutorials/05_sweep.toml";
  REQUIRE(
      told_by(folder, "sweep " + scene + " -q --set params.n=20 --set run.duration=0.1 -o " + sweep.string()).code ==
      0);
  std::mt19937 random(52);
  std::vector<fs::path> cases;
  for (const auto& entry : fs::directory_iterator(sweep))
    if (entry.is_directory()) cases.push_back(entry.path());
  REQUIRE(cases.size() > 3);
  const fs::path chosen = cases[random() % cases.size()];
  std::string summary = support::read_text(chosen / "summary.json");
  const std::size_t at = summary.find("\"completed\"");
  REQUIRE(at != summary.npos);
  std::ofstream(chosen / "summary.json") << summary.replace(at, 11, "\"interrupted\"");
  REQUIRE(told_by(folder, "report " + sweep.string()).code == 0);
  const std::string page = support::read_text(sweep / "report.html");
  CHECK_THAT(page, Contains(std::to_string(cases.size()) + " cases, 1 of them without an end yet"));
  const bool plotted = std::system("command -v gnuplot > /dev/null") == 0;
  if (plotted) CHECK_THAT(page, Contains("Without the cases that have no end: " + chosen.filename().string()));
  fs::remove_all(chosen);  // the plots are those of the others alone
  REQUIRE(told_by(folder, "report " + sweep.string()).code == 0);
  const auto drawn = drawings_of(page);
  CHECK(drawn.empty() != plotted);
  CHECK(drawn == drawings_of(support::read_text(sweep / "report.html")));
}
