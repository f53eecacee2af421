// The rasteriser against rays; pictures of any size and place; half-spaces from both sides; letters.
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "detection/shapes/all_shapes.h"
#include "tests/support/catch.h"
#include "tests/viz_export/made_run.h"
#include "viz_export/view/more_glyphs.h"
#include "viz_export/view/refine.h"
#include "viz_export/vtk/surface.h"

using namespace epafi;

namespace {

constexpr int wide = 120, high = 90;

/// What the ray from the eye through a place of the picture meets first: 0 the ball, 1 the triangle, -1 nothing.
int met_by_ray(const DrawnScene& scene, const Camera& camera, double x, double y) {
  const Vec3 back = (camera.eye - camera.target).normalized();
  const Vec3 right = camera.up.cross(back).normalized(), up = back.cross(right);
  const double step = 2 * std::tan(0.5 * camera.angle * std::numbers::pi / 180) / high;
  const Vec3 ray = -back + step * ((x - 0.5 * wide) * right + (0.5 * high - y) * up);
  const double nearest = 1e-4 * (camera.eye - camera.target).norm();
  double first = std::numeric_limits<double>::infinity();
  int out = -1;
  const DrawnBall& ball = scene.balls[0];
  const Vec3 way = ball.centre.cast<double>() - camera.eye;
  const double along = ray.dot(way), rest = way.squaredNorm() - ball.radius * ball.radius;
  const double under = along * along - ray.squaredNorm() * rest;
  if (rest > 0 && under >= 0) {
    const double depth = (along - std::sqrt(under)) / ray.squaredNorm();
    if (depth >= nearest) {
      first = depth;
      out = 0;
    }
  }
  const Vec3 a = scene.triangles[0].corner[0].cast<double>(), b = scene.triangles[0].corner[1].cast<double>(),
             c = scene.triangles[0].corner[2].cast<double>();
  Mat3 sides;
  sides << b - a, c - a, -ray;
  const Vec3 solution = sides.inverse() * (camera.eye - a);  // shares of the sides, and the depth
  const bool inside = solution.x() >= 0 && solution.y() >= 0 && solution.x() + solution.y() <= 1;
  if (inside && solution.z() >= nearest && solution.z() < first) out = 1;
  return out;
}

struct Looked {
  DrawnScene scene;
  Camera camera;
};

/// A red ball and a green triangle about the eye: some in front, some beside it, some behind.
Looked random_look(std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  const auto somewhere = [&](double size) -> Vec3 { return size * Vec3(any(random), any(random), any(random)); };
  Looked out;
  out.camera = {somewhere(1), Vec3::Zero(), Vec3::UnitZ(), 30 + 30 * std::abs(any(random))};
  const double distance = out.camera.eye.norm();
  const auto ball = static_cast<float>(distance * (0.05 + 0.6 * std::abs(any(random))));
  out.scene.balls.push_back({(out.camera.eye + somewhere(distance)).cast<float>(), ball, {1, 0, 0}});
  DrawnTriangle t;
  for (int k = 0; k < 3; ++k) {
    t.corner[k] = (out.camera.eye + somewhere(2 * distance)).cast<float>();
    t.normal[k] = Eigen::Vector3f::UnitZ();
  }
  t.colour = {0, 1, 0};
  out.scene.triangles.push_back(t);
  return out;
}

/// 0 red, 1 green, -1 the paper.
int seen_at(Image& image, int x, int y) {
  const std::uint8_t* p = image.at(x, y);
  if (p[2] > 200) return -1;
  return p[0] > p[1] ? 0 : 1;
}

}  // namespace

