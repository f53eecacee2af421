// A run folder that an older version left (tests/data/view/old_run) opens in view, render and report.
#include <algorithm>
#include <cmath>
#include <fstream>

#include "tests/support/browser.h"
#include "tests/support/catch.h"
#include "viz_export/files/json_reader.h"
#include "viz_export/files/side_file.h"
#include "viz_export/report/report.h"
#include "viz_export/view/page.h"
#include "viz_export/view/render_run.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

/// A copy, as `report` writes into the folder.
struct OldRun {
  TemporaryFolder folder;
  fs::path run = folder / "run";
  OldRun() { fs::copy(fs::path(EPAFI_SOURCE_DIR) / "tests/data/view/old_run", run, fs::copy_options::recursive); }
};

std::vector<double> sorted_distances(const std::vector<Vec3>& points) {
  std::vector<double> out;
  for (std::size_t k = 0; k < points.size(); ++k)
    for (std::size_t m = 0; m < k; ++m) out.push_back((points[k] - points[m]).norm());
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

TEST_CASE("an older run shows its bodies where its scene put them", "[viz_export][view]") {
  const OldRun old;
  const auto source = open_run(old.run);
  CHECK(source->title() == "Three shapes on a floor");
  REQUIRE(source->times().size() == 5);
  CHECK_FALSE(source->is_running());
  const ViewFrame first = source->frame(0);
  REQUIRE(first.bodies.size() == 4);
  CHECK(first.bodies[0].is_wall());
  CHECK(first.bodies[1].pose.position.isApprox(Vec3(-0.2, -0.2, 0.1)));
  CHECK(first.bodies[1].radius == Approx(0.06));
  // The wedge lies as the scene wrote it, though the file has its principal axes: its corners about their mean, which
  // is the centre of mass of a tetrahedron.
  const std::vector<Vec3> written{{0, 0, 0}, {0.2, 0, 0}, {0, 0.1, 0}, {0, 0, 0.15}};
  const BodyRecord& wedge = first.bodies[3];
  REQUIRE(wedge.surface != nullptr);
  std::vector<Vec3> shown;
  for (const Vec3& p : wedge.surface->points) shown.push_back(wedge.pose.to_world(p) - wedge.pose.position);
  REQUIRE(shown.size() == 4);
  for (const Vec3& corner : written) {
    const Vec3 expected = corner - Vec3(0.05, 0.025, 0.0375);
    const auto at_it = [&](const Vec3& p) { return (p - expected).norm() < 1e-12; };
    CHECK(std::count_if(shown.begin(), shown.end(), at_it) == 1);
  }
  const std::vector<double> distances = sorted_distances(shown), expected = sorted_distances(written);
  for (std::size_t k = 0; k < distances.size(); ++k) CHECK(distances[k] == Approx(expected[k]));
}

TEST_CASE("an older run has its contacts, energies and colours", "[viz_export][view]") {
  const OldRun old;
  const auto source = open_run(old.run);
  CHECK(source->has_contacts());
  CHECK_FALSE(source->has_residuals());
  const ViewFrame last = source->frame(4);
  double energy = 0;
  for (const BodyRecord& b : last.bodies) energy += b.kinetic_energy;
  CHECK(energy == Approx(read_json(old.run / "summary.json").number("energy.kinetic").value()));
  REQUIRE_FALSE(last.contacts.empty());
  for (const StoredContact& c : last.contacts) {
    CHECK(c.normal_force > 0);
    CHECK(std::max(c.a, c.b) < 4);
  }
  for (const ViewField& field : view_fields(*source)) {
    RenderOptions options;
    options.field = field.name;
    options.width = 64;
    options.height = 48;
    const Overview overview = look_over(*source);
    RunPainter painter(*source, overview, options);
    Image image = painter.paint(4);
    int drawn = 0;
    for (int x = 0; x < 64; ++x)
      for (int y = 0; y < 48; ++y) drawn += image.at(x, y)[0] < 235 ? 1 : 0;
    CHECK(drawn > 300);
  }
}

TEST_CASE("a report of an older run has all its parts", "[viz_export][report]") {
  const OldRun old;
  const std::string page = read_whole_file(write_report(old.run, ""));
  for (const char* part :
       {"Pictures", "Energy balance", "Measures", "Overlap and checks", "Where the time went", "Settings"})
    CHECK(page.find(std::string("<h2>") + part + "</h2>") != page.npos);
}

TEST_CASE("the page of an older run works in a browser", "[viz_export][view][long]") {
  if (support::find_browser().empty() || page_parts().three[0] == '\0') {
    WARN("skipped: no Chromium here, or built without libjs-three");
    return;
  }
  const OldRun old;
  (void)write_page(*open_run(old.run), old.folder / "old.html", 30'000'000);
  support::Browser b(700, 500);
  REQUIRE(b.open("file://" + (old.folder / "old.html").string()));
  CHECK(b.number("document.getElementById('time').max") == 4);
  b.press("End");
  CHECK(b.wait_for("epafi.at === 4"));
  b.press("c");
  CHECK(b.number("epafi.contacts.geometry.maxInstancedCount") ==
        static_cast<double>(open_run(old.run)->frame(4).contacts.size()));
  CHECK(b.text("document.getElementById('list').textContent") == "bodieswalls");
  CHECK(b.complaints() == std::vector<std::string>{});
}
