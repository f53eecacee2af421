// The page in a real browser: what a press means, digits that the data have, legends where nothing is, long names.
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>

#include "detection/shapes/all_shapes.h"
#include "tests/support/browser.h"
#include "tests/support/catch.h"
#include "viz_export/view/page.h"
#include "viz_export/vtk/surface.h"

using namespace epafi;
using Catch::Contains;

namespace {

bool has_page() {
  const bool can = !support::find_browser().empty() && page_parts().three[0] != '\0';
  if (!can) WARN("skipped: no Chromium here, or built without libjs-three");
  return can;
}

BodyRecord ball_of(std::uint32_t id, const Vec3& place, double radius = 0.1) {
  BodyRecord b;
  b.id = id;
  b.mass = 1;
  b.radius = radius;
  b.pose.position = place;
  return b;
}

/// Balls one behind the other for the front camera, each of a name of its own.
std::unique_ptr<ViewSource> row_of_balls(std::uint32_t n) {
  RunAbout about;
  about.view.preset = "front";
  ViewFrame frame;
  for (std::uint32_t k = 0; k < n; ++k) {
    about.groups.push_back({"ball" + std::to_string(k), k, 1});
    frame.bodies.push_back(ball_of(k, Vec3(0, 0.5 * k, 0)));
  }
  return still_source("row", about, std::move(frame));
}

void open_page(support::Browser& b, const TemporaryFolder& folder, const ViewSource& source) {
  (void)write_page(source, folder / "page.html");
  REQUIRE(b.open("file://" + (folder / "page.html").string()));
}

void choose_value(support::Browser& b, const std::string& id, const std::string& value) {
  b.text("(() => { const e = document.getElementById('" + id + "'); e.value = '" + value +
         "'; e.dispatchEvent(new Event('change', { bubbles: true })); return ''; })()");
}

/// The same frame twice, with or without contacts among what the run can tell.
class WallsOnly final : public ViewSource {
 public:
  WallsOnly() {
    frame_.bodies.push_back(ball_of(0, Vec3::Zero()));
    frame_.bodies.back().mass = 0;
  }
  std::string title() const override { return "walls"; }
  const RunAbout& about() const override { return about_; }
  const std::vector<double>& times() const override { return times_; }
  const std::vector<BodyRecord>& bodies() const override { return frame_.bodies; }
  std::vector<StoredMeasure> measures() const override { return {}; }
  bool has_contacts() const override { return true; }
  bool has_residuals() const override { return false; }
  bool is_running() const override { return false; }
  std::string cut_text() const override { return "the run was cut off after t = 1 s: its process 7 is gone"; }
  ViewFrame frame(std::size_t k) const override {
    ViewFrame out = frame_;
    out.time = times_[k];
    return out;
  }

 private:
  RunAbout about_;
  ViewFrame frame_;
  std::vector<double> times_{0.0, 1.0};
};

}  // namespace

TEST_CASE("a press picks what is drawn, however clear, and the next one what lies behind", "[viz_export][view][long]") {
  if (!has_page()) return;
  const TemporaryFolder folder;
  constexpr std::uint32_t n = 5;
  support::Browser b(700, 500);
  open_page(b, folder, *row_of_balls(n));
  std::istringstream middle(
      b.text("(() => { const r = document.getElementById('picture').getBoundingClientRect();"
             "return (r.left + r.width / 2) + ' ' + (r.top + r.height / 2); })()"));
  double x = 0, y = 0;
  middle >> x >> y;
  std::mt19937 random(17);
  for (int round = 0; round < 12; ++round) {
    const std::vector<double> kinds{0, 0.1, 0.3, 0.45, 0.7, 1};
    std::vector<std::uint32_t> expected;
    bool hidden = false;
    for (std::uint32_t k = 0; k < n; ++k) {
      const double opacity = kinds[random() % kinds.size()];
      b.text("epafi.opacities.body[" + std::to_string(k) + "].opacity = " + std::to_string(opacity) + ", ''");
      if (opacity > 0 && !hidden) expected.push_back(k);
      hidden = hidden || opacity == 1;
    }
    b.text("epafi.showOpacity(), epafi.picked = null, epafi.pressed = null, ''");
    if (expected.empty()) {
      b.click(x, y);
      CHECK(b.text("String(epafi.picked)") == "null");
      continue;
    }
    for (std::size_t press = 0; press < expected.size() + 1; ++press) {
      b.click(x, y);
      CHECK(b.number("epafi.picked.id") == expected[press % expected.size()]);
    }
  }
  CHECK(b.complaints() == std::vector<std::string>{});
}

