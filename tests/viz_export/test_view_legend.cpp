// Where colours end and what a colour bar says of it; what a picture says where bodies are dots.
#include <algorithm>
#include <cmath>
#include <random>

#include "engine/units/error.h"
#include "tests/support/browser.h"
#include "tests/support/catch.h"
#include "tests/viz_export/made_run.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/view/image.h"
#include "viz_export/view/overview.h"
#include "viz_export/view/page.h"

using namespace epafi;
using Catch::Contains;

namespace {

/// Balls in a row on a floor, each pressed onto it by one of these forces.
ViewFrame pressed_row(const std::vector<float>& forces) {
  ViewFrame frame;
  const auto floor = static_cast<std::uint32_t>(forces.size());
  for (std::uint32_t k = 0; k < floor; ++k) {
    const Vec3 place(3 * ball_radius * k, 0, ball_radius);
    frame.bodies.push_back(ball_at(k, place));
    const Eigen::Vector3f from = place.cast<float>(),
                          to = from - Eigen::Vector3f(0, 0, static_cast<float>(ball_radius));
    frame.contacts.push_back({k, floor, from, to, {0, 0, forces[k]}, forces[k], 0, 0});
  }
  frame.bodies.push_back(ball_at(floor, Vec3(0, 0, -ball_radius)));
  frame.bodies.back().mass = 0;
  return frame;
}

std::vector<float> random_forces(std::mt19937& random, std::size_t n) {
  std::vector<float> out;
  std::uniform_real_distribution<float> power(-2, 3);
  for (std::size_t k = 0; k < n; ++k) out.push_back(std::pow(10.0f, power(random)));
  return out;
}

bool can_open_pages() {
  const bool can = !support::find_browser().empty() && page_parts().three[0] != '\0';
  if (!can) WARN("skipped: no Chromium here, or built without libjs-three");
  return can;
}

void open_source(support::Browser& b, const TemporaryFolder& folder, const ViewSource& source) {
  (void)write_page(source, folder / "page.html");
  REQUIRE(b.open("file://" + (folder / "page.html").string()));
}

/// Balls of this radius, two of them far apart [m].
MadeRun two_far_balls(double radius, double apart) {
  ViewFrame frame =
      frame_of({ball_at(0, Vec3::Zero()), ball_at(1, Vec3(0, 0, apart)), ball_at(2, Vec3(3 * radius, 0, 0))});
  for (BodyRecord& b : frame.bodies) b.radius = radius;
  return {{frame}, {}};
}

}  // namespace

TEST_CASE("colours of few values end at the largest, of many where few lie above", "[viz_export][view]") {
  std::mt19937 random(41);
  for (const std::size_t n : {1u, 2u, 3u, 10u, 49u, 50u, 51u, 100u, 257u}) {
    std::vector<float> forces = random_forces(random, n);
    const MadeRun run({pressed_row(forces)}, about_with({0, 0, -9.81}));
    const Overview overview = look_over(run);
    std::sort(forces.begin(), forces.end());
    INFO(n << " balls");
    const double top = overview.range.at("force")[1];
    const auto above = [&](double end) {
      return std::count_if(forces.begin(), forces.end(), [&](float f) { return f > end; });
    };
    CHECK(overview.strongest_of_all == forces.back());
    CHECK(overview.extremes.at("force")[1] == forces.back());
    if (n < 50) {
      CHECK(top == forces.back());
      CHECK(overview.strongest == forces.back());
    }
    CHECK(static_cast<double>(above(top)) <= 0.02 * static_cast<double>(n - 1));
    CHECK(static_cast<double>(above(overview.strongest)) <= 0.01 * static_cast<double>(n - 1));
    // the bar's top is marked where, and only where, a value lies above it
    const std::string last = range_ticks({overview.range.at("force"), overview.extremes.at("force")}).back();
    CHECK((last.rfind(">= ", 0) == 0) == (short_number(top) != short_number(forces.back())));
  }
  // 82.18 N and 10.27 N: the bar is of both
  CHECK(look_over(MadeRun({pressed_row({82.18f, 10.27f})}, {})).range.at("force")[1] == Approx(82.18));
}

TEST_CASE("an end of a colour bar beyond which values lie says so", "[viz_export][view]") {
  CHECK(range_ticks({{0, 4}, {0, 9}}) == std::vector<std::string>{"0", "2", ">= 4"});
  CHECK(range_ticks({{0, 4}, {-1, 4}}) == std::vector<std::string>{"<= 0", "2", "4"});
  CHECK(range_ticks({{0, 4}, {1, 3}}) == std::vector<std::string>{"0", "2", "4"});
  CHECK(range_ticks({{0, 4}, {0, 4.00001}}) == std::vector<std::string>{"0", "2", "4"});  // the same four digits
  CHECK(range_ticks({{0, 0}, {0, 7}}) == std::vector<std::string>{"most 0"});
}