TEST_CASE("what is drawn near, beside and behind the eye is what rays meet", "[viz_export][view]") {
  std::mt19937 random(11);
  std::size_t balls = 0, triangles = 0, near_balls = 0, cut_triangles = 0;
  for (int draw = 0; draw < 300; ++draw) {
    const Looked look = random_look(random);
    Image image = draw_scene(look.scene, look.camera, wide, high, {0, 0, 1});
    std::size_t unlike = 0, seen[2] = {0, 0};
    for (int y = 0; y < high; ++y)
      for (int x = 0; x < wide; ++x) {
        const int middle = met_by_ray(look.scene, look.camera, x + 0.5, y + 0.5);
        bool clear = true;  // of borders: all about the pixel meet the same
        for (const double dx : {-0.1, 1.1})
          for (const double dy : {-0.1, 1.1})
            clear = clear && met_by_ray(look.scene, look.camera, x + dx, y + dy) == middle;
        if (!clear) continue;
        if (middle >= 0) ++seen[middle];
        unlike += seen_at(image, x, y) != middle ? 1 : 0;
      }
    INFO(draw);
    CHECK(unlike <= 2);  // slivers of less than a pixel
    const Vec3 ahead = (look.camera.target - look.camera.eye).normalized();
    const DrawnBall& ball = look.scene.balls[0];
    if (seen[0] > 0) ++balls;
    if (seen[0] > 0 && ahead.dot(ball.centre.cast<double>() - look.camera.eye) < ball.radius) ++near_balls;
    bool behind = false;
    for (const auto& corner : look.scene.triangles[0].corner)
      behind = behind || ahead.dot(corner.cast<double>() - look.camera.eye) < 0;
    if (seen[1] > 0) ++triangles;
    if (seen[1] > 0 && behind) ++cut_triangles;
  }
  CHECK(balls > 30);  // of 300
  CHECK(triangles > 30);
  CHECK(near_balls > 3);  // the cases that a cut at the eye's plane would lose
  CHECK(cut_triangles > 10);
}

TEST_CASE("a scene looks the same in atoms, metres and kilometres, and far from the origin", "[viz_export][view]") {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int draw = 0; draw < 4; ++draw) {
    std::vector<Vec3> places;
    for (int k = 0; k < 12; ++k) places.push_back(0.3 * Vec3(any(random), any(random), any(random)));
    const auto picture = [&](double unit, const Vec3& shift) {
      ShapeStore shapes;
      const Surface cube = surface_of(shapes, shapes.add(Box{unit * Vec3(0.06, 0.05, 0.04)}), 1);
      std::vector<BodyRecord> bodies;
      for (std::uint32_t k = 0; k < places.size(); ++k) {
        bodies.push_back(ball_at(k, unit * places[k] + shift));
        bodies.back().radius = unit * ball_radius;
        if (k % 2 == 1) bodies.back().surface = &cube;
        bodies.back().velocity = unit * places[k];
      }
      ViewFrame frame = frame_of(bodies);
      const MadeRun run({frame}, about_with({0, 0, 0}));
      const Overview overview = look_over(run);
      RenderOptions options = plain_options(false);
      options.camera = "iso";
      return RunPainter(run, overview, options).paint(0);
    };
    Image metres = picture(1, Vec3::Zero());
    Image empty = draw_scene({}, {Vec3(0, -1, 0), Vec3::Zero(), Vec3::UnitZ(), 30}, 640, 480, {0.969, 0.973, 0.980});
    REQUIRE(unlike_pixels(metres, empty) > 3000);
    for (const auto& [unit, shift] : {std::pair{1e-12, 0.0}, {1e-9, 0.0}, {1e6, 0.0}, {1.0, 1e5}, {1e-6, 1e-1}}) {
      Image other = picture(unit, shift * Vec3(1, -1, 0.5));
      std::size_t unlike = 0;
      for (int y = 0; y < 480; ++y)
        for (int x = 0; x < 640; ++x)
          for (int part = 0; part < 3; ++part)
            if (std::abs(other.at(x, y)[part] - metres.at(x, y)[part]) > 40) ++unlike;
      INFO(unit << ", " << shift);
      CHECK(unlike < 300);  // of 10^6: borders that fall otherwise by rounding
    }
  }
}

