// The page of `epafi view` in a real browser, without a network: it draws what our own rasteriser draws, and slider,
// colours, cut, list and mouse do what they say.
#include <cmath>
#include <cstdlib>
#include <fstream>

#include "tests/support/background.h"
#include "tests/support/browser.h"
#include "tests/support/catch.h"
#include "tests/support/document.h"
#include "tests/support/scene_text.h"
#include "viz_export/report/html_text.h"
#include "viz_export/view/page.h"
#include "viz_export/view/render_run.h"

using namespace epafi;
namespace fs = std::filesystem;

namespace {

const std::string scene_text = R"toml(
title = "Shapes <on> a floor"
[run]
duration = 0.2
output_interval = 0.02
)toml" + experiments::soft_glass() +
                               R"toml(
[material.steel]
density = 7800.0
youngs_modulus = "5 MPa"
poissons_ratio = 0.25
[[body]]
name = "floor"
shape = { box = { size = [1, 1, 0.05] } }
material = "steel"
fixed = true
position = [0, 0, -0.025]
[[body]]
name = "ball"
repeat = 6
shape = { sphere = { radius = 0.06 } }
material = "glass"
position = ["= 0.15*(i - 2.5)", -0.2, "= 0.1 + 0.05*i"]
[[body]]
name = "brick"
shape = { box = { size = [0.3, 0.12, 0.1] } }
material = "steel"
position = [-0.15, 0.15, 0.2]
euler_deg = [20, 10, 30]
[[body]]
name = "pill"
shape = { capsule = { radius = 0.06, length = 0.15 } }
material = "glass"
position = [0.25, 0.2, 0.15]
euler_deg = [60, 20, 0]
velocity = [0, 0, 0.8]
[[measure]]
name = "energy"
kind = "energy"
interval = 0.01
[view]
camera = "iso"
field = "speed"
)toml";

bool has_browser() {
  const bool found = !support::find_browser().empty() && page_parts().three[0] != '\0';
  if (!found) WARN("skipped: no Chromium here, or built without libjs-three");
  return found;
}

int run_program(const std::string& arguments) {
  return std::system((std::string(EPAFI_BINARY_DIR) + "/bin/epafi " + arguments + " > /dev/null 2>&1").c_str());
}

/// A short run of all kinds of objects.
struct ShownRun {
  TemporaryFolder folder;
  fs::path run = folder / "run", page = folder / "page.html";
  ShownRun() {
    std::ofstream(folder / "scene.toml") << scene_text;
    REQUIRE(run_program("run " + (folder / "scene.toml").string() + " -q -t 1 -o " + run.string()) == 0);
  }
};

/// Means of red, green and blue in 32 x 18 fields of the picture, from above; in JavaScript.
constexpr const char* grid_of_picture = R"((() => {
  const gl = epafi.renderer.getContext();
  epafi.renderer.render(epafi.scene, epafi.camera);
  const [w, h] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
  const p = new Uint8Array(4 * w * h);
  gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, p);
  const sum = new Float64Array(32 * 18 * 4);
  for (let y = 0; y < h; ++y) for (let x = 0; x < w; ++x) {
    const field = 4 * (Math.floor((h - 1 - y) * 18 / h) * 32 + Math.floor(x * 32 / w));
    for (let k = 0; k < 3; ++k) sum[field + k] += p[4 * (y * w + x) + k];
    sum[field + 3] += 1;
  }
  const out = [];
  for (let f = 0; f < 32 * 18; ++f) for (let k = 0; k < 3; ++k) out.push((sum[4 * f + k] / sum[4 * f + 3]).toFixed(2));
  return out.join(" ");
})())";

std::vector<double> numbers(const std::string& text) {
  std::istringstream in(text);
  std::vector<double> out;
  for (double v; in >> v;) out.push_back(v);
  return out;
}

