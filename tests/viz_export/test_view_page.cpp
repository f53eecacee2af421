// The page of `epafi view` in a real browser on a made run of two frames: camera of the scene, arrows, springs, lists
// of bodies and materials, the plot of a measure, the ground, light and dark, fingers.
#include <cmath>
#include <random>
#include <sstream>

#include "tests/support/browser.h"
#include "tests/support/catch.h"
#include "viz_export/view/page.h"

using namespace epafi;

namespace {

BodyRecord sphere_at(std::uint32_t id, const Vec3& place, std::uint16_t material) {
  BodyRecord b;
  b.id = id;
  b.mass = 1;
  b.radius = 0.1;
  b.material = material;
  b.pose.position = place;
  b.velocity = Vec3(1, 0, 0);
  return b;
}

/// A floor and three balls, two of them on a spring and one on the floor; a measure of three times.
class TwoFrames final : public ViewSource {
 public:
  TwoFrames() {
    floor_ = surface_of(shapes_, shapes_.add(Box{Vec3(1, 1, 0.05)}), 1);
    about_.gravity = Vec3(0, 0, -9.81);
    about_.materials = {"glass", "steel"};
    about_.groups = {{"floor", 0, 1}, {"ball", 1, 2}, {"bob", 3, 1}};
    about_.springs = {{"line", 2, 3u, Vec3::Zero()}};
    about_.view.from = Vec3(0.5, -3, 2);
    about_.view.to = Vec3(0, 0, 0.3);
    about_.view.field = "height";
    for (const double t : {0.0, 2.0}) {
      ViewFrame frame;
      frame.time = t;
      BodyRecord floor = sphere_at(0, Vec3(0, 0, -0.05), 0);
      floor.mass = 0;
      floor.velocity.setZero();
      floor.surface = &floor_;
      frame.bodies = {floor, sphere_at(1, Vec3(-0.5, 0, 0.1), 0), sphere_at(2, Vec3(0, 0, 0.3 + 0.1 * t), 0),
                      sphere_at(3, Vec3(0.5, 0, 0.6), 1)};
      frame.contacts.push_back({0, 1, {-0.5f, 0, 0}, {-0.5f, 0, 0.1f}, {0, 0, -2}, 2, 1e-3f, 0});
      frames_.push_back(std::move(frame));
    }
  }
  std::string title() const override { return "two frames"; }
  const RunAbout& about() const override { return about_; }
  const std::vector<double>& times() const override { return times_; }
  ViewFrame frame(std::size_t k) const override { return frames_.at(k); }
  const std::vector<BodyRecord>& bodies() const override { return frames_.back().bodies; }
  std::vector<StoredMeasure> measures() const override {
    return {{"heap", "energy", {"kinetic"}, {0.0, 1.0, 2.0}, {1.0, 3.0, 2.0}}};
  }
  bool has_contacts() const override { return true; }
  bool has_residuals() const override { return false; }
  bool is_running() const override { return false; }

 private:
  ShapeStore shapes_;
  Surface floor_;
  RunAbout about_;
  std::vector<double> times_{0.0, 2.0};
  std::vector<ViewFrame> frames_;
};

/// The page, opened.
struct OpenPage {
  TemporaryFolder folder;
  support::Browser b{900, 640};
  explicit OpenPage(bool fingers = false) {
    if (fingers) b.take_touch();
    (void)write_page(TwoFrames(), folder / "page.html");
    REQUIRE(b.open("file://" + (folder / "page.html").string()));
  }
  void set(const std::string& element, const std::string& property, const std::string& value,
           const std::string& event) {
    (void)b.text("(() => { const e = " + element + "; e." + property + " = " + value + "; e.dispatchEvent(new Event('" +
                 event + "', { bubbles: true })); return ''; })()");
  }
  double opacity(int body) { return b.number("epafi.opacity[" + std::to_string(body) + "]"); }
  /// Where a body's centre is seen [pixels].
  std::pair<double, double> place(int body) {
    std::istringstream in(
        b.text("(() => { const p = new THREE.Vector3().fromArray(epafi.frame.place, 3 * " + std::to_string(body) +
               ").project(epafi.camera); const r = document.getElementById('picture').getBoundingClientRect();"
               "return (r.left + (p.x + 1) / 2 * r.width) + ' ' + (r.top + (1 - p.y) / 2 * r.height); })()"));
    std::pair<double, double> out;
    in >> out.first >> out.second;
    return out;
  }
};

bool page_can_be_opened() {
  const bool can = !support::find_browser().empty() && page_parts().three[0] != '\0';
  if (!can) WARN("skipped: no Chromium here, or built without libjs-three");
  return can;
}

}  // namespace