TEST_CASE("a drawn round body is as dark at its outline as the ball that it stands for", "[viz_export][view]") {
  // Normals between the corners of a facet at the outline point away from the eye; as if the facet were seen from
  // behind they would give bright and dark scraps there.
  std::mt19937 random(17);
  std::normal_distribution<double> any;
  ShapeStore shapes;
  const Surface round = surface_of(shapes, shapes.add(Ellipsoid{Vec3::Ones()}), 1);
  const ViewMesh mesh = refined(view_mesh(round));
  for (int k = 0; k < 10; ++k) {
    const Vec3 eye = 6 * Vec3(any(random), any(random), any(random)).normalized();
    const Camera camera{eye, Vec3::Zero(), Vec3(any(random), any(random), any(random)).normalized(), 24};
    DrawnScene as_ball, as_mesh;
    as_ball.balls.push_back({{0, 0, 0}, 1.0f, {0.9, 0.9, 0.0}});
    for (std::size_t c = 0; c < mesh.corners.size(); c += 3) {
      DrawnTriangle t;
      for (std::size_t e = 0; e < 3; ++e) {
        t.corner[e] = mesh.points[mesh.corners[c + e]];
        t.normal[e] = mesh.normals[c + e];
      }
      t.colour = {0.9, 0.9, 0.0};
      as_mesh.triangles.push_back(t);
    }
    constexpr int side = 200;
    const Rgb blue{0, 0, 1};
    Image ball = draw_scene(as_ball, camera, side, side, blue), drawn = draw_scene(as_mesh, camera, side, side, blue);
    int worst = 0, compared = 0;
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        if (ball.at(x, y)[2] > 40 || drawn.at(x, y)[2] > 40) continue;  // beside one of them, or partly so
        ++compared;
        worst = std::max(worst, std::abs(ball.at(x, y)[0] - drawn.at(x, y)[0]));
      }
    CHECK(compared > side * side / 3);
    CHECK(worst < 45);  // normals turned round: 98 levels
  }
}

TEST_CASE("a half-space is seen from within, and hides nothing there", "[viz_export][view]") {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  for (int draw = 0; draw < 6; ++draw) {
    const Vec3 normal = Vec3(any(random), 1.5, any(random)).normalized();  // away from the front, where the eye is
    ShapeStore shapes;
    const Surface square = surface_of(shapes, shapes.add(HalfSpace{normal}), 0.8);
    BodyRecord plane = ball_at(0, -0.15 * normal);
    plane.mass = 0;
    plane.radius = std::numeric_limits<double>::infinity();
    plane.surface = &square;
    BodyRecord ball = ball_at(1, Vec3::Zero(), Vec3(1, 0, 0));
    const MadeRun with({frame_of({plane, ball})}, about_with({0, 0, -9.81})),
        without({frame_of({ball})}, about_with({0, 0, -9.81}));
    RenderOptions options = plain_options(false);
    Overview overview = look_over(without);
    overview.box.include(Vec3::Zero(), 0.3);
    Image both = RunPainter(with, overview, options).paint(0), alone = RunPainter(without, overview, options).paint(0);
    double strongest = 0;
    std::size_t tinted = 0, ball_pixels = 0, changed_much = 0;
    for (int y = 0; y < both.height; ++y)
      for (int x = 0; x < both.width; ++x) {
        double change = 0;
        for (int part = 0; part < 3; ++part)
          change = std::max<double>(change, std::abs(both.at(x, y)[part] - alone.at(x, y)[part]));
        tinted += change > 0 ? 1 : 0;
        const bool on_ball = alone.at(x, y)[2] < 230;
        ball_pixels += on_ball ? 1 : 0;
        changed_much += on_ball && change > 0.06 * 255 + 1 ? 1 : 0;
        strongest = std::max(strongest, change);
      }
    REQUIRE(ball_pixels > 500);
    CHECK(tinted > 20000);                  // it is there
    CHECK(strongest > 20);                  // its lines are
    CHECK(changed_much < ball_pixels / 5);  // they are thin; the rest is a breath of colour
    options.camera = "back";                // from its own side it hides, as any wall
    Image before = RunPainter(with, overview, options).paint(0);
    CHECK(unlike_pixels(before, alone) > 20000);
  }
}

