// How a run is looked at: what is up, where colours end, what contacts do to bodies, a run that grows.
#include <cmath>
#include <numbers>
#include <random>

#include "tests/support/catch.h"
#include "tests/viz_export/made_run.h"
#include "viz_export/view/overview.h"
#include "viz_export/view/render_run.h"

using namespace epafi;

namespace {

/// Mean row of the pixels that are more red than green or blue, or more blue than red.
double mean_row(Image& image, bool red) {
  double sum = 0, count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = image.at(x, y);
      if (red ? p[0] < p[2] + 60 : p[2] < p[0] + 60) continue;
      sum += y;
      count += 1;
    }
  REQUIRE(count > 20);
  return sum / count;
}

}  // namespace

TEST_CASE("pictures show against gravity as up, whatever axis it points along", "[viz_export][view]") {
  const std::vector<Vec3> gravities{{0, 0, -9.81}, {0, 0, 9.81}, {0, -9.81, 0}, {0, 9.81, 0},
                                    {9.81, 0, 0},  {-1.6, 0, 0}, {3, 0, -9},    {1, 2, -3}};
  for (const Vec3& gravity : gravities) {
    const Vec3 up = -gravity.normalized();
    CHECK((upright(up) * Vec3::UnitZ() - up).norm() < 1e-12);
    RunAbout about = about_with(gravity);
    about.groups = {{"low", 0, 1}, {"high", 1, 1}};  // of the kinds' colours the first is blue, the second orange
    const auto source =
        still_source("", about, frame_of({ball_at(0, Vec3(1, 2, 3)), ball_at(1, Vec3(1, 2, 3) + 0.3 * up)}));
    for (const char* camera : {"iso", "front", "back", "left", "right"}) {
      RenderOptions options;
      options.camera = camera;
      options.field = "body";
      options.width = 160;
      options.height = 120;
      options.labels = false;
      const Overview overview = look_over(*source);
      RunPainter painter(*source, overview, options);
      Image image = painter.paint(0);
      INFO(camera << ", gravity " << gravity.transpose());
      CHECK(mean_row(image, true) + 20 < mean_row(image, false));
    }
    const Camera top = choose_camera("top", about, look_over(*source).box, 1.5);
    CHECK((top.eye - top.target).normalized().dot(up) == Approx(1));
  }
  CHECK(upwards(RunAbout{}) == Vec3(0, 0, 1));  // no gravity
}

TEST_CASE("a camera that looks straight down has an upright picture", "[viz_export][view]") {
  RunAbout about = about_with({0, 0, -9.81});
  about.view.from = Vec3(0, 0, 5);
  about.view.to = Vec3(0, 0, 0);
  const Camera camera = choose_camera("", about, {}, 1.0);
  CHECK(std::abs(camera.up.dot((camera.eye - camera.target).normalized())) < 1e-12);
}

TEST_CASE("height counts against gravity", "[viz_export][view]") {
  const ViewFrame frame = frame_of({ball_at(0, Vec3(1, 2, 3))});
  CHECK(FrameFields(frame, about_with({0, 9.81, 0}))("height") == std::vector<float>{-2});
  const auto source = still_source("", about_with({0, 9.81, 0}), frame);
  const auto fields = view_fields(*source);
  const auto height = std::find_if(fields.begin(), fields.end(), [](const ViewField& f) { return f.name == "height"; });
  REQUIRE(height != fields.end());
  CHECK(height->label == "height -y");
}

