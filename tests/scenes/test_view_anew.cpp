// A page that is open while its run is made anew in the same folder; a run that is resumed is the same run; a browser
// that cannot draw.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <random>

#include "tests/support/background.h"
#include "tests/support/browser.h"
#include "tests/support/catch.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/view/page.h"
#include "viz_export/view/server.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

const std::string falling_balls = R"toml(
title = "Balls that fall"
params = { n = 4, mu = 0.3, slide = 1.0 }
run = { duration = 0.3, output_interval = 0.05, checkpoint_interval = 0.1 }
world = { gravity = [0, 0, -9.81] }
material.glass = { density = 2500.0, youngs_modulus = "5 MPa", poissons_ratio = 0.25 }
contact = { method = "smooth", restitution = 0.3, friction = "= mu", smooth = { law = "hertz-mindlin" } }
[[body]]
name = "floor"
shape = { half_space = { normal = [0, 0, 1] } }
material = "glass"
fixed = true
[[body]]
name = "ball"
repeat = "= n"
shape = { sphere = { radius = 0.05 } }
material = "glass"
position = ["= 0.2*i", 0, 0.06]
velocity = ["= slide", 0, 0]
)toml";

void make_run(const fs::path& folder, const std::string& options) {
  std::ofstream(folder / "scene.toml") << falling_balls;
  const std::string command = std::string(EPAFI_BINARY_DIR) + "/bin/epafi run " + (folder / "scene.toml").string() +
                              " -q -t 1 -o " + (folder / "run").string() + " " + options + " > /dev/null 2>&1";
  REQUIRE(std::system(command.c_str()) == 0);
}

FlatJson manifest_of(RunServer& server) { return flat_json(server.answer("/manifest").body); }

bool draws_here() {
  const bool can = !support::find_browser().empty() && page_parts().three[0] != '\0';
  if (!can) WARN("skipped: no Chromium here, or built without libjs-three");
  return can;
}

}  // namespace

TEST_CASE("an open page loads anew when the run in its folder is made anew, and says so", "[scenes][view][long]") {
  if (!draws_here()) return;
  const TemporaryFolder folder;
  make_run(folder.path(), "");
  const support::Background server(folder.path(), "view",
                                   "view " + (folder / "run").string() + " --port 0 --no-browser");
  support::Browser b(800, 600);
  REQUIRE(b.open(server.word()));
  CHECK(b.number("epafi.source.frames") == 7);
  CHECK(b.number("epafi.source.bodies.n") == 5);
  const std::string notes = "document.getElementById('notes').textContent";
  CHECK(b.text(notes).find("anew") == std::string::npos);
  std::mt19937 random(11);
  // other bodies; the same first frame but other laws; other bodies again
  const std::string options[] = {"--set params.n=" + std::to_string(5 + random() % 5),
                                 "--set params.mu=0." + std::to_string(5 + random() % 4),
                                 "--set params.n=" + std::to_string(2 + random() % 2)};
  for (const std::string& option : options) {
    INFO(option);
    b.press("End");
    REQUIRE(b.wait_for("epafi.at === epafi.source.frames - 1"));
    b.text("window.before = 1, ''");  // gone when the page is loaded anew
    fs::remove_all(folder / "run");
    make_run(folder.path(), option);
    REQUIRE(b.wait_for("window.before === undefined && document.body.dataset.ready === 'true'"));
    CHECK(b.wait_for(notes + ".includes('the run was made anew')"));
    const auto source = open_run(folder / "run");
    CHECK(b.number("epafi.source.bodies.n") == static_cast<double>(source->bodies().size()));
    b.press("End");
    REQUIRE(b.wait_for("epafi.at === 6"));
    const ViewFrame last = source->frame(6);
    for (std::size_t k = 1; k < last.bodies.size(); ++k) {
      const std::string x = "epafi.frame.place[3 * " + std::to_string(k) + "]";
      CHECK(std::abs(b.number(x) - last.bodies[k].pose.position.x()) < 1e-4);
    }
  }
  for (const std::string& complaint : b.complaints())  // while there was no run the server said so
    CHECK(complaint.find("Failed to load resource") != std::string::npos);
}

TEST_CASE("a run that goes on or is resumed stays the run that a page shows", "[scenes][view]") {
  const TemporaryFolder folder;
  make_run(folder.path(), "--until 0.12");
  RunServer server(folder / "run");
  const std::string first = manifest_of(server).text("identity"), mark = server.answer("/mark").body;
  CHECK_FALSE(first.empty());
  CHECK(server.answer("/mark").body == mark);  // nothing happens
  const std::string resume =
      std::string(EPAFI_BINARY_DIR) + "/bin/epafi resume " + (folder / "run").string() + " -q > /dev/null 2>&1";
  REQUIRE(std::system(resume.c_str()) == 0);
  CHECK(server.answer("/mark").body != mark);
  const FlatJson resumed = manifest_of(server);
  CHECK(resumed.text("identity") == first);
  CHECK(resumed.number("times.6").has_value());
  // the same again from the start is the same run, with as many frames; another one is not
  fs::remove_all(folder / "run");
  make_run(folder.path(), "--until 0.12");
  CHECK(manifest_of(server).text("identity") == first);
  CHECK_FALSE(manifest_of(server).number("times.6").has_value());
  fs::remove_all(folder / "run");
  make_run(folder.path(), "--set params.slide=2");
  CHECK(manifest_of(server).text("identity") != first);
  // what cannot change is not asked for
  RunServer still(still_source("still", {}, open_run(folder / "run")->frame(0)));
  CHECK(manifest_of(still).text("identity").empty());
}

TEST_CASE("a browser that cannot draw shows why, and nothing else", "[scenes][view][long]") {
  if (!draws_here()) return;
  const TemporaryFolder folder;
  make_run(folder.path(), "--until 0.05");
  write_page(*open_run(folder / "run"), folder / "page.html");
  support::Browser b(900, 500);
  b.before_pages("HTMLCanvasElement.prototype.getContext = () => null");
  b.go("file://" + (folder / "page.html").string());
  REQUIRE(b.wait_for("document.body && document.body.classList.contains('failed')"));
  CHECK(b.text("document.getElementById('message').textContent").find("no WebGL 2") != std::string::npos);
  const std::string seen = b.text(
      "Array.from(document.body.querySelectorAll('*')).filter(e => e.getBoundingClientRect().height > 0)"
      ".map(e => e.id).join()");
  CHECK(seen == "message");
}