TEST_CASE("what has no end but is no half-space is drawn as any body", "[viz_export][view]") {
  std::mt19937 random(15);
  std::uniform_real_distribution<double> any(0.05, 0.3);
  for (int draw = 0; draw < 4; ++draw) {
    ShapeStore shapes;
    const Surface rail = surface_of(shapes, shapes.add(Box{Vec3(any(random), any(random), any(random))}), 1);
    BodyRecord wall = ball_at(0, Vec3(0, 0, -0.4));
    wall.mass = 0;
    wall.surface = &rail;
    const BodyRecord ball = ball_at(1, Vec3::Zero());
    const MadeRun ended({frame_of({wall, ball})}, about_with({0, 0, -9.81}));
    wall.radius = std::numeric_limits<double>::infinity();
    const MadeRun endless({frame_of({wall, ball})}, about_with({0, 0, -9.81}));
    RenderOptions options = plain_options(false);
    options.camera = "iso";
    const Overview overview = look_over(ended);
    Image one = RunPainter(ended, overview, options).paint(0), other = RunPainter(endless, overview, options).paint(0);
    std::size_t unlike = 0;
    for (int y = 0; y < one.height; ++y)
      for (int x = 0; x < one.width; ++x)
        for (int part = 0; part < 3; ++part)
          if (std::abs(one.at(x, y)[part] - other.at(x, y)[part]) > 12) ++unlike;
    CHECK(unlike < 20000);  // its edges alone are missing
  }
}

TEST_CASE("letters beyond ASCII have outlines of their own, others stand as codes", "[viz_export][view]") {
  for (std::size_t k = 0; k < std::size(more_glyphs); ++k) {
    REQUIRE(std::string(more_glyphs[k]).size() >= 5);
    if (k > 0) REQUIRE(std::string(more_glyphs[k - 1], 4) < std::string(more_glyphs[k], 4));
  }
  const auto drawn = [](const std::string& text) {
    Image image(300, 60);
    draw_text(image, 10, 40, text, 30, {1, 1, 1});
    return image;
  };
  Image blank(300, 60);
  const std::vector<std::string> letters{"\u00e9", "\u00df", "\u00f8", "\u0142", "\u03bc", "\u0416",
                                         "\u00b2", "\u2264", "e",      "?",      "\u6d4b"};
  for (const std::string& a : letters) {
    Image one = drawn(a);
    CHECK(unlike_pixels(one, blank) > 20);
    CHECK(text_width(a, 30) > 5);
    CHECK(text_width(a + a, 30) == Approx(2 * text_width(a, 30)));
    for (const std::string& b : letters) {
      Image other = drawn(b);
      CHECK((a == b) == (unlike_pixels(one, other) == 0));
    }
  }
  CHECK(without_outline("plain \u00e9\u03b1\u0416 \u2192").empty());
  CHECK(without_outline("\u6d4b\u8bd5 \u6d4b") == "U+6D4B, U+8BD5");
  CHECK(without_outline("\U0001F600") == "U+1F600");
  CHECK(without_outline("a\tb\nc").empty());
}

TEST_CASE("no bytes of a title end the drawing of text", "[viz_export][view]") {
  std::mt19937 random(14);
  for (int draw = 0; draw < 500; ++draw) {
    std::string text;
    for (std::size_t k = 0; k < 1 + draw % 20u; ++k) text += static_cast<char>(random() % 256);
    Image image(200, 40);
    draw_text(image, 5, 30, text, 12, {1, 1, 1});
    const double width = text_width(text, 12);
    CHECK(std::isfinite(width));
    CHECK(width >= 0);
    (void)without_outline(text);
  }
}
