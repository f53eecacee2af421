// What a picture leaves out, and that it says so: bodies that fly away, their values, places far from the origin.
#include <cmath>
#include <random>

#include "tests/support/catch.h"
#include "tests/viz_export/made_run.h"
#include "viz_export/measures/telling_rows.h"
#include "viz_export/view/film.h"
#include "viz_export/view/overview.h"
#include "viz_export/view/pack.h"
#include "viz_export/view/render_run.h"
#include "viz_export/vtk/surface.h"

using namespace epafi;

namespace {

/// Balls about a place that hardly move, for 3 s; `flying` of them leave at a speed or fall.
MadeRun heap_with_strays(std::mt19937& random, std::size_t balls, std::size_t flying, double speed, const Vec3& place) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec3> start, ways;
  for (std::size_t b = 0; b < balls; ++b) {
    start.push_back(place + Vec3(0.5 * uniform(random), 0.5 * uniform(random), 0.3 * uniform(random)));
    const double side = uniform(random) < 0 ? -1 : 1;  // not along the sight of a camera in front
    ways.push_back(Vec3(side, 0.3 * uniform(random), uniform(random)).normalized());
  }
  std::vector<ViewFrame> frames;
  for (int k = 0; k <= 30; ++k) {
    const double t = 0.1 * k;
    std::vector<BodyRecord> bodies;
    for (std::uint32_t b = 0; b < balls; ++b) {
      const bool flies = b < flying;
      const Vec3 moved = flies ? Vec3(speed * t * ways[b] - Vec3(0, 0, 4.9 * t * t)) : Vec3(0.02 * t * ways[b]);
      bodies.push_back(ball_at(b, start[b] + moved, flies ? Vec3(speed * ways[b]) : Vec3(0.02 * ways[b])));
    }
    frames.push_back(frame_of(std::move(bodies)));
  }
  return {std::move(frames), about_with({0, 0, -9.81})};
}

}  // namespace

TEST_CASE("a body that leaves spoils no picture, however few there are, and is counted", "[viz_export][view]") {
  std::mt19937 random(31);
  for (const std::size_t balls : {4u, 11u, 20u, 60u, 99u, 100u, 150u, 400u})
    for (const double speed : {0.0, 100.0, 5e4, 1e6}) {
      const std::size_t flying = balls < 8 ? 1 : 1 + balls / 200;
      const MadeRun run = heap_with_strays(random, balls, flying, speed, Vec3(3, -2, 1));
      const Overview overview = look_over(run);
      INFO(balls << " balls, " << speed << " m/s");
      CHECK(overview.box.diagonal() < 4.0);
      CHECK(overview.box.holds(Vec3(3, -2, 1)));
      // colours are those of what is seen
      CHECK(overview.range.at("speed")[1] < 0.03);
      RenderOptions options = plain_options(false);
      RunPainter painter(run, overview, options);
      CHECK(painter.outside(run.frame(0)) == 0);
      CHECK(painter.outside(run.frame(30)) == flying);
      Image first = painter.paint(0), last = painter.paint(30);
      const Image empty = draw_scene({}, Camera{Vec3(0, -1, 0), Vec3::Zero()}, 640, 480, {0.969, 0.973, 0.980});
      Image paper = empty;
      const double staying = static_cast<double>(balls - flying) / static_cast<double>(balls);
      CHECK(static_cast<double>(unlike_pixels(last, paper)) >
            0.8 * staying * static_cast<double>(unlike_pixels(first, paper)));
    }
  CHECK(outside_text(0).empty());
  CHECK(outside_text(1) == "1 body outside the picture");
  CHECK(outside_text(7) == "7 bodies outside the picture");
}

TEST_CASE("after all bodies have blown away the picture stays where they began", "[viz_export][view]") {
  std::mt19937 random(32);
  for (const std::size_t balls : {2u, 11u, 120u, 300u}) {
    const MadeRun run = heap_with_strays(random, balls, balls, 1e6, Vec3(0, 0, 0));
    CHECK(look_over(run).box.diagonal() < 20);
  }
}