TEST_CASE("bodies at rest have the colour of rest, not that of rounding", "[viz_export][view]") {
  // 1e-15 m/s is what sums of forces leave over; a fall through the picture gives sqrt(2 g L) = 2 m/s
  std::vector<BodyRecord> resting, moving;
  for (std::uint32_t k = 0; k < 20; ++k) {
    const Vec3 place(0.1 * (k % 5), 0, 0.1 * (k / 5));
    resting.push_back(ball_at(k, place, Vec3(1e-15 * (k % 7), 0, 0)));
    moving.push_back(ball_at(k, place, Vec3(1e-3 * k, 0, 0)));
  }
  const auto still = still_source("", about_with({0, 0, -9.81}), frame_of(resting));
  const double top = look_over(*still).range.at("speed")[1];
  CHECK(top > 1e-7);
  CHECK(top < 1e-5);
  CHECK(is_resting(look_over(*still), {}, "speed"));
  ViewSettings asked;
  asked.range = {0, 1e-15};
  CHECK_FALSE(is_resting(look_over(*still), asked, "speed"));
  // slow motion keeps its own range, and so does a frame without gravity; of a run the whole way counts
  const auto slow = still_source("", about_with({0, 0, -9.81}), frame_of(moving));
  CHECK(look_over(*slow).range.at("speed")[1] == Approx(0.019));  // of few all
  CHECK_FALSE(is_resting(look_over(*slow), {}, "speed"));
  const auto floating = still_source("", {}, frame_of(resting));
  CHECK(look_over(*floating).range.at("speed")[1] < 1e-14);
  const Overview in_space = look_over(MadeRun({frame_of(resting), frame_of(resting)}, {}));
  CHECK(is_resting(in_space, {}, "speed"));
  CHECK_FALSE(is_resting(look_over(MadeRun({frame_of(moving), frame_of(moving)}, {})), {}, "speed"));
  // one colour for all, as where nothing moves at all
  std::vector<BodyRecord> unmoved = resting;
  for (BodyRecord& b : unmoved) b.velocity.setZero();
  const MadeRun at_rest({frame_of(resting)}, about_with({0, 0, -9.81})),
      unmoving({frame_of(unmoved)}, about_with({0, 0, -9.81}));
  const Overview one = look_over(at_rest), other = look_over(unmoving);
  CHECK(other.range.at("speed") == std::array<double, 2>{0, 0});
  Image first = RunPainter(at_rest, one, plain_options(false)).paint(0),
        second = RunPainter(unmoving, other, plain_options(false)).paint(0);
  CHECK(unlike_pixels(first, second) == 0);
}

TEST_CASE("twelve kinds have colours of their own, and further ones repeat them", "[viz_export][view]") {
  const auto apart = [](const Rgb& a, const Rgb& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); };
  for (std::size_t a = 0; a < kinds_apart; ++a) {
    CHECK(kind_colour(a) == kind_colour(a + kinds_apart));
    for (std::size_t b = 0; b < a; ++b) CHECK(apart(kind_colour(a), kind_colour(b)) > 0.2);
  }
}

TEST_CASE("a camera that sees no body says where it stands", "[viz_export][view]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int k = 0; k < 20; ++k) {
    RunAbout about = about_with({0, 0, -9.81});
    const Vec3 eye(5 + any(random), any(random), any(random)), bodies(any(random), any(random), any(random));
    about.view.from = eye;
    about.view.to = k % 2 == 0 ? bodies : Vec3(eye + (eye - bodies));  // at them, or away from them
    const MadeRun run({frame_of({ball_at(0, bodies), ball_at(1, bodies + Vec3(0.1, 0, 0))})}, about);
    const Overview overview = look_over(run);
    const auto blind = [&](const std::string& camera) {
      RenderOptions options = plain_options(false);
      options.camera = camera;
      return RunPainter(run, overview, options).blind_text(run.frame(0));
    };
    CHECK(blind("scene").empty() == (k % 2 == 0));
    CHECK(blind("iso").empty());
    if (k % 2 == 1) CHECK_THAT(blind("scene"), Catch::Contains("sees none of the 2 free bodies"));
  }
  std::vector<BodyRecord> walls{ball_at(0, Vec3::Zero())};
  walls[0].mass = 0;
  RunAbout away = about_with({0, 0, -9.81});
  away.view.from = Vec3(5, 0, 0);
  away.view.to = Vec3(6, 0, 0);
  const MadeRun empty({frame_of(walls)}, away);
  const Overview overview = look_over(empty);
  RenderOptions options = plain_options(false);
  options.camera = "scene";
  CHECK(RunPainter(empty, overview, options).blind_text(empty.frame(0)).empty());  // nothing to see
}