std::vector<double> grid_of(Image image) {
  std::vector<double> sum(32 * 18 * 3, 0.0), count(32 * 18, 0.0);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto field = static_cast<std::size_t>(y * 18 / image.height * 32 + x * 32 / image.width);
      for (std::size_t k = 0; k < 3; ++k) sum[3 * field + k] += image.at(x, y)[k];
      count[field] += 1;
    }
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] /= count[k / 3];
  return sum;
}

double mean_difference(const std::vector<double>& a, const std::vector<double>& b) {
  REQUIRE(a.size() == b.size());
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += std::abs(a[k] - b[k]);
  return sum / static_cast<double>(a.size());
}

/// Fields that are not background.
int drawn_fields(const std::vector<double>& grid) {
  int out = 0;
  for (std::size_t k = 0; k < grid.size(); k += 3) out += grid[k] < 240 ? 1 : 0;
  return out;
}

void choose(support::Browser& b, const std::string& id, const std::string& value, const char* event) {
  b.text("(() => { const e = document.getElementById('" + id + "'); e.value = '" + value +
         "'; e.dispatchEvent(new Event('" + event + "', { bubbles: true })); return ''; })()");
}

using Grid = std::vector<double>;

void check_poses(support::Browser& b, const ViewFrame& frame, double size) {
  for (std::size_t k = 0; k < frame.bodies.size(); ++k) {
    const std::string at = std::to_string(k);
    const auto p = numbers(b.text("Array.from(epafi.frame.place.subarray(3*" + at + ",3*" + at + "+3)).join(' ')"));
    const auto q = numbers(b.text("Array.from(epafi.frame.turn.subarray(4*" + at + ",4*" + at + "+4)).join(' ')"));
    REQUIRE(p.size() == 3);
    CHECK((Vec3(p.data()) - frame.bodies[k].pose.position).cwiseAbs().maxCoeff() < 0.51e-5 * size + 1e-7);
    CHECK(Quat(q[3], q[0], q[1], q[2]).angularDistance(frame.bodies[k].pose.orientation) < 0.2 * 3.14159 / 180);
  }
}

void check_colours(support::Browser& b, const Grid& page) {
  choose(b, "field", "height", "change");
  CHECK(b.text("document.getElementById('legend-name').textContent") == "height z [m]");
  CHECK(mean_difference(page, numbers(b.text(grid_of_picture))) > 0.3);
  choose(b, "field", "material", "change");
  CHECK(b.text("document.getElementById('legend-kinds').textContent") == "glasssteel");
}

void check_cuts(support::Browser& b, const Grid& page) {
  choose(b, "clip", "x", "input");
  CHECK(drawn_fields(numbers(b.text(grid_of_picture))) < 0.8 * drawn_fields(page));
  choose(b, "clip", "", "input");
  b.text("document.querySelectorAll('#list input[type=checkbox]').forEach(e => e.click()), ''");
  CHECK(drawn_fields(numbers(b.text(grid_of_picture))) == 0);
}

void check_picking(support::Browser& b) {
  const std::string place =
      "(() => { const p = new THREE.Vector3().fromArray(epafi.frame.place, 3 * 3).project(epafi.camera);"
      "const r = document.getElementById('picture').getBoundingClientRect();"
      "return (r.left + (p.x + 1) / 2 * r.width) + ' ' + (r.top + (1 - p.y) / 2 * r.height); })()";
  const auto at = numbers(b.text(place));
  REQUIRE(at.size() == 2);
  b.click(at[0], at[1]);
  REQUIRE(b.wait_for("epafi.picked && epafi.history && epafi.history.x.length === 11"));
  CHECK(b.number("epafi.picked.id") == 3);
  CHECK(b.text("document.querySelector('#picked h2').textContent") == "ball[2]");
  CHECK(b.number("document.querySelectorAll('#picked-plot path').length") == 1);
}