TEST_CASE("the page has the camera and the field of its scene, arrows, springs and contacts",
          "[viz_export][view][long]") {
  if (!page_can_be_opened()) return;
  OpenPage page;
  support::Browser& b = page.b;
  CHECK(b.text("document.getElementById('camera').value") == "scene");
  CHECK(b.text("document.getElementById('field').value") == "height");
  CHECK(b.number("epafi.camera.position.distanceTo(new THREE.Vector3(0.5, -3, 2))") < 1e-6);
  CHECK(b.number("epafi.springs.geometry.maxInstancedCount") == 14);  // a zigzag
  CHECK(b.number("epafi.arrows.geometry.maxInstancedCount") == 0);
  b.press("v");
  CHECK(b.number("epafi.arrows.geometry.maxInstancedCount") == 3);  // of free bodies
  b.press("c");
  CHECK(b.number("epafi.contacts.geometry.maxInstancedCount") == 1);
  CHECK(b.text("document.querySelector('#legend-force span').textContent") == "contact force [N]");
  // the first piece of the spring starts in the lower ball, the last ends in the bob
  CHECK(b.number("epafi.springs.geometry.attributes.from.array[2]") == Approx(0.3).margin(1e-4));
  CHECK(b.number("epafi.springs.geometry.attributes.to.array[3 * 13]") == Approx(0.5).margin(1e-4));
  b.press("4");  // from the left
  CHECK(b.number("epafi.camera.position.x") < -1);
  b.press("h");
  CHECK(b.text("String(document.body.classList.contains('narrow'))") == "true");
  CHECK(b.complaints() == std::vector<std::string>{});
}

TEST_CASE("bodies and materials can be made translucent and hidden", "[viz_export][view][long]") {
  if (!page_can_be_opened()) return;
  OpenPage page;
  support::Browser& b = page.b;
  const std::string list = "document.getElementById('list')";
  CHECK(b.text(list + ".textContent") == "floorballbob");
  page.set(list + ".querySelectorAll('[type=range]')[1]", "value", "0.5", "input");
  CHECK(page.opacity(1) == 0.5);
  CHECK(page.opacity(2) == 0.5);
  CHECK(page.opacity(3) == 1);
  page.set("document.getElementById('list-of')", "value", "'material'", "change");
  CHECK(b.text(list + ".textContent") == "glasssteel");
  page.set(list + ".querySelectorAll('[type=checkbox]')[1]", "checked", "false", "change");
  CHECK(page.opacity(3) == 0);
  page.set(list + ".querySelectorAll('[type=range]')[0]", "value", "0.5", "input");
  CHECK(page.opacity(1) == 0.25);  // both count
  CHECK(b.complaints() == std::vector<std::string>{});
}

TEST_CASE("the ground is solid from above and lets through from below", "[viz_export][view][long]") {
  if (!page_can_be_opened()) return;
  OpenPage page;
  CHECK(page.opacity(0) == 1);
  page.b.press("7");  // from below
  CHECK(page.opacity(0) == Approx(0.22).epsilon(1e-6));
  page.b.press("6");
  CHECK(page.opacity(0) == 1);
}