TEST_CASE("title and colour bar stand on plates through which bodies shine a little", "[viz_export][view]") {
  // Black boards fill the picture: what is no letter is four parts paper and one part board there.
  ShapeStore shapes;
  const Surface board = surface_of(shapes, shapes.add(Box{Vec3(3, 0.1, 3)}), 1);
  BodyRecord wide = ball_at(0, Vec3::Zero());
  wide.surface = &board;
  wide.radius = 5;
  RunAbout about = about_with({0, 0, -9.81});
  about.view.from = Vec3(0, -4, 0);
  about.view.to = Vec3::Zero();
  const MadeRun run({frame_of({wide})}, about);
  const Overview overview = look_over(run);
  RenderOptions options = plain_options(false);
  options.camera = "scene";
  Image plain = RunPainter(run, overview, options).paint(0);
  options.labels = true;
  Image labelled = RunPainter(run, overview, options).paint(0);
  const double size = options.height / 38.0;
  for (const auto& [x, y] : {std::pair{0.6 * size, 0.6 * size}, {0.6 * size, options.height - 0.5 * size}}) {
    const std::uint8_t *under = plain.at(static_cast<int>(x), static_cast<int>(y)),
                       *over = labelled.at(static_cast<int>(x), static_cast<int>(y));
    for (std::size_t part = 0; part < 3; ++part) {
      CHECK(under[part] < 200);
      CHECK(std::abs(0.8 * 255 * paper[part] + 0.2 * under[part] - over[part]) <= 1);
    }
  }
  const int far = options.width - 5;
  CHECK(std::equal(plain.at(far, 5), plain.at(far, 5) + 3, labelled.at(far, 5)));
}

TEST_CASE("colours have no range where nothing is, and no width where all is one value", "[viz_export][view]") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0.1, 2.0);
  for (int round = 0; round < 10; ++round) {
    const double level = any(random), size = any(random);
    std::vector<BodyRecord> balls;
    for (std::uint32_t k = 0; k < 8; ++k) {
      balls.push_back(ball_at(k, Vec3(3 * any(random), any(random), level + 1e-9 * any(random))));  // rounding
      balls.back().radius = size;
    }
    std::vector<BodyRecord> walls = balls;
    for (BodyRecord& wall : walls) wall.mass = 0;
    const Overview all = look_over(*still_source("", {}, frame_of(balls)));
    const auto one_value = [&](const char* field) { return all.range.at(field)[0] == all.range.at(field)[1]; };
    CHECK(one_value("size"));
    CHECK(all.range.at("size")[0] == Approx(size));
    CHECK(one_value("height"));
    CHECK(one_value("speed"));  // all at rest, without gravity
    CHECK(all.range.at("id") == std::array<double, 2>{0, 7});
    const Overview none = look_over(*still_source("", {}, frame_of(walls)));
    for (const char* field : {"speed", "height", "size"}) CHECK_FALSE(colour_range(none, {}, field).has_value());
    // two sizes make a range
    balls[3].radius = 1.01 * size;
    const Overview two = look_over(*still_source("", {}, frame_of(balls)));
    CHECK(two.range.at("size")[1] == Approx(1.01 * two.range.at("size")[0]));
  }
}

TEST_CASE("legends count in whole numbers, and times tell frames apart", "[viz_export][view]") {
  CHECK(range_ticks({{0, 1}, {0, 1}, true}) == std::vector<std::string>{"0", "1"});
  CHECK(range_ticks({{0, 6}, {0, 6}, true}) == std::vector<std::string>{"0", "3", "6"});
  CHECK(range_ticks({{0, 1}, {0, 1}}) == std::vector<std::string>{"0", "0.5", "1"});
  CHECK(range_ticks({{0.25, 0.25}, {0.25, 0.25}}) == std::vector<std::string>{"all 0.25"});
  std::mt19937 random(8);
  for (int round = 0; round < 50; ++round) {
    const double apart = std::pow(10.0, -static_cast<double>(random() % 6)),
                 start = 1e3 * static_cast<double>(random() % 5);
    std::vector<double> times;
    for (int k = 0; k < 100; ++k) times.push_back(start + apart * k);
    for (std::size_t k = 0; k + 1 < times.size(); ++k) {
      CHECK(time_text(times, times[k]) != time_text(times, times[k + 1]));
      CHECK(std::abs(std::stod(time_text(times, times[k])) - times[k]) <= 0.05 * apart + 1e-9);
    }
  }
  CHECK(time_text({0, 0.1, 0.2}, 0.1) == "0.1");
}