namespace {

/// Pixels that the first body changes at all, and by more than a trace of colour.
std::array<double, 2> changed_pixels(support::Browser& b, double opacity) {
  std::istringstream said(b.text(
      "(() => { const drawn = (o) => { epafi.opacities.body[0].opacity = o; epafi.showOpacity();"
      "epafi.renderer.render(epafi.scene, epafi.camera); const gl = epafi.renderer.getContext();"
      "const p = new Uint8Array(4 * gl.drawingBufferWidth * gl.drawingBufferHeight);"
      "gl.readPixels(0, 0, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.RGBA, gl.UNSIGNED_BYTE, p); return p; "
      "};"
      "const a = drawn(" +
      std::to_string(opacity) +
      "), b = drawn(0); let some = 0, much = 0; for (let k = 0; k < a.length; k += 4) {"
      "const d = Math.max(...[0, 1, 2].map((c) => Math.abs(a[k + c] - b[k + c]))); some += d > 0; much += d > 17; }"
      "return some + ' ' + much; })()"));
  std::array<double, 2> out{};
  said >> out[0] >> out[1];
  return out;
}

}  // namespace

TEST_CASE("the page shows a half-space from within, and a press goes through it first", "[viz_export][view][long]") {
  if (!has_page()) return;
  std::mt19937 random(18);
  std::uniform_real_distribution<double> any(-0.3, 0.3);
  for (int draw = 0; draw < 3; ++draw) {
    const TemporaryFolder folder;
    const Vec3 normal = Vec3(any(random), 1, any(random)).normalized();  // away from the front camera
    ShapeStore shapes;
    const Surface square = surface_of(shapes, shapes.add(HalfSpace{normal}), 0.8);
    RunAbout about;
    about.view.preset = "front";
    about.groups = {{"jaw", 0, 1}, {"ball", 1, 1}};
    BodyRecord plane = ball_of(0, -0.2 * normal, std::numeric_limits<double>::infinity());
    plane.mass = 0;
    plane.surface = &square;
    ViewFrame frame;
    frame.bodies = {plane, ball_of(1, Vec3::Zero())};
    support::Browser b(700, 500);
    open_page(b, folder, *still_source("jaw", about, std::move(frame)));
    for (const double opacity : {0.22, 1.0}) {
      const auto [some, much] = changed_pixels(b, opacity);
      CHECK(some > 20000);
      CHECK(much > 500);  // its lines
      CHECK(much < 0.25 * some);
    }
    b.text("epafi.opacities.body[0].opacity = 1, epafi.showOpacity(), ''");
    std::istringstream middle(
        b.text("(() => { const r = document.getElementById('picture').getBoundingClientRect();"
               "return (r.left + r.width / 2) + ' ' + (r.top + r.height / 2); })()"));
    double x = 0, y = 0;
    middle >> x >> y;
    b.click(x, y);
    CHECK(b.number("epafi.picked.id") == 1);
    b.click(x, y);
    CHECK(b.number("epafi.picked.id") == 0);
    b.press("3");  // from its own side it is a wall that hides
    const auto [some, much] = changed_pixels(b, 1.0);
    CHECK(much > 0.8 * some);
    CHECK(b.complaints() == std::vector<std::string>{});
  }
}

TEST_CASE("a ball that is cut through is picked by its cut, and what is cut away is not", "[viz_export][view][long]") {
  if (!has_page()) return;
  const TemporaryFolder folder;
  support::Browser b(700, 500);
  open_page(b, folder, *row_of_balls(4));
  // the cut takes what lies before y = 0.55 as the front camera sees it: ball 0 is gone, ball 1 is cut behind its
  // middle
  b.text("epafi.cut = () => ({ normal: new THREE.Vector3(0, -1, 0), at: -0.55 }), ''");
  const auto picked = [&](double shift) {
    return b.number(
        "(() => { const r = document.getElementById('picture').getBoundingClientRect(); epafi.pressed = null;"
        "const p = new THREE.Vector3(" +
        std::to_string(shift) +
        ", 0.55, 0).project(epafi.camera);"
        "const picked = epafi.pickAt(r.left + (p.x + 1) / 2 * r.width, r.top + (1 - p.y) / 2 * r.height);"
        "return picked ? picked.id : -1; })()");
  };
  CHECK(picked(0.0) == 1);
  CHECK(picked(0.07) == 1);  // the cut's rim is at sqrt(0.1^2 - 0.05^2) = 0.087
  CHECK(picked(0.11) == -1);
}

