// Clumps: mass properties of unions, motion and impacts beside single spheres, walls of every kind.
#include <cmath>
#include <fstream>
#include <numbers>

#include "detection/shapes/clump.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "tests/support/scene_text.h"
#include "tests/viz_export/temporary_folder.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

using std::numbers::pi;

const std::string head = R"(title = "c"
run = { duration = 1.0, time_step = 2e-6, output_interval = 0.1 }
material.m = { density = 2000.0, youngs_modulus = "100 MPa", poissons_ratio = 0.25 }
contact = { method = "smooth", restitution = 1.0, friction = 0.3, smooth = { law = "hertz-mindlin" } }
)";

}  // namespace

TEST_CASE("mass properties of unions of balls are exact", "[physics][clump]") {
  const double r = 0.7;
  const MassProperties one =
      union_mass_properties(std::vector<PlacedBall>{{{1, 2, 3}, r}, {{1, 2, 3}, r}, {{1.1, 2, 3}, 0.2}});
  const double ball = 4.0 / 3.0 * pi * r * r * r;  // twice the same and one inside count once
  CHECK(one.mass == Approx(ball).epsilon(1e-11));
  CHECK((one.centre - Vec3(1, 2, 3)).norm() < 1e-11);
  CHECK((one.inertia - 0.4 * ball * r * r * Mat3::Identity()).norm() < 1e-11);
  // two equal balls at distance d: 2 V minus the lens pi (4 r + d)(2 r - d)^2 / 12, along any direction
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 0, 1), Vec3(1, -2, 0.5)}) {
    const double d = 0.9;
    const Vec3 half = 0.5 * d * axis.normalized();
    const MassProperties two = union_mass_properties(std::vector<PlacedBall>{{half, r}, {-half, r}});
    CHECK(two.mass == Approx(2 * ball - pi * (4 * r + d) * (2 * r - d) * (2 * r - d) / 12).epsilon(1e-10));
    CHECK(two.centre.norm() < 1e-10);
    // about the axis: two balls cut at the middle plane, I = pi/2 int (r^2 - z^2)^2 dz from -r to d/2, twice
    const auto primitive = [&](double z) { return r * r * r * r * z - 2 * r * r * z * z * z / 3 + std::pow(z, 5) / 5; };
    const double about = pi * (primitive(d / 2) - primitive(-r));
    const Vec3 u = axis.normalized();
    CHECK(u.dot(two.inertia * u) == Approx(about).epsilon(1e-10));
  }
  // apart: sums, by Huygens and Steiner
  const MassProperties far = union_mass_properties(std::vector<PlacedBall>{{{0, 0, 0}, 1}, {{3, 0, 0}, 0.5}});
  const double m1 = 4 * pi / 3, m2 = m1 / 8;
  CHECK(far.mass == Approx(m1 + m2).epsilon(1e-11));
  CHECK(far.centre.x() == Approx(3 * m2 / (m1 + m2)).epsilon(1e-11));
  CHECK(far.inertia(1, 1) == Approx(0.4 * m1 + 0.4 * m2 * 0.25 + m1 * m2 / (m1 + m2) * 9).epsilon(1e-11));
}

TEST_CASE("many balls at once agree with counting points", "[physics][clump]") {
  std::vector<PlacedBall> balls;
  Random random(5, 0);
  for (int k = 0; k < 7; ++k)
    balls.push_back({Vec3(random.uniform(), random.uniform(), random.uniform()), random.uniform(0.2, 0.6)});
  const MassProperties exact = union_mass_properties(balls);
  const int n = 160;  // points per edge of a box of edge 2.4: 4.1 million
  double count = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (int i = 0; i < n * n * n; ++i) {
    const Vec3 x = Vec3(i % n + 0.5, i / n % n + 0.5, i / n / n + 0.5) * (2.4 / n) - Vec3::Constant(0.7);
    bool in = false;
    for (const PlacedBall& b : balls) in = in || (x - b.centre).squaredNorm() < b.radius * b.radius;
    if (in) {
      count += 1;
      first += x;
      second += x * x.transpose();
    }
  }
  const double cell = std::pow(2.4 / n, 3);
  const Vec3 centre = first / count;
  const Mat3 about = cell * second - cell * count * centre * centre.transpose();
  CHECK(cell * count == Approx(exact.mass).epsilon(2e-4));  // surface cells by chance: some 1e-2 / sqrt(1e5)
  CHECK((centre - exact.centre).norm() < 2e-4);
  CHECK((about.trace() * Mat3::Identity() - about - exact.inertia).norm() < 1e-3 * exact.inertia.norm());
}