TEST_CASE("a measure is plotted with quantity and unit, its cursor at the slider's time", "[viz_export][view][long]") {
  if (!page_can_be_opened()) return;
  OpenPage page;
  support::Browser& b = page.b;
  const std::string plot = "document.getElementById('measure-plot')";
  CHECK(b.text("Array.from(" + plot +
               ".querySelectorAll('text')).map(t => t.textContent).includes('energy [J]') + ''") == "true");
  const std::string frame = plot + ".querySelector('.frame').getAttribute('", now = plot + ".querySelector('.now')";
  const double left = b.number(frame + "x')"), width = b.number(frame + "width')");
  CHECK(b.number(now + ".getAttribute('x1')") == Approx(left));
  b.press("ArrowRight");
  REQUIRE(b.wait_for("epafi.at === 1"));
  CHECK(b.number(now + ".getAttribute('x1')") == Approx(left + width));
  CHECK(b.text("document.getElementById('clock').textContent") == "t = 2 s");
  // what has no curve is told below the plot, and the list keeps its width
  const std::string width_of_list = "document.getElementById('measure').getBoundingClientRect().width";
  const double before = b.number(width_of_list);
  CHECK(before > 100);
  b.text("epafi.plots = [{name:'energy',label:'q [m]',lines:[],still:['" + std::string(60, 'a') +
         "','contacts: number of']}], epafi.showMeasure(), ''");
  CHECK_THAT(b.text("document.getElementById('measure-still').textContent"), Catch::Contains("without a curve"));
  CHECK(b.number(width_of_list) == Approx(before));
}

TEST_CASE("every curve of a plot is named, beside the others and within the plot", "[viz_export][view][long]") {
  if (!page_can_be_opened()) return;
  OpenPage page;
  support::Browser& b = page.b;
  std::mt19937 random(11);
  for (int k = 0; k < 12; ++k) {
    std::string lines, names;
    const int count = 1 + static_cast<int>(random() % 9);
    for (int c = 0; c < count; ++c) {
      std::string name = "c" + std::to_string(c);
      for (std::size_t letters = random() % 40; letters > 0; --letters) name += static_cast<char>('a' + random() % 26);
      lines += "{label:'" + name + "',x:[0,1],y:[" + std::to_string(c) + ",2]},";
    }
    b.text("epafi.plots = [{name:'p',label:'q [m]',lines:[" + lines + "]}], epafi.showMeasure(), ''");
    const std::string all = "[...document.querySelectorAll('#measure-plot .curve')]";
    CHECK(b.number(all + ".length") == count);
    CHECK(b.text("String(" + all +
                 ".map(t => t.getBBox()).every((p, k, all) => p.x >= 0 && p.x + p.width <= 264 &&"
                 " all.every((q, j) => j === k || p.x + p.width < q.x || q.x + q.width < p.x ||"
                 " p.y + 9 < q.y || q.y + 9 < p.y)))") == "true");
    CHECK(b.text("String(new Set([...document.querySelectorAll('#measure-plot path')].map(p =>"
                 " p.getAttribute('stroke') + p.getAttribute('stroke-dasharray'))).size)") == std::to_string(count));
  }
}

TEST_CASE("dark and light can be chosen; a finger that taps picks", "[viz_export][view][long]") {
  if (!page_can_be_opened()) return;
  OpenPage page(true);
  support::Browser& b = page.b;
  const std::string corner =
      "(() => { epafi.renderer.render(epafi.scene, epafi.camera); const gl = epafi.renderer.getContext(), p = new "
      "Uint8Array(4); gl.readPixels(1, 1, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, p); return p[0]; })()";
  page.set("document.getElementById('theme')", "value", "'dark'", "change");
  CHECK(b.number(corner) < 60);
  page.set("document.getElementById('theme')", "value", "'light'", "change");
  CHECK(b.number(corner) > 200);
  const auto at = page.place(3);
  b.touch("touchStart", {at});
  b.touch("touchEnd", {});
  REQUIRE(b.wait_for("epafi.picked && epafi.history && epafi.history.x.length === 2"));
  CHECK(b.number("epafi.picked.id") == 3);
  CHECK(b.text("document.querySelector('#picked h2').textContent") == "bob");
  CHECK(b.complaints() == std::vector<std::string>{});
}