TEST_CASE("digits of positions are those that the data have", "[viz_export][view][long]") {
  if (!has_page()) return;
  const TemporaryFolder folder;
  support::Browser b(900, 600);
  std::mt19937 random(2);
  for (int round = 0; round < 4; ++round) {
    const double size = std::pow(10.0, static_cast<double>(random() % 7) - 4);
    std::uniform_real_distribution<double> any(-size, size);
    ViewFrame frame;
    for (std::uint32_t k = 0; k < 6; ++k) {
      frame.bodies.push_back(ball_of(k, Vec3(any(random), any(random), any(random)), 0.05 * size));
      frame.bodies.back().velocity = Vec3(k == 0 ? 10.0 : 1e-3 * any(random) / size, 0, 0);
    }
    const auto exact = frame.bodies;
    open_page(b, folder, *still_source("six", {}, std::move(frame)));
    const double step = b.number("epafi.frame.step"), speed_step = b.number("epafi.frame.steps.speed");
    CHECK(speed_step == Approx(10.0 / 65535));
    for (std::uint32_t k = 0; k < 6; ++k) {
      b.text("epafi.picked = { id: " + std::to_string(k) + " }, epafi.showPick(), ''");
      std::istringstream shown(b.text("document.querySelector('#picked').innerText.match(/position\\s+(.*) m/)[1]"));
      std::string part;
      for (int axis = 0; std::getline(shown, part, ','); ++axis) {
        const double value = std::stod(part), unit = std::pow(10.0, std::ceil(std::log10(step) - 1e-9));
        INFO(part << " of " << exact[k].pose.position[axis] << " in steps of " << step);
        CHECK(std::abs(value / unit - std::round(value / unit)) < 1e-3);  // no digit below the step
        CHECK(std::abs(value - exact[k].pose.position[axis]) <= 0.5 * (step + unit) * (1 + 1e-3) + 2e-7 * size);
      }
      const double speed =
          std::stod(b.text("document.querySelector('#picked').innerText.match(/\\nspeed\\s+(\\S+)/)[1]"));
      CHECK(std::abs(speed - exact[k].velocity.norm()) <= 1e-3);
      CHECK(std::abs(speed * 1000 - std::round(speed * 1000)) < 1e-6);  // steps of 1.5e-4 tell thousandths
    }
  }
}

TEST_CASE("there is no legend of what is not there, and a reversed range is reported", "[viz_export][view][long]") {
  if (!has_page()) return;
  const TemporaryFolder folder;
  support::Browser b(900, 600);
  open_page(b, folder, WallsOnly());
  CHECK(b.text("document.getElementById('legend-name').textContent") == "speed: no free bodies");
  CHECK(b.number("document.getElementById('legend-ticks').getBoundingClientRect().height") == 0);
  b.text("document.getElementById('contacts').click(), document.getElementById('arrows').click(), ''");
  CHECK(b.text("document.querySelector('#legend-force span').textContent") == "no contacts");
  CHECK(b.number("document.querySelector('#legend-force .bar').getBoundingClientRect().height") == 0);
  CHECK(b.text("document.getElementById('notes').textContent") ==
        "the run was cut off after t = 1 s: its process 7 is gone");
  CHECK(b.complaints() == std::vector<std::string>{});

  open_page(b, folder, *row_of_balls(5));
  const auto ticks = [&] {
    return b.text("Array.from(document.querySelectorAll('#legend-ticks span')).map(e => e.textContent).join('|')");
  };
  choose_value(b, "field", "size");
  CHECK(ticks() == "all 0.1");  // one size: one tick
  choose_value(b, "field", "id");
  CHECK(ticks() == "0|2|4");
  choose_value(b, "low", "3");
  CHECK(b.text("epafi.range.join()") == "3,4");
  CHECK(ticks() == "<= 3|4");  // no half bodies; three numbers lie below
  choose_value(b, "high", "1");
  CHECK(b.text("epafi.range.join()") == "3,4");
  CHECK_THAT(b.text("document.getElementById('range-note').textContent"), Contains("must be less than"));
  CHECK(b.text("String(document.getElementById('range-note').hidden)") == "false");
  choose_value(b, "high", "");
  CHECK(b.text("epafi.range.join()") == "3,4");
  CHECK(b.text("String(document.getElementById('range-note').hidden)") == "true");
  CHECK(b.complaints() == std::vector<std::string>{});
}