void check_keys(support::Browser& b, ViewSource& source) {
  b.press("ArrowRight");
  CHECK(b.wait_for("epafi.at === 6"));
  b.press(" ");
  CHECK(b.wait_for("epafi.playing && epafi.at !== 6"));
  b.press(" ");
  choose(b, "time", "10", "input");
  REQUIRE(b.wait_for("epafi.at === 10"));
  b.press("c");
  CHECK(b.number("epafi.contacts.geometry.maxInstancedCount") == static_cast<double>(source.frame(10).contacts.size()));
  b.press("6");
  CHECK(b.number("epafi.camera.position.z") > b.number("epafi.box.max.z"));
}

}  // namespace

TEST_CASE("the mailed page draws what our rasteriser draws, and every control answers", "[scenes][view][long]") {
  if (!has_browser()) return;
  const ShownRun shown;
  REQUIRE(run_program("view " + shown.run.string() + " --out " + shown.page.string()) == 0);
  const std::string html = support::read_text(shown.page);
  for (const char* outside : {"src=\"http", "href=\"http", "@import", "<link rel=\"stylesheet"})
    CHECK(html.find(outside) == html.npos);
  support::Browser b(1100, 700);
  REQUIRE(b.open("file://" + shown.page.string()));
  CHECK(b.text("document.title") == "Shapes <on> a floor");
  CHECK(b.number("document.querySelectorAll('canvas').length") == 1);
  CHECK(b.number("document.getElementById('time').max") == 10);

  // two programs, one camera: antialiasing, lines along edges and 8 bits differ
  choose(b, "time", "5", "input");
  REQUIRE(b.wait_for("epafi.at === 5"));
  const auto source = open_run(shown.run);
  RenderOptions options;
  options.width = static_cast<int>(b.number("epafi.renderer.domElement.width"));
  options.height = static_cast<int>(b.number("epafi.renderer.domElement.height"));
  options.labels = false;
  const Overview overview = look_over(*source);
  RunPainter painter(*source, overview, options);
  const std::vector<double> page = numbers(b.text(grid_of_picture)), own = grid_of(painter.paint(5));
  CHECK(drawn_fields(page) > 30);
  CHECK(mean_difference(page, own) < 1.5);
  const std::vector<double> other = grid_of(painter.paint(0));
  CHECK(mean_difference(page, other) > 2 * mean_difference(page, own));  // another frame is another picture

  SECTION("positions are exact to 1e-5 of the box, orientations to 0.2 degrees") {
    check_poses(b, source->frame(5), look_over(*source).box.diagonal());
  }
  SECTION("colour, range and legend") { check_colours(b, page); }
  SECTION("a cut takes away, and hiding too") { check_cuts(b, page); }
  SECTION("a click picks the body under it, and shows its values over time") { check_picking(b); }
  SECTION("keys: play, next frame, contacts, cameras") { check_keys(b, *source); }
  CHECK(b.complaints() == std::vector<std::string>{});
}

