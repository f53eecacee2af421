// What the page is made of: orientations, differences, meshes, chosen frames, pictures, the local server.
#include <arpa/inet.h>
#include <sys/socket.h>

#include <atomic>
#include <numbers>
#include <thread>

#include "tests/support/catch.h"
#include "tests/viz_export/small_scene.h"
#include "tests/viz_export/temporary_folder.h"
#include "viz_export/measures/measure_units.h"
#include "viz_export/report/html_text.h"
#include "viz_export/view/mesh.h"
#include "viz_export/view/orientation_bits.h"
#include "viz_export/view/overview.h"
#include "viz_export/view/pack.h"
#include "viz_export/view/planes.h"
#include "viz_export/view/raster.h"
#include "viz_export/view/server.h"

using namespace epafi;

namespace {

ViewFrame balls_at(const std::vector<Vec3>& places, double radius) {
  ViewFrame frame;
  for (const Vec3& p : places) {
    BodyRecord b;
    b.id = static_cast<std::uint32_t>(frame.bodies.size());
    b.mass = 1;
    b.radius = radius;
    b.pose.position = p;
    frame.bodies.push_back(b);
  }
  return frame;
}

int connect_to(std::uint16_t port) {
  const int s = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(port);
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  REQUIRE(::connect(s, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0);
  return s;
}

std::string rest_of(int s, const std::string& request) {
  REQUIRE(::send(s, request.data(), request.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(request.size()));
  std::string out;
  char piece[4096];
  for (ssize_t n; (n = ::recv(s, piece, sizeof piece, 0)) > 0;) out.append(piece, static_cast<std::size_t>(n));
  ::close(s);
  return out;
}

std::string ask(std::uint16_t port, const std::string& request) { return rest_of(connect_to(port), request); }

}  // namespace

TEST_CASE("an orientation in 32 bits is off by 0.28 degrees at most", "[viz_export][view]") {
  // Three components are off by h = sqrt(2)/2044 each. The fourth is the largest, at least 1/2, and the others at most
  // as large: it is off by 3 h. Angle <= 2 sqrt(3 + 9) h = 0.275 degrees.
  double worst = 0;
  for (int k = 0; k < 20000; ++k) {
    const auto u = [&](int part) { return std::sin(12.9898 * (4 * k + part) + 78.233 * part * part); };
    const Quat q = Quat(u(0), u(1), u(2), u(3)).normalized();
    worst = std::max(worst, q.angularDistance(orientation_of(orientation_bits(q))));
  }
  CHECK(worst * 180 / std::numbers::pi < 0.28);
  CHECK(worst > 0);
}

TEST_CASE("differences go by row first and by frame then, and small ones fill the lowest plane only",
          "[viz_export][view]") {
  CHECK(zigzag(0) == 0);
  CHECK(zigzag(-1) == 1);
  CHECK(zigzag(1) == 2);
  CHECK(zigzag(std::numeric_limits<std::int32_t>::min()) == 0xffffffffu);
  const std::vector<std::int32_t> first{100, 103, 101}, second{101, 103, 100};
  std::string by_row, by_frame;
  put_differences(by_row, first, {}, 2);
  put_differences(by_frame, second, first, 2);
  CHECK(by_row == std::string("\xc8\x06\x03\0\0\0", 6));
  CHECK(by_frame == std::string("\x02\0\x01\0\0\0", 6));
}

TEST_CASE("scaled copies of a surface share a mesh; normals of a cube are those of its faces", "[viz_export][view]") {
  ShapeStore shapes;
  const Surface small = surface_of(shapes, shapes.add(Box{Vec3(1, 2, 3)}), 1),
                large = surface_of(shapes, shapes.add(Box{Vec3(2, 4, 6)}), 1),
                other = surface_of(shapes, shapes.add(Box{Vec3(2, 2, 3)}), 1);
  MeshStore store;
  const auto a = store.of(&small), b = store.of(&large), c = store.of(&other), ball = store.of(nullptr);
  CHECK(a.mesh == b.mesh);
  CHECK(b.scale == Approx(2 * a.scale));
  CHECK(c.mesh != a.mesh);
  CHECK(ball.mesh == -1);
  const ViewMesh& mesh = store.all()[0];
  CHECK(mesh.corners.size() == 6 * 2 * 3);
  for (std::size_t k = 0; k < mesh.normals.size(); ++k) {
    CHECK(mesh.normals[k].cwiseAbs().maxCoeff() == Approx(1));     // along an axis
    CHECK(mesh.normals[k].dot(mesh.points[mesh.corners[k]]) > 0);  // outwards
  }
}

TEST_CASE("a stray does not shrink the picture, one body of few does not count as one", "[viz_export][view]") {
  std::vector<Vec3> places;
  for (int k = 0; k < 1000; ++k) places.emplace_back(0.1 * (k % 10), 0.1 * (k / 10 % 10), 0.1 * (k / 100));
  places.emplace_back(0, 0, -1000);
  const Overview many = look_over(*still_source("", {}, balls_at(places, 0.05)));
  CHECK(many.box.min.z() == Approx(-0.05));
  CHECK(many.box.max.x() == Approx(0.95));
  const Overview few = look_over(*still_source("", {}, balls_at({{0, 0, 0}, {0, 0, 100}}, 1)));
  CHECK(few.box.max.z() == Approx(101));
}

TEST_CASE("every camera sees the whole box", "[viz_export][view]") {
  ViewBox box;
  box.include(Vec3(-1, 2, 3));
  box.include(Vec3(4, 2.5, 9));
  for (const auto& [name, direction] : camera_presets()) {
    const Camera c = choose_camera(name, {}, box, 1.6);
    const Vec3 towards = (c.eye - c.target).normalized(), right = c.up.cross(towards).normalized(),
               up = towards.cross(right);
    const double half = std::tan(0.5 * c.angle * std::numbers::pi / 180);
    double largest = 0;
    for (int k = 0; k < 8; ++k) {
      const Vec3 p(k & 1 ? 4 : -1, k & 2 ? 2.5 : 2, k & 4 ? 9 : 3), r = p - c.eye;
      const double depth = -towards.dot(r);
      REQUIRE(depth > 0);
      largest = std::max({largest, std::abs(right.dot(r)) / depth / half / 1.6, std::abs(up.dot(r)) / depth / half});
    }
    CHECK(largest == Approx(0.86));  // of the half picture: a corner touches the margin
  }
  CHECK_THROWS_AS(choose_camera("nowhere", {}, box, 1.0), SceneError);
}

TEST_CASE("a ball covers the pixels that its cone of sight covers, and hides what is behind it", "[viz_export][view]") {
  // at distance d a ball of radius r is seen under asin(r/d): its outline has the radius f r / sqrt(d^2 - r^2)
  DrawnScene scene;
  scene.balls.push_back({{0, 0, 0}, 1.0f, {1, 0, 0}});
  scene.balls.push_back({{0, 3, 0}, 1.0f, {0, 1, 0}});
  const Camera camera{Vec3(0, -10, 0), Vec3::Zero(), Vec3::UnitZ(), 40.0};
  Image image = draw_scene(scene, camera, 300, 200, {0, 0, 0});
  double red = 0, green = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 300; ++x) {
      red += image.at(x, y)[0] > 40 ? 1 : 0;
      green += image.at(x, y)[1] > image.at(x, y)[0] ? 1 : 0;
    }
  const double focus = 100 / std::tan(20 * std::numbers::pi / 180), outline = focus / std::sqrt(99.0);
  CHECK(red == Approx(std::numbers::pi * outline * outline).epsilon(0.03));  // pixels on the outline count half
  CHECK(green == 0);
  CHECK(png_of(image).substr(1, 3) == "PNG");
}

TEST_CASE("a page cannot be left by what a scene is called", "[viz_export][view]") {
  CHECK(script_escaped("{\"a\":\"</script>\"}") == "{\"a\":\"\\u003c/script>\"}");
  CHECK(base64("Man") == "TWFu");
  CHECK(base64("Ma") == "TWE=");
  CHECK(html_escaped("a<b>&\"") == "a&lt;b&gt;&amp;&quot;");
}

TEST_CASE("each component of a measure has its quantity and unit", "[viz_export][view]") {
  CHECK(axis_label(measure_unit("energy", "kinetic")) == "energy [J]");
  CHECK(axis_label(measure_unit("velocity", "x")) == "velocity [m/s]");
  CHECK(axis_label(measure_unit("position", "x")) == "position [m]");
  CHECK(axis_label(measure_unit("energy", "relative_error")) == "relative error");
  CHECK(axis_label(measure_unit("", "kinetic")) == "energy [J]");  // of a run that does not tell its kind
}

TEST_CASE("names, springs and camera of a run come back from their text", "[viz_export][view]") {
  RunAbout about;
  about.materials = {"glass", "two words"};
  about.groups = {{"stack", 3, 10}, {"", 13, 1}};
  about.springs = {{"leaf spring", 4, {}, Vec3(0.1, -0.2, 0.3)}, {"s", 1, 2u, Vec3::Zero()}};
  about.gravity = Vec3(0, 1.5, -9.81);
  about.view.from = Vec3(1, 2, 3);
  about.view.field = "force";
  about.view.range = {{-1, 1e-3}};
  const RunAbout back = about_from_text(to_text(about));
  CHECK(back.materials == about.materials);
  REQUIRE(back.groups.size() == 2);
  CHECK(back.groups[1].name.empty());
  CHECK(back.groups[0].count == 10);
  REQUIRE(back.springs.size() == 2);
  CHECK(back.springs[0].name == "leaf spring");
  CHECK(!back.springs[0].to);
  CHECK(back.springs[1].to == 2u);
  CHECK(back.gravity == about.gravity);
  CHECK(back.view.from == about.view.from);
  CHECK(upwards(back).z() > 0.98);  // against gravity: the text names no other
  CHECK(back.view.range == about.view.range);
  CHECK(back.view.field == "force");
}

TEST_CASE("the local server answers its own machine, and nothing else", "[viz_export][view]") {
  const LocalServer server(0);
  std::atomic<bool> stop{false};
  std::thread serving([&] {
    server.serve(
        [](const std::string& path) -> HttpAnswer {
          if (path == "/bad") throw FileError("not now");
          return {200, "text/plain", "you asked " + path};
        },
        [&] { return stop.load(); });
  });
  const std::string own = "Host: 127.0.0.1:" + std::to_string(server.port()) + "\r\n\r\n";
  CHECK(ask(server.port(), "GET /a?b HTTP/1.1\r\n" + own).ends_with("you asked /a"));
  CHECK(ask(server.port(), "GET /a HTTP/1.1\r\nHost: elsewhere.example\r\n\r\n").starts_with("HTTP/1.1 403"));
  CHECK(ask(server.port(), "POST /a HTTP/1.1\r\n" + own).starts_with("HTTP/1.1 405"));
  CHECK(ask(server.port(), "nonsense\r\n\r\n").starts_with("HTTP/1.1 400"));
  CHECK(ask(server.port(), "GET /bad HTTP/1.1\r\n" + own).starts_with("HTTP/1.1 503"));
  const int quiet = connect_to(server.port()), gone = connect_to(server.port()), slow = connect_to(server.port());
  close(gone);
  for (int i = 0; i < 100; ++i) {  // a request that waited for a quiet connection would take seconds
    CHECK(ask(server.port(), "GET /b HTTP/1.1\r\n" + own).ends_with("you asked /b"));
    send(slow, "x", 1, MSG_NOSIGNAL);
  }
  CHECK(rest_of(quiet, "GET /c HTTP/1.1\r\n" + own).ends_with("you asked /c"));
  CHECK(rest_of(slow, "\r\n\r\n").starts_with("HTTP/1.1 400"));
  CHECK_THROWS_AS(LocalServer(server.port()), FileError);
  stop = true;
  serving.join();
}