TEST_CASE("long names stay in their places, and a phone has room for the slider", "[viz_export][view][long]") {
  if (!has_page()) return;
  const TemporaryFolder folder;
  RunAbout about;
  ViewFrame frame;
  for (std::uint32_t k = 0; k < 4; ++k) {
    about.materials.push_back(std::string(150, static_cast<char>('a' + k)));
    about.groups.push_back({std::string(200, static_cast<char>('k' + k)), k, 1});
    frame.bodies.push_back(ball_of(k, Vec3(0.3 * k, 0, 0)));
    frame.bodies.back().material = static_cast<std::uint16_t>(k);
  }
  support::Browser b(1100, 700);
  open_page(b, folder, *still_source(std::string(400, 'T'), about, std::move(frame)));
  choose_value(b, "field", "body");
  b.text("epafi.picked = { id: 1 }, epafi.showPick(), ''");
  for (const auto& [width, height] : {std::pair{1100, 700}, {768, 1024}, {480, 800}, {360, 640}, {320, 560}}) {
    b.resize(width, height);
    b.text("document.body.classList.remove('narrow'), epafi.resize(), ''");
    INFO(width << " x " << height);
    CHECK(b.number("document.documentElement.scrollWidth") <= width);
    const std::string outside = b.text(
        "Array.from(document.querySelectorAll('footer *, #panel, #panel section > *, #list *, #picked *, #head *'))"
        ".filter(e => { const r = e.getBoundingClientRect(); return r.width > 0 && (r.right > innerWidth + 1 || r.left "
        "< -1); })"
        ".map(e => e.tagName + '#' + e.id).join(' ')");
    CHECK(outside.empty());
    CHECK(b.number("document.getElementById('time').getBoundingClientRect().width") >= 100);
    CHECK(b.number("document.getElementById('title').getBoundingClientRect().height") < 60);
    CHECK(b.number("document.getElementById('panel').scrollWidth - document.getElementById('panel').clientWidth") <= 0);
  }
}

TEST_CASE("a page far from the origin has the picture of the same bodies near it", "[viz_export][view][long]") {
  if (!has_page()) return;
  const TemporaryFolder folder;
  support::Browser b(500, 400);
  ShapeStore shapes;
  const ShapeRef ground = shapes.add(HalfSpace{Vec3::UnitZ()});
  const auto picture = [&](const Vec3& centre) {
    const Surface square = surface_of(shapes, ground, 3.0, centre);
    ViewFrame frame;
    for (std::uint32_t k = 0; k < 5; ++k) frame.bodies.push_back(ball_of(k, centre + Vec3(0.3 * k, 0.1 * k, 0.1), 0.1));
    frame.bodies.push_back(ball_of(5, Vec3(0, 0, centre.z()), 1.0));
    frame.bodies.back().mass = 0;
    frame.bodies.back().radius = std::numeric_limits<double>::infinity();
    frame.bodies.back().surface = &square;
    RunAbout about;
    about.gravity = Vec3(0, 0, -9.81);
    open_page(b, folder, *still_source("far", about, std::move(frame)));
    std::istringstream said(b.text(R"((() => {
      epafi.renderer.render(epafi.scene, epafi.camera);
      const gl = epafi.renderer.getContext(), [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
      const pixels = new Uint8Array(4 * w * h);
      gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
      const sums = new Array(64).fill(0);
      for (let k = 0; k < w * h; ++k) {
        const row = Math.floor(8 * Math.floor(k / w) / h), column = Math.floor(8 * (k % w) / w);
        sums[8 * row + column] += pixels[4 * k] / (w * h / 64);
      }
      return sums.join(" ");
    })())"));
    std::vector<double> out;
    for (double v = 0; said >> v;) out.push_back(v);
    CHECK(b.complaints() == std::vector<std::string>{});
    return out;
  };
  const std::vector<double> near = picture(Vec3::Zero());
  REQUIRE(near.size() == 64);
  CHECK(*std::min_element(near.begin(), near.end()) + 20 < *std::max_element(near.begin(), near.end()));
  for (const double far : {1e3, 1e5, 1e6}) {
    const std::vector<double> there = picture(Vec3(far, -0.7 * far, 0));
    REQUIRE(there.size() == 64);
    double worst = 0;
    for (std::size_t k = 0; k < 64; ++k) worst = std::max(worst, std::abs(there[k] - near[k]));
    INFO(far);
    CHECK(worst < 1.0);
    b.click(250, 200);  // what is picked tells where it is
    CHECK(b.wait_for("epafi.picked"));
    const double x = b.number("epafi.source.origin[0] + epafi.frame.place[0]");
    CHECK(std::abs(x - far) < 1e-3);
  }
}