TEST_CASE("mouse and fingers turn about what is up; light and dark follow the system", "[scenes][view]") {
  if (!has_browser()) return;
  const TemporaryFolder folder;
  support::Browser b(500, 400);
  b.take_touch();
  for (const Vec3& gravity : {Vec3(0, 0, -9.81), Vec3(0, 0, 9.81), Vec3(0, -9.81, 0)}) {
    RunAbout about;
    about.gravity = gravity;
    ViewFrame frame;
    for (std::uint32_t k = 0; k < 3; ++k) {
      BodyRecord ball;
      ball.id = k;
      ball.mass = 1;
      ball.radius = 0.5;
      ball.pose.position = Vec3(k, 0.5 * k, 0.2 * k);
      frame.bodies.push_back(ball);
    }
    write_page(*still_source("three", about, std::move(frame)), folder / "three.html");
    b.prefer("dark");
    REQUIRE(b.open("file://" + (folder / "three.html").string()));
    CHECK(b.text("String(document.documentElement.classList.contains('dark'))") == "true");
    b.prefer("light");
    CHECK(b.wait_for("!document.documentElement.classList.contains('dark')"));
    // sideways: the eye keeps its height above the target, and goes round
    const std::string up = "new THREE.Vector3(...epafi.manifest.up)",
                      height = "epafi.camera.position.clone().sub(epafi.controls.target).dot(" + up + ")",
                      way = "epafi.camera.position.distanceTo(epafi.controls.target)";
    const double before = b.number(height), far = b.number(way), x = b.number("epafi.camera.position.x");
    CHECK(before > 0);
    b.drag(150, 150, 250, 150);
    CHECK(b.number(height) == Approx(before));
    CHECK(b.number(way) == Approx(far));
    CHECK(std::abs(b.number("epafi.camera.position.x") - x) > 0.2 * far);
    b.drag(150, 150, 150, 250);  // down: the eye rises
    CHECK(b.number(height) > before + 0.1 * far);
    const double risen = b.number(height);
    b.touch("touchStart", {{150, 150}});
    b.touch("touchMove", {{150, 120}});
    b.touch("touchEnd", {});
    CHECK(b.number(height) < risen);
    b.touch("touchStart", {{140, 150}, {160, 150}});
    b.touch("touchMove", {{100, 150}, {200, 150}});
    b.touch("touchEnd", {});
    CHECK(b.number(way) < 0.5 * far);
    for (const char* key : {"6", "7"}) {  // from above and from below
      b.press(key);
      CHECK(std::abs(b.number(height)) == Approx(b.number(way)).epsilon(1e-3));
    }
    CHECK(b.complaints() == std::vector<std::string>{});
  }
}

namespace {

/// Balls of three materials and sizes, a box and a pale wall.
ViewFrame still_life(const Surface& brick, const Surface& wall) {
  ViewFrame frame;
  frame.has_orientation = true;
  for (std::uint32_t k = 0; k < 14; ++k) {
    BodyRecord b;
    b.id = k;
    b.mass = k < 13 ? 1 : 0;
    b.material = static_cast<std::uint16_t>(k % 3);
    b.radius = k < 12 ? 0.05 + 0.02 * (k % 4) : k == 12 ? 0.35 : 0.8;
    b.surface = k < 12 ? nullptr : k == 12 ? &brick : &wall;
    b.pose.position = k < 12 ? Vec3(0.3 * (k % 4) - 0.45, 0.3 * (k / 4) - 0.3, 0.1 + 0.03 * k) : Vec3(0, 0, 0.7);
    b.velocity = Vec3(0.1 * k, 0, 0);
    if (k == 12) b.pose.orientation = Quat(0.9, 0.2, 0.3, 0.1).normalized();
    if (k == 13) b.pose.position = Vec3(0, 0, -0.05);
    frame.bodies.push_back(b);
  }
  return frame;
}

/// Widths of the stored picture and of the drawn one, their mean difference, and the share of pixels that differ much.
std::vector<double> difference_to(support::Browser& b, const std::string& image) {
  return numbers(b.text(R"((async () => {
    const picture = new Image();
    picture.src = "data:image/png;base64,)" +
                        image + R"(";
    await picture.decode();
    epafi.renderer.render(epafi.scene, epafi.camera);
    const drawn = epafi.renderer.domElement;
    const pixels = [picture, drawn].map((from) => {
      const to = document.createElement("canvas");
      [to.width, to.height] = [drawn.width, drawn.height];
      const pen = to.getContext("2d");
      pen.drawImage(from, 0, 0);
      return pen.getImageData(0, 0, to.width, to.height).data;
    });
    let [sum, far] = [0, 0];
    for (let k = 0; k < pixels[0].length; k += 4) {
      const by = [0, 1, 2].map((part) => Math.abs(pixels[0][k + part] - pixels[1][k + part]));
      sum += by[0] + by[1] + by[2];
      far += Math.max(...by) > 24 ? 1 : 0;
    }
    const n = pixels[0].length / 4;
    return [picture.width, drawn.width, sum / (3 * n), far / n].join(" ");
  })())"));
}

}  // namespace