TEST_CASE("a ball between two plates has the stress of its load", "[viz_export][view]") {
  // Two forces F at R above and below: sigma_zz = -2 R F / V, p = -sigma_zz / 3, von Mises = |sigma_zz| (uniaxial).
  const double F = 3.0, volume = 4.0 / 3.0 * std::numbers::pi * ball_radius * ball_radius * ball_radius;
  ViewFrame frame =
      frame_of({ball_at(0, Vec3(0, 0, 0)), ball_at(1, Vec3(0, 0, ball_radius)), ball_at(2, Vec3(0, 0, -ball_radius))});
  frame.bodies[1].mass = frame.bodies[2].mass = 0;  // walls
  const Eigen::Vector3f centre(0, 0, 0), up(0, 0, static_cast<float>(ball_radius)), push(0, 0, static_cast<float>(F));
  frame.contacts = {{0, 1, centre, up, -push, 3, 0, 0}, {0, 2, centre, -up, push, 3, 0, 0}};
  const RunAbout about;
  const FrameFields fields(frame, about);
  const double expected = 2 * ball_radius * F / volume;
  CHECK(fields("pressure")[0] == Approx(expected / 3));
  CHECK(fields("stress")[0] == Approx(expected));
  CHECK(fields("contacts")[0] == 2);
  CHECK(fields("force")[0] == Approx(2 * F));
  CHECK(fields("stress")[1] == 0);  // walls have none
}

TEST_CASE("two balls of unlike size part the line between them at their contact", "[viz_export][view]") {
  // A ball pulled at two opposite points and one pressed there: each arm is its own radius, whatever the partner's.
  ViewFrame frame = frame_of({ball_at(0, Vec3(0, 0, 0)), ball_at(1, Vec3(0.2, 0, 0)), ball_at(2, Vec3(-0.2, 0, 0))});
  frame.bodies[1].radius = frame.bodies[2].radius = 0.15;
  const Eigen::Vector3f one(0.2f, 0, 0), push(2, 0, 0), centre(0, 0, 0);
  frame.contacts = {{0, 1, centre, one, -push, 2, 0, 0}, {0, 2, centre, -one, push, 2, 0, 0}};
  const double volume = 4.0 / 3.0 * std::numbers::pi * ball_radius * ball_radius * ball_radius;
  const RunAbout about;
  const FrameFields fields(frame, about);
  CHECK(fields("stress")[0] == Approx(2 * ball_radius * 2.0 / volume));
  // and the larger ones have half as many contacts, three times the arm, 27 times the volume
  CHECK(fields("stress")[1] == Approx(0.15 * 2.0 / (27 * volume)));
}

TEST_CASE("a run that moves but for a moment has as many pictures as another", "[viz_export][view]") {
  std::vector<ViewFrame> frames;
  for (int k = 0; k < 40; ++k) frames.push_back(frame_of({ball_at(0, Vec3(0, 0, k < 4 ? 1 : 0))}));
  const std::vector<std::size_t> shown = telling_frames(MadeRun(frames, {}), 6);
  CHECK(shown.size() == 6);
  CHECK(std::is_sorted(shown.begin(), shown.end()));
  CHECK(std::adjacent_find(shown.begin(), shown.end()) == shown.end());
  CHECK(std::find(shown.begin(), shown.end(), 4u) != shown.end());  // where it has moved
  for (ViewFrame& frame : frames) frame.bodies.front().pose.position.setZero();
  CHECK(telling_frames(MadeRun(frames, {}), 6).size() == 2);  // nothing happens
}