TEST_CASE("what most bodies do is shown whole: a throw, a drive, a drop on a heap", "[viz_export][view]") {
  std::mt19937 random(33);
  std::uniform_real_distribution<double> uniform(1, 5);
  for (int round = 0; round < 10; ++round) {
    std::vector<ViewFrame> throws, drives, drops;
    const double speed = uniform(random), height = uniform(random);
    for (int k = 0; k <= 20; ++k) {
      const double t = 0.1 * k;
      throws.push_back(frame_of({ball_at(0, Vec3(speed * t, 0, 10 * t - 4.9 * t * t))}));
      std::vector<BodyRecord> wagon, heap;
      for (std::uint32_t b = 0; b < 5; ++b) wagon.push_back(ball_at(b, Vec3(10 * speed * t + 0.3 * b, 0, 0)));
      for (std::uint32_t b = 0; b < 9; ++b) heap.push_back(ball_at(b, Vec3(0.1 * b, 0, 0)));
      heap.push_back(ball_at(9, Vec3(0.3, 0, std::max(0.1, height - 4.9 * t * t))));
      drives.push_back(frame_of(std::move(wagon)));
      drops.push_back(frame_of(std::move(heap)));
    }
    CHECK(look_over(MadeRun(throws, {})).box.max.x() == Approx(2 * speed + ball_radius));
    CHECK(look_over(MadeRun(drives, {})).box.max.x() == Approx(20 * speed + 1.2 + ball_radius));
    CHECK(look_over(MadeRun(drops, {})).box.max.z() == Approx(height + ball_radius));
  }
}

TEST_CASE("the square of a half-space far from its body's origin keeps its corners", "[viz_export][view]") {
  std::mt19937 random(34);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double far : {0.0, 1e3, 1e6, 1e9}) {
    const Vec3 centre(far * (1.5 + uniform(random)), -far, 0);
    ShapeStore shapes;
    const Surface square = surface_of(shapes, shapes.add(HalfSpace{Vec3::UnitZ()}), 2.0, centre);
    BodyRecord wall = ball_at(0, Vec3(0, 0, 0.25));
    wall.mass = 0;
    wall.radius = std::numeric_limits<double>::infinity();
    wall.surface = &square;
    const auto source = still_source("", {}, frame_of({wall, ball_at(1, centre + Vec3(0, 0, 0.5))}));
    const BodyRecord shown = source->frame(0).bodies[0];
    const ViewMesh mesh = view_mesh(*shown.surface);
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3 corner = shown.pose.position + shown.pose.orientation * mesh.points[k].cast<double>();
      CHECK((corner - wall.pose.to_world(square.points[k])).norm() < 1e-6 + 1e-15 * far);
    }
    CHECK(source->bodies()[0].surface == shown.surface);
  }
}

TEST_CASE("a thinned curve keeps the least and the largest value, and all moments of change", "[viz_export][view]") {
  std::mt19937 random(35);
  for (int round = 0; round < 60; ++round) {
    const std::size_t n = 1 + random() % 20000, width = 1 + random() % 4, most = 100 + random() % 2000;
    StoredMeasure m{"impact", "", {}, {}, {}};
    for (std::size_t c = 0; c < width; ++c) m.components.push_back(std::string(1, static_cast<char>('a' + c)));
    for (std::size_t k = 0; k < n; ++k) m.times.push_back(static_cast<double>(k));
    m.values.assign(n * width, 0.0);
    const std::size_t up = random() % n, down = random() % n, c = random() % width;
    m.values[up * width + c] = 7;
    m.values[down * width + c] = -3;
    if (random() % 2 == 0) m.values[(random() % n) * width + c] = std::nan("");
    const std::vector<std::size_t> rows = telling_rows(m, c, most);
    REQUIRE(!rows.empty());
    CHECK(rows.size() <= std::max(most, std::size_t{2}));
    CHECK(std::is_sorted(rows.begin(), rows.end()));
    CHECK(std::adjacent_find(rows.begin(), rows.end()) == rows.end());
    CHECK(rows.front() == 0);
    CHECK(rows.back() == n - 1);
    for (const std::size_t k : {up, down})
      if (m.values[k * width + c] == 7 || m.values[k * width + c] == -3)
        CHECK(std::find(rows.begin(), rows.end(), k) != rows.end());
  }
}

TEST_CASE("films last three seconds at least, at 25 pictures a second at most", "[viz_export][view]") {
  for (std::size_t pictures = 1; pictures < 300; ++pictures) {
    const double rate = film_rate(pictures);
    CHECK(rate <= 25);
    CHECK(static_cast<double>(pictures) / rate >= 3 - 1e-12);
    if (pictures >= 75) CHECK(rate == 25);
  }
}