TEST_CASE("the page draws the stored picture", "[scenes][view][long]") {
  if (!has_browser()) return;
  // made by hand, so that no law of contact is in it; after a wanted change of how things look: EPAFI_NEW_PICTURES=1
  // build/tests/test_scenes "the page draws the stored picture"
  ShapeStore shapes;
  const Surface brick = surface_of(shapes, shapes.add(Box{Vec3(0.3, 0.15, 0.1)}), 1),
                wall = surface_of(shapes, shapes.add(Box{Vec3(0.8, 0.8, 0.02)}), 1);
  RunAbout about;
  about.gravity = Vec3(0, 0, -9.81);
  about.materials = {"glass", "steel", "wood"};
  const TemporaryFolder folder;
  write_page(*still_source("stored", about, still_life(brick, wall)), folder / "page.html");
  const fs::path stored = fs::path(EPAFI_SOURCE_DIR) / "tests/data/view/page.png";
  support::Browser b(640, 400);
  REQUIRE(b.open("file://" + (folder / "page.html").string()));
  if (std::getenv("EPAFI_NEW_PICTURES") != nullptr) {
    const std::string url =
        b.text("epafi.renderer.render(epafi.scene, epafi.camera), epafi.renderer.domElement.toDataURL()");
    std::ofstream(folder / "new") << url.substr(url.find(',') + 1);
    REQUIRE(std::system(("base64 -d " + (folder / "new").string() + " > " + stored.string()).c_str()) == 0);
  }
  const std::string image = base64(support::read_text(stored));
  const auto difference = [&] { return difference_to(b, image); };
  // other versions of the browser round elsewhere: outlines move by parts of a pixel
  const std::vector<double> same = difference();
  REQUIRE(same.size() == 4);
  CHECK(same[0] == same[1]);
  CHECK(same[2] < 0.5);
  CHECK(same[3] < 0.01);
  // what a mistake would change is far beyond: a shift of one percent, another colour
  b.text("epafi.camera.position.multiplyScalar(1.05), ''");
  CHECK(difference()[3] > 0.02);
  b.press("f");
  choose(b, "field", "material", "change");
  CHECK(difference()[2] > 2);
}

TEST_CASE("the local server gives a run to the browser of this machine alone", "[scenes][view][long]") {
  if (!has_browser()) return;
  const ShownRun shown;
  const support::Background server(shown.folder.path(), "view",
                                   "view " + shown.run.string() + " --port 0 --no-browser");
  support::Browser b(800, 600);
  const std::string address = server.word();
  CHECK(b.open(address));
  CHECK(b.number("epafi.source.frames") == 11);
  CHECK(drawn_fields(numbers(b.text(grid_of_picture))) > 30);
  CHECK(b.text("fetch('/etc/passwd').then(a => String(a.status))") == "404");
  CHECK(b.complaints().size() == 1);  // of that answer
  fs::rename(shown.run, shown.folder / "moved");
  (void)b.open(address);  // says what the server says
  CHECK(b.wait_for("document.getElementById('message').textContent.includes('there is no folder')"));
  CHECK(b.text("String(document.getElementById('message').textContent.includes('JSON'))") == "false");
}