TEST_CASE("the legend names what repeats, rests and is seen by no camera, on a plate", "[viz_export][view][long]") {
  if (!has_page()) return;
  const TemporaryFolder folder;
  support::Browser b(900, 600);
  const auto text_of = [&](const char* id) {
    return b.text("document.getElementById('" + std::string(id) + "').textContent");
  };
  for (const std::uint32_t kinds : {5u, 12u, 13u, 60u}) {
    RunAbout about;
    about.gravity = Vec3(0, 0, -9.81);
    ViewFrame frame;
    for (std::uint32_t k = 0; k < kinds; ++k) {
      about.materials.push_back("m" + std::to_string(k));
      frame.bodies.push_back(ball_of(k, Vec3(0.3 * k, 0, 0)));
      frame.bodies.back().material = static_cast<std::uint16_t>(k);
      frame.bodies.back().velocity = Vec3(1e-16 * (1 + k), 0, 0);
    }
    open_page(b, folder, *still_source("kinds", about, std::move(frame)));
    CHECK_THAT(text_of("legend-ticks"), Contains("at rest: 98 % below"));
    CHECK(b.number("new Set(Array.from(epafi.shares(epafi.frame))).size") == 1);
    choose_value(b, "high", "1e-15");  // who asks for a range gets it
    CHECK(b.number("new Set(Array.from(epafi.shares(epafi.frame))).size") > 1);
    choose_value(b, "field", "material");
    const bool repeats = text_of("legend-kinds").find("12 colours, which repeat") != std::string::npos;
    CHECK(repeats == (kinds > 12));
    const double marks =
        b.number("new Set(Array.from(document.querySelectorAll('#legend-kinds i')).map(e => e.style.background)).size");
    CHECK(marks == (kinds > 12 ? 11 : kinds));
  }
  for (const char* scheme : {"light", "dark"}) {
    b.prefer(scheme);
    for (const char* part : {"getComputedStyle(document.getElementById('head')).backgroundColor",
                             "getComputedStyle(document.querySelector('#axes circle')).fill"}) {
      const double opacity = b.number("Number(" + std::string(part) + ".split(',')[3].slice(0, -1))");
      CHECK(opacity > 0.6);
      CHECK(opacity < 0.95);
    }
  }
  RunAbout away;
  away.view.from = Vec3(0, -5, 0);
  away.view.to = Vec3(0, -6, 0);
  ViewFrame one;
  one.bodies = {ball_of(0, Vec3::Zero())};
  open_page(b, folder, *still_source("away", away, std::move(one)));
  CHECK_THAT(text_of("notes"), Contains("the camera sees no body"));
  b.press("2");
  CHECK(text_of("notes").empty());
  CHECK(b.complaints() == std::vector<std::string>{});
}

TEST_CASE("a value that is no number is shown as such, and drawn as nothing moving", "[viz_export][view][long]") {
  if (!has_page()) return;
  const TemporaryFolder folder;
  support::Browser b(900, 600);
  std::mt19937 random(4);
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    const auto n = static_cast<std::uint32_t>(3 + random() % 4), broken = static_cast<std::uint32_t>(random() % n);
    ViewFrame frame;
    for (std::uint32_t k = 0; k < n; ++k) {
      frame.bodies.push_back(ball_of(k, Vec3(0, 0.5 * k, 0)));
      frame.bodies.back().velocity = Vec3(k == broken ? bad : 1.0 + k, 0, 0);
    }
    open_page(b, folder, *still_source("broken", {}, std::move(frame)));
    for (std::uint32_t k = 0; k < n; ++k) {
      b.text("epafi.picked = { id: " + std::to_string(k) + " }, epafi.showPick(), ''");
      const std::string shown = b.text("document.querySelector('#picked').innerText.match(/\\nspeed\\s+(.*)/)[1]");
      INFO(k << ": " << shown);
      if (k == broken)
        CHECK(shown == "not a number");
      else
        CHECK(std::stod(shown) == Approx(1.0 + k).epsilon(1e-3));
    }
  }
}