TEST_CASE("the picture of a run that grows shows its last state, without what flew away", "[viz_export][view]") {
  // A heap that a source pours: frame k has 20 k balls, in layers; three of them leave far to the side.
  std::vector<ViewFrame> frames;
  for (std::uint32_t k = 0; k <= 40; ++k) {
    std::vector<BodyRecord> bodies;
    for (std::uint32_t b = 0; b < 20 * k; ++b) {
      const bool stray = b % 300 == 7;
      const Vec3 place(0.1 * (b % 5), 0.1 * (b / 5 % 4), 0.1 * (b / 20));
      bodies.push_back(ball_at(b, stray ? Vec3(500, 0, -300) : place));
    }
    frames.push_back(frame_of(std::move(bodies)));
  }
  const MadeRun run(frames, about_with({0, 0, -9.81}));
  const ViewBox box = look_over(run).box;
  CHECK(box.min.z() == Approx(-ball_radius));
  CHECK(box.max.x() == Approx(0.4 + ball_radius));
  CHECK(box.max.z() > 0.1 * 39 - 0.1);  // the last layer
  const std::vector<std::size_t> shown = telling_frames(run, 6);
  CHECK(shown.front() == 1);  // the first one with a body
  CHECK(shown.back() == 40);
  CHECK(shown.size() == 6);
}

TEST_CASE("walls are seen through after all bodies have left them", "[viz_export][view]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.5, 1.5);
  for (int k = 0; k < 4; ++k) {
    ShapeStore shapes;
    const Surface box = surface_of(shapes, shapes.add(Box{Vec3(0.2 * uniform(random), 0.2 * uniform(random), 0.2)}), 1);
    BodyRecord wall = ball_at(0, Vec3::Zero());
    wall.mass = 0;
    wall.surface = &box;
    const MadeRun run({frame_of({wall, ball_at(1, Vec3::Zero())}), frame_of({wall})}, about_with({0, 0, -9.81}));
    const Overview overview = look_over(run);
    RunPainter painter(run, overview, plain_options(false));
    Image full = painter.paint(0), empty = painter.paint(1);
    // beyond the outline of the ball, 0.86 of the picture's height wide at most, nothing changes
    std::size_t unlike = 0;
    for (int y = 0; y < full.height; ++y)
      for (int x = 0; x < full.width; ++x)
        if (std::hypot(x - 320, y - 240) > 215)
          unlike += std::equal(full.at(x, y), full.at(x, y) + 3, empty.at(x, y)) ? 0 : 1;
    CHECK(unlike == 0);
    CHECK(unlike_pixels(full, empty) > 100);
  }
}

TEST_CASE("a pale ball mixes with what is behind it by its opacity", "[viz_export][view]") {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const Camera camera{Vec3(0, -10, 0), Vec3::Zero(), Vec3::UnitZ(), 40.0};
  for (int k = 0; k < 6; ++k) {
    DrawnScene scene;
    scene.lines.push_back({{-2, 2, 0}, {2, 2, 0}, 0.3f, {0.7 * uniform(random), 0.7 * uniform(random), 0.5}});
    Image behind = draw_scene(scene, camera, 160, 120, {0.9, 0.9, 0.9});
    scene.balls.push_back({{static_cast<float>(uniform(random)), 0, 0}, 1.0f, {0.7 * uniform(random), 0.3, 0.5}});
    Image opaque = draw_scene(scene, camera, 160, 120, {0.9, 0.9, 0.9});
    const double opacity = scene.balls[0].opacity = static_cast<float>(0.1 + 0.8 * uniform(random));
    Image pale = draw_scene(scene, camera, 160, 120, {0.9, 0.9, 0.9});
    double worst = 0;
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 160; ++x)
        for (int part = 0; part < 3; ++part) {
          const double mixed = (1 - opacity) * behind.at(x, y)[part] + opacity * opaque.at(x, y)[part];
          worst = std::max(worst, std::abs(pale.at(x, y)[part] - mixed));
        }
    CHECK(worst <= 1.01);  // each of three is rounded
    CHECK(unlike_pixels(pale, behind) == unlike_pixels(opaque, behind));
    // a picture with contacts draws its spheres
    ViewFrame frame = frame_of({ball_at(0, Vec3::Zero()), ball_at(1, Vec3(0.1 + uniform(random), 0, 0))});
    frame.contacts.push_back({0, 1, {0, 0, 0}, {0.001f, 0, 0}, {1, 0, 0}, 1, 1e-3f, 0});
    const MadeRun run({frame}, about_with({0, 0, -9.81}));
    const Overview overview = look_over(run);
    Image with = RunPainter(run, overview, plain_options(true)).paint(0),
          without = RunPainter(run, overview, plain_options(false)).paint(0);
    Image empty = draw_scene({}, camera, 640, 480, {0.969, 0.973, 0.980});
    CHECK(static_cast<double>(unlike_pixels(with, empty)) ==
          Approx(static_cast<double>(unlike_pixels(without, empty))).epsilon(0.05));
  }
}