TEST_CASE("a page whose server has ended says so, and its slider stays with the picture", "[scenes][view][long]") {
  if (!has_browser()) return;
  const ShownRun shown;
  const support::Background server(shown.folder.path(), "view",
                                   "view " + shown.run.string() + " --port 0 --no-browser");
  support::Browser b(800, 600);
  REQUIRE(b.open(server.word()));
  b.press("ArrowRight");
  REQUIRE(b.wait_for("epafi.at === 1"));
  server.stop();
  ::usleep(500000);
  b.text("epafi.source.kept.clear(), ''");  // as in a long run, whose frames lie in many chunks
  for (const char* key : {"End", "ArrowRight", " "}) {
    b.press(key);
    CHECK(b.wait_for("document.getElementById('notes').textContent.includes('the server does not answer')"));
    ::usleep(300000);
    CHECK(b.number("Number(document.getElementById('time').value)") == 1);
    CHECK(b.number("epafi.at") == 1);
    CHECK(b.wait_for("!epafi.playing"));  // who plays stops at the next frame
  }
}

TEST_CASE("the page follows a run that goes on, and sees its end", "[scenes][view][long]") {
  if (!has_browser()) return;
  const TemporaryFolder folder;
  std::ofstream(folder / "scene.toml") << scene_text;
  const std::string run = (folder / "run").string();
  const support::Background program(
      folder.path(), "run",
      "run " + (folder / "scene.toml").string() + " -q -t 1 -o " + run +
          " --set run.duration=1e5 --set run.output_interval=0.02 --set run.time_step=2e-6");
  for (int k = 0; k < 200 && !fs::exists(folder / "run" / "run.h5"); ++k) ::usleep(50000);
  const support::Background server(folder.path(), "view", "view " + run + " --port 0 --no-browser");
  support::Browser b(800, 600);
  REQUIRE(b.open(server.word()));
  CHECK(b.text("String(epafi.manifest.running)") == "true");
  const double first = b.number("epafi.source.frames");
  REQUIRE(b.wait_for("epafi.source.frames > " + std::to_string(first) + " + 2"));
  CHECK(b.wait_for("Number(document.getElementById('time').max) === epafi.source.frames - 1"));
  CHECK(b.number("epafi.at") == 0);  // who looks at an early frame goes on looking at it
  const std::string last_drawn = "document.querySelector('#measure-plot path').getAttribute('d').match(/[ML]/g).length";
  const double drawn = b.number(last_drawn);
  CHECK(b.wait_for(last_drawn + " > " + std::to_string(drawn)));  // its curves go on all the same
  CHECK(b.wait_for("document.getElementById('notes').textContent.includes('End goes to the last one and follows')"));
  CHECK(b.number("epafi.at") == 0);
  b.press("End");
  REQUIRE(b.wait_for("epafi.at > 2"));
  const double last = b.number("epafi.at");
  CHECK(b.wait_for("epafi.at > " + std::to_string(last)));  // at the end it follows
  CHECK(drawn_fields(numbers(b.text(grid_of_picture))) > 30);
  program.stop();
  CHECK(b.wait_for("!epafi.manifest.running"));
  CHECK(b.wait_for("epafi.at === epafi.source.frames - 1"));
  CHECK(b.complaints() == std::vector<std::string>{});
}

TEST_CASE("two hundred thousand spheres are drawn", "[scenes][view][long]") {
  if (!has_browser()) return;
  ViewFrame frame;
  for (std::uint32_t k = 0; k < 200'000; ++k) {
    BodyRecord b;
    b.id = k;
    b.mass = 1;
    b.radius = 0.4;
    b.pose.position = Vec3(k % 100, k / 100 % 100, k / 10'000);
    b.velocity = Vec3(0, 0, 0.01 * (k % 100));
    frame.bodies.push_back(b);
  }
  const auto source = still_source("many", {}, std::move(frame));
  const TemporaryFolder folder;
  const WrittenPage page = write_page(*source, folder / "many.html");
  CHECK(page.bytes < 8'000'000);
  support::Browser b(1000, 700);
  REQUIRE(b.open("file://" + (folder / "many.html").string()));
  CHECK(drawn_fields(numbers(b.text(grid_of_picture))) > 100);
  CHECK(b.number("performance.memory.usedJSHeapSize") < 300e6);
  CHECK(b.complaints() == std::vector<std::string>{});
}