TEST_CASE("a clump of one ball is the ball", "[physics][clump]") {
  const auto fly = [](const std::string& shape) {
    auto run = start_text(
        head + "[[body]]\nname = \"a\"\nshape = " + shape +
        "\nmaterial = \"m\"\nposition = [0, 0.004, 0]\nvelocity = [3, 1, 0]\n" +
        "[[body]]\nname = \"b\"\nshape = { sphere = { radius = 0.01 } }\nmaterial = \"m\"\nposition = [0.021, 0, 0]\n" +
        "[[body]]\nname = \"w\"\nfixed = true\nshape = { half_space = { normal = [-1, 0, 0] } }\nmaterial = "
        "\"m\"\nposition = [0.04, 0, 0]\n");
    run.advance_to(6000);
    const World& w = run.simulation().world;
    std::vector<double> out;
    for (Slot s : {w.slot_of(Assembly::body_id(0)), w.slot_of(Assembly::body_id(1))})
      for (int k = 0; k < 3; ++k) {
        out.push_back(w.velocity[s][k]);
        out.push_back(0.01 * w.angular_velocity[s][k]);
      }
    return out;
  };
  const auto ball = fly("{ sphere = { radius = 0.01 } }");
  CHECK(ball[0] < 2.9);
  const auto clump = fly("{ clump = { spheres = [[0, 0, 0, 0.01]] } }");
  const auto given =
      fly("{ clump = { spheres = [[0, 0, 0, 0.01]], mass = 8.377580409572781e-3, inertia = [3.351032163829113e-7, "
          "3.351032163829113e-7, 3.351032163829113e-7] } }");
  CHECK(clump == ball);  // to the last bit
  for (std::size_t k = 0; k < ball.size(); ++k) {
    CHECK(given[k] == Approx(ball[k]).margin(1e-9));
  }
}

TEST_CASE("clumps keep energy and momentum, also against walls of every kind", "[physics][clump]") {
  const std::string trio =
      "shape.trio = { clump = { spheres = [[0, 0, 0, 0.01], [0.012, 0, 0, 0.008], [0, 0.01, 0.004, 0.007]] } }\n";
  auto run = start_text(head + trio + R"(
[[body]]
name = "a"
shape = "trio"
material = "m"
velocity = [2, 0.3, 0]
angular_velocity = [30, 40, -20]
[[body]]
name = "b"
shape = "trio"
material = "m"
position = [0.04, 0.002, 0.001]
euler_deg = [20, 50, 80]
)");
  World& w = run.simulation().world;
  const auto spin = [&] {
    Vec3 l = Vec3::Zero();
    for (Slot s = 0; s < w.size(); ++s)
      l += w.angular_momentum[s] + w.position[s].cross(w.velocity[s]) / w.inverse_mass[s];
    return l;
  };
  const Vec3 p = linear_momentum(w), l = spin();
  run.advance_to(8000);
  CHECK(linear_momentum(w)[0] == Approx(p[0]).epsilon(1e-12));
  CHECK((spin() - l).norm() < 1e-9 * l.norm());
  CHECK(std::abs(w.velocity[w.slot_of(Assembly::body_id(1))].x()) > 0.1);
  CHECK(std::abs(run.energy_error()) < 1e-5);
  // a plane, a box and a mesh turn a clump back alike
  const TemporaryFolder folder;
  const std::string file = (folder / "wall.obj").string();
  std::ofstream(file) << "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n";
  Vec3 plain = Vec3::Zero();
  const std::vector<std::string> walls{"{ half_space = { normal = [0, 0, 1] } }",
                                       "{ box = { size = [2, 2, 0.2] } }\nposition = [0, 0, -0.1]",
                                       "{ mesh = { file = \"" + file + "\" } }"};
  for (const std::string& wall : walls) {
    auto fall = start_text(head + trio + "[[body]]\nname = \"w\"\nfixed = true\nmaterial = \"m\"\nshape = " + wall +
                           "\n[[body]]\nname = \"a\"\nshape = \"trio\"\nmaterial = \"m\"\nposition = [0.1, 0.2, "
                           "0.02]\nvelocity = [1, 0, -3]\n"
                           "angular_velocity = [10, -20, 5]\n");
    fall.advance_to(4000);
    const World& v = fall.simulation().world;
    const Vec3 out = v.velocity[v.slot_of(Assembly::body_id(1))];
    CHECK(out.z() > 0);
    if (plain.isZero(0.0)) plain = out;
    INFO(wall);
    CHECK((out - plain).norm() < 1e-9);
  }
}

TEST_CASE("a clump rolls and tips as its mass says", "[physics][clump]") {
  // dumbbell on two equal balls, given a heavy off-centre mass: at rest its two supports share the weight by levers
  auto run = start_text(R"(title = "d"
run = { duration = 2.0, time_step = 2e-5, output_interval = 0.1 }
world = { gravity = [0, 0, -10] }
material.m = { density = 2000.0, youngs_modulus = "100 MPa", poissons_ratio = 0.25 }
contact = { method = "smooth", restitution = 0.1, friction = 0.3, smooth = { law = "hertz-mindlin" } }
[[body]]
name = "left"
shape = { box = { size = [0.04, 0.2, 0.02] } }
position = [0, 0, -0.01]
material = "m"
fixed = true
[[body]]
name = "right"
shape = { box = { size = [0.04, 0.2, 0.02] } }
position = [0.1, 0, -0.01]
material = "m"
fixed = true
[[body]]
name = "bar"
material = "m"
position = [0.025, 0, 0.01]
[body.shape.clump]
spheres = [[0, 0, 0, 0.01], [0.1, 0, 0, 0.01]]
mass = 0.4
inertia = [1e-4, 5e-4, 5e-4]
centre = [0.025, 0, 0]
)" + contact_measure("l", "left", "bar") +
                        contact_measure("r", "right", "bar"));
  run.advance_to(0);
  CHECK(run.last("l", "normal_force") == Approx(3.0).epsilon(1e-3));
  CHECK(run.last("r", "normal_force") == Approx(1.0).epsilon(1e-3));
}