TEST_CASE("ribbons of contacts are no wider than 0.42 of the smaller body, and that wide between like ones",
          "[viz_export][view]") {
  std::mt19937 random(7);
  for (const double ratio : {1.0, 0.9, 0.5, 0.3, 0.3 + 1e-4 * static_cast<double>(random() % 1000)}) {
    BodyRecord large = ball_at(0, Vec3::Zero()), small = ball_at(1, Vec3(ball_radius * (1 + ratio), 0, 0));
    small.radius = ratio * ball_radius;
    ViewFrame frame = frame_of({large, small});
    const auto length = static_cast<float>(ball_radius * (1 + ratio));
    frame.contacts.push_back({0, 1, {0, 0, 0}, {length, 0, 0}, {1, 0, 0}, 1, 1e-3f, 0});
    const MadeRun run({frame}, about_with({0, 0, -9.81}));
    const Overview overview = look_over(run);
    Image image = RunPainter(run, overview, plain_options(true)).paint(0);
    std::size_t wide = 0, high = 0;
    for (int x = 0; x < image.width; ++x) {
      std::size_t column = 0;
      for (int y = 0; y < image.height; ++y) column += image.at(x, y)[0] > image.at(x, y)[2] + 60 ? 1 : 0;
      wide += column > 0 ? 1 : 0;
      high = std::max(high, column);
    }
    REQUIRE(wide > 50);
    CHECK(static_cast<double>(high) / static_cast<double>(wide) ==
          Approx(2 * 0.42 * ratio * ball_radius / length).margin(2.5 / static_cast<double>(wide)));
  }
}

TEST_CASE("names of kinds stand on a plate of their own, whatever is behind them", "[viz_export][view]") {
  std::mt19937 random(9);
  for (int k = 0; k < 4; ++k) {
    RunAbout about = about_with({0, 0, -9.81});
    about.materials = {"dark", std::string(1 + random() % 30, 'w')};
    ShapeStore shapes;
    const Surface slab = surface_of(shapes, shapes.add(Box{Vec3(0.2, 0.2, 0.05)}), 1);
    BodyRecord floor = ball_at(0, Vec3(0, 0, -0.05));
    floor.mass = 0;
    floor.surface = &slab;
    BodyRecord ball = ball_at(1, Vec3(0, 0, ball_radius));
    ball.material = 1;
    const MadeRun run({frame_of({floor, ball})}, about);
    const Overview overview = look_over(run);
    RenderOptions options = plain_options(false);
    options.labels = true;
    options.camera = "iso";
    options.field = "material";
    Image image = RunPainter(run, overview, options).paint(0);
    const double size = options.height / 38.0;
    const auto is_paper = [&](double x, double y) {
      const std::uint8_t* p = image.at(static_cast<int>(x), static_cast<int>(y));
      return p[0] == 247 && p[1] == 248 && p[2] == 250;
    };
    CHECK(is_paper(0.6 * size, options.height - 0.7 * size));  // beside and above the words
    CHECK(is_paper(0.6 * size, options.height - 4.4 * size));
    CHECK(!is_paper(options.width - 10, options.height - 10));  // the floor is elsewhere
  }
}