TEST_CASE("numbers under a colour bar never run together and stay within it", "[viz_export][view]") {
  std::mt19937 random(42);
  std::uniform_real_distribution<double> digits(-9.999, 9.999), power(-12, 12);
  for (int round = 0; round < 3000; ++round) {
    const double size = 9 + 0.01 * static_cast<double>(random() % 2000), width = 13 * size / 0.9;
    double low = random() % 2 == 0 ? 0.0 : digits(random) * std::pow(10, std::floor(power(random)));
    double high = digits(random) * std::pow(10, std::floor(power(random)));
    if (low > high) std::swap(low, high);
    const double beyond = random() % 2 == 0 ? 0.0 : high - low;
    const auto ticks = placed_ticks({{low, high}, {low - beyond, high + beyond}}, width, size);
    INFO(low << " to " << high << " in letters of " << size);
    REQUIRE(ticks.size() >= 2);
    CHECK(ticks.front().left >= -1e-9);
    CHECK(ticks.back().left + text_width(ticks.back().text, size) <= width + 1e-9);
    for (std::size_t k = 0; k + 1 < ticks.size(); ++k)
      CHECK(ticks[k].left + text_width(ticks[k].text, size) + 0.3 * size < ticks[k + 1].left);
  }
  // where there is room all three stand
  CHECK(placed_ticks({{0, 10}, {0, 10}}, 260, 18).size() == 3);
}

TEST_CASE("bodies so far apart that they are dots are reported as such", "[viz_export][view]") {
  std::mt19937 random(43);
  std::uniform_real_distribution<double> power(-6, 3);
  for (int round = 0; round < 12; ++round) {
    const double radius = std::pow(10.0, power(random));
    const RenderOptions options = plain_options(false);
    for (const double apart : {5.0, 50.0, 1e4, 1e5}) {
      const MadeRun run = two_far_balls(radius, apart * radius);
      const Overview overview = look_over(run);
      INFO("radius " << radius << ", apart " << apart);
      RunPainter painter(run, overview, options);
      const std::string said = painter.dots_text(run.frame(0));
      CHECK(said == (apart < 1e3 ? "" : "3 of 3 bodies are smaller than a pixel here"));
    }
  }
  // a dust that fills the picture is seen, though each grain is a dot
  std::vector<BodyRecord> dust;
  for (std::uint32_t k = 0; k < 40000; ++k) {
    dust.push_back(ball_at(k, Vec3(0.001 * (k % 200), 0, 0.001 * (k / 200))));
    dust.back().radius = 1e-4;
  }
  const MadeRun run({frame_of(std::move(dust))}, {});
  const Overview overview = look_over(run);
  const RenderOptions options = plain_options(false);
  CHECK(RunPainter(run, overview, options).dots_text(run.frame(0)).empty());
}

TEST_CASE("the page's legend marks its ends, and names bodies that are dots", "[viz_export][view][long]") {
  if (!can_open_pages()) return;
  const TemporaryFolder folder;
  std::mt19937 random(44);
  support::Browser b(900, 600);
  const auto ticks = [&](const std::string& box) {
    return b.text("Array.from(document.querySelectorAll('" + box + " span')).map(e => e.textContent).join('|')");
  };
  const auto choose = [&](const std::string& id, const std::string& value) {
    b.text("(() => { const e = document.getElementById('" + id + "'); e.value = '" + value +
           "'; e.dispatchEvent(new Event('change', { bubbles: true })); return ''; })()");
  };
  for (const std::size_t n : {2u, 300u}) {
    std::vector<float> forces = random_forces(random, n);
    forces.back() = 5000;
    open_source(b, folder, MadeRun({pressed_row(forces)}, about_with({0, 0, -9.81})));
    choose("field", "force");
    b.press("c");
    INFO(n);
    const bool marked = n > 50;
    for (const char* box : {"#legend-ticks", "#legend-force .ticks"}) {
      CHECK((ticks(box).find("|>= ") != std::string::npos) == marked);
      if (!marked) CHECK_THAT(ticks(box), Contains("|5000"));
    }
    choose("high", "7000");
    CHECK_THAT(ticks("#legend-ticks"), Contains("|7000"));
    choose("high", "1");
    CHECK_THAT(ticks("#legend-ticks"), Contains("|>= 1"));
  }
  open_source(b, folder, two_far_balls(1e-3, 100));
  CHECK_THAT(b.text("document.getElementById('notes').textContent"),
             Contains("3 of 3 bodies are smaller than a pixel here"));
  open_source(b, folder, two_far_balls(1e-3, 0.01));
  CHECK_THAT(b.text("document.getElementById('notes').textContent"), !Contains("smaller than a pixel"));
  CHECK(b.complaints() == std::vector<std::string>{});
}

TEST_CASE("a field or camera of [view] that is not there is reported", "[viz_export][view]") {
  RunAbout about;
  about.view.field = "force";
  const auto bare = still_source("", about, frame_of({ball_at(0, Vec3::Zero())}));
  REQUIRE(view_notes(*bare, "", "").size() == 1);
  CHECK_THAT(view_notes(*bare, "", "").front(), Contains("'force'") && Contains("colours show speed"));
  CHECK(view_notes(*bare, "", "speed").empty());  // another one was asked for
  CHECK(view_notes(*bare, "iso", "speed").empty());
  REQUIRE(view_notes(*bare, "scene", "speed").size() == 1);
  CHECK_THAT(view_notes(*bare, "scene", "speed").front(), Contains("no [view] camera") && Contains("iso"));
  about.view.preset = "top";
  about.view.field = "height";
  CHECK(view_notes(*still_source("", about, frame_of({ball_at(0, Vec3::Zero())})), "scene", "").empty());
}
