// Periodic cells: an image is as good as the body; the cell's own deformation and what it costs in work.
#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "engine/state/state_snapshot.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

const std::string materials = R"(title = "p"
material.m = { density = 1000.0, youngs_modulus = "10 MPa", poissons_ratio = 0.25 }
)";

std::string vec(const Vec3& x) {
  char text[120];
  std::snprintf(text, sizeof text, "[%.17g, %.17g, %.17g]", x.x(), x.y(), x.z());
  return text;
}

/// Two bodies meet obliquely about `place`; velocities and spins of both after 20 ms.
std::vector<double> impact(const std::string& method, const std::string& shape, const std::string& cell,
                           const Vec3& place) {
  const std::string world =
      cell.empty() ? "" : "world.domain = { min = [0, 0, 0], max = [1, 1, 1], periodic = " + cell + " }\n";
  auto run = start_text(
      materials + world + "run = { duration = 0.03, time_step = 2e-5, output_interval = 0.01 }\n" +
      "contact = { method = \"" + method + "\", restitution = 0.7, friction = 0.4 }\n" + "shape.s = " + shape + "\n" +
      "[[body]]\nname = \"a\"\nshape = \"s\"\nmaterial = \"m\"\nposition = " + vec(place - Vec3(0.12, 0, 0)) +
      "\nvelocity = [5, 3, 1]\norientation = [0.8, 0.6, 0, 0]\n" +
      "[[body]]\nname = \"b\"\nshape = \"s\"\nmaterial = \"m\"\nposition = " + vec(place + Vec3(0.12, 0.03, 0.01)) +
      "\nvelocity = [-5, 3, 1]\n");
  run.advance_to(1000);
  REQUIRE(run.failure.empty());
  std::vector<double> out;
  const World& w = run.simulation().world;
  for (std::size_t body = 0; body < w.ids_given(); ++body) {
    const Slot s = w.slot_of(Assembly::body_id(body));
    if (w.cell) CHECK((w.position[s].array() > -0.2).all());  // put back when they leave
    for (int k = 0; k < 3; ++k) {
      out.push_back(w.velocity[s][k]);
      out.push_back(w.angular_velocity[s][k]);
    }
  }
  return out;
}

void same(const std::vector<double>& p, const std::vector<double>& q) {
  for (std::size_t k = 0; k < p.size(); ++k) CHECK(p[k] == Approx(q[k]).margin(1e-8));
}

/// Two spheres on a damped spring, and one on a spring to a place in space, fly through the cell; velocities and spins
/// at the end, and the relative error of energy.
std::vector<double> sprung(const std::string& method, const std::string& cell, Random random) {
  const auto draw = [&](double size) {
    return Vec3(size * random.uniform(-1, 1), size * random.uniform(-1, 1), size * random.uniform(-1, 1));
  };
  const Vec3 middle(0.5, 0.5, 0.5), together = draw(40.0);
  const std::string world =
      cell.empty() ? "" : "world.domain = { min = [0, 0, 0], max = [1, 1, 1], periodic = " + cell + " }\n";
  std::string text = materials + world + "run = { duration = 0.05, time_step = 5e-6, output_interval = 0.1 }\n" +
                     "contact = { method = \"" + method + "\", restitution = 0.7, friction = 0.4 }\n" +
                     "shape.s = { sphere = { radius = 0.005 } }\n";
  for (const char* name : {"a", "b", "c"})
    text += fmt::format("[[body]]\nname = \"{}\"\nshape = \"s\"\nmaterial = \"m\"\nposition = {}\nvelocity = {}\n",
                        name, vec(middle + draw(0.3)), vec(together + draw(0.3)));
  text +=
      "[[spring]]\nbody = \"a\"\nto = \"b\"\nattachment = [0.004, 0, 0]\nstiffness = [0.4, 0.2, 0.1]\ndamping = "
      "[0.001, 0, "
      "0]\n[[spring]]\nbody = \"c\"\nstiffness = [0.05, 0.05, 0.05]\n[[measure]]\nkind = \"energy\"\n";
  auto run = start_text(text);
  run.advance_to(10000);
  REQUIRE(run.failure == "");
  std::vector<double> out;
  const World& w = run.simulation().world;
  for (std::size_t body = 0; body < w.ids_given(); ++body) {
    const Slot s = w.slot_of(Assembly::body_id(body));
    CHECK((!w.cell || !w.wraps[s].isZero()));  // put back on its way
    for (const Vec3& x : {Vec3(w.velocity[s]), Vec3(w.angular_velocity[s]), w.unwrapped(s)})
      out.insert(out.end(), x.data(), x.data() + 3);
  }
  out.push_back(run.simulation().ledger.relative_error());
  return out;
}

/// n^3 spheres on a cubic lattice that fills the cell, contacts by linear springs of 1000 N/m.
std::string lattice(int n, double pitch, const std::string& domain, double duration) {
  const std::string size = std::to_string(n * pitch);
  return materials + "run = { duration = " + std::to_string(duration) +
         ", time_step = 1e-4, output_interval = 0.01 }\n" + "world.domain = { min = [0, 0, 0], max = [" + size + ", " +
         size + ", " + size + "], periodic = [\"x\", \"y\", \"z\"], " + domain + " }\n" +
         "contact = { method = \"smooth\", restitution = 1.0, friction = 0.0, smooth = { law = \"linear\", stiffness = "
         "1000.0 } }\n" +
         "[[body]]\nname = \"l\"\nrepeat = [" + std::to_string(n) + ", " + std::to_string(n) + ", " +
         std::to_string(n) + "]\nshape = { sphere = { radius = 0.05 } }\nmaterial = \"m\"\nposition = [\"= (i + 0.5)*" +
         std::to_string(pitch) + "\", \"= (j + 0.5)*" + std::to_string(pitch) + "\", \"= (k + 0.5)*" +
         std::to_string(pitch) + "\"]\n" +
         "[[measure]]\nname = \"s\"\nkind = \"stress\"\n[[measure]]\nname = \"phi\"\nkind = \"solid_fraction\"\n";
}

}  // namespace

TEST_CASE("an impact across the faces of a periodic cell is the impact itself", "[physics][periodic]") {
  const std::string all = "[\"x\", \"y\", \"z\"]";
  for (const std::string method : {"smooth", "nonsmooth"})
    for (const std::string shape : {"{ sphere = { radius = 0.1 } }", "{ capsule = { radius = 0.06, length = 0.1 } }",
                                    "{ box = { size = [0.12, 0.14, 0.16] } }",
                                    "{ clump = { spheres = [[0, 0, 0, 0.08], [0.05, 0, 0, 0.06]] } }"}) {
      INFO(method << " " << shape);
      const auto free = impact(method, shape, "", {0.5, 0.5, 0.5});
      CHECK(std::abs(free[0]) < 4.5);  // they have met
      same(impact(method, shape, all, {0.5, 0.5, 0.5}), free);
      // while they touch both pass the faces of y, then of z: springs and warm starts must go with them
      same(impact(method, shape, all, {0.0, 0.97, 0.99}), free);
      same(impact(method, shape, "[\"x\"]", {0.999, 0.5, 0.5}), free);
    }
}

TEST_CASE("springs pull over the faces of a periodic cell as in open space", "[physics][periodic]") {
  for (const std::string method : {"smooth", "nonsmooth"})
    for (std::uint64_t draw = 0; draw < 6; ++draw) {
      INFO(method << " draw " << draw);
      const auto free = sprung(method, "", Random(draw, 7));
      CHECK(std::abs(free.back()) < 1e-2);
      same(sprung(method, "[\"x\", \"y\", \"z\"]", Random(draw, 7)), free);
    }
}

TEST_CASE("a body falls along a periodic axis for ever, its energy with it", "[physics][periodic]") {
  auto run = start_text(materials + R"(run = { duration = 1.0, time_step = 1e-3, output_interval = 0.1 }
world = { gravity = [3, 0, -10], domain = { min = [0, 0, 0], max = [1, 1, 1], periodic = ["x", "z"] } }
contact = { method = "smooth", restitution = 0.5, friction = 0.0, smooth = { law = "hertz" } }
[[body]]
name = "ball"
repeat = 2
shape = { sphere = { radius = 0.05 } }
material = "m"
position = ["= 0.3 + 0.4*i", 0.5, 0.5]
[[measure]]
name = "way"
kind = "position"
body = "ball[0]"
[[measure]]
name = "drift"
kind = "drift"
body = "ball[1]"
[[measure]]
name = "flow"
kind = "mass_flow"
plane = { point = [0, 0, 0.25], normal = [0, 0, -1] }
interval = 0.01
)");
  run.advance_to(0);
  CHECK(run.last("way", "z") == Approx(0.5 - 5.0).epsilon(1e-9));  // five cells down
  CHECK(run.last("way", "x") == Approx(0.3 + 1.5).epsilon(1e-9));
  CHECK(run.last("drift", "distance") == Approx(0.0).margin(1e-9));  // across gravity
  CHECK(run.last("flow", "mass") == Approx(2 * 5 * 4.0 / 3 * 3.14159265358979 * 1.25e-4 * 1000));
  CHECK(std::abs(run.energy_error()) < 1e-12);
  CHECK(run.simulation().world.position[0].z() > -0.1);
}

TEST_CASE("an inclined plane in a periodic cell counts every lap", "[physics][periodic]") {
  // a path passes the plane and its images once for each lap along the axes that the normal points along
  Random random(7, 0);
  for (int k = 0; k < 20; ++k) {
    const Vec3 size(random.uniform(0.5, 2), random.uniform(0.5, 2), random.uniform(0.5, 2));
    Vec3 normal(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)), laps;
    for (int a = 0; a < 3; ++a) laps[a] = std::floor(random.uniform(-3, 4));
    const auto triple = [](const Vec3& v) { return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z()); };
    auto run = start_text(materials + R"(run = { duration = 1.0, time_step = 1e-2, output_interval = 0.1 }
contact = { method = "smooth", restitution = 0.5, friction = 0.0, smooth = { law = "hertz" } }
world = { domain = { min = [0, 0, 0], max = )" +
                          triple(size) + R"(, periodic = ["x", "y", "z"] } }
[[body]]
name = "ball"
shape = { sphere = { radius = 0.05 } }
material = "m"
position = )" + triple(0.3 * size) +
                          "\nvelocity = " + triple(laps.cwiseProduct(size)) + R"(
[[measure]]
name = "each"
kind = "mass_flow"
plane = { point = )" + triple(0.6 * size) +
                          ", normal = " + triple(normal) + R"( }
[[measure]]
name = "seldom"
kind = "mass_flow"
interval = 0.5
plane = { point = )" + triple(0.6 * size) +
                          ", normal = " + triple(normal) + " }\n");
    run.advance_to(0);
    const double mass = 4.0 / 3 * 3.14159265358979 * 1.25e-4 * 1000;
    double crossings = 0;
    for (int a = 0; a < 3; ++a) crossings += normal[a] > 0 ? laps[a] : -laps[a];
    CHECK(run.last("each", "mass") == Approx(mass * crossings).margin(1e-12));
    CHECK(run.last("seldom", "mass") == Approx(mass * crossings).margin(1e-12));
  }
}

TEST_CASE("a cubic lattice in a straining cell has the stress of its springs and takes the work",
          "[physics][periodic]") {
  // pitch a(t) = 0.1 (1 - 0.05 t), overlap 0.1 - a, p = k (0.1 - a)/a^2; Verlet sees the same lattice at every step
  auto run = start_text(lattice(3, 0.1, "strain_rate = [-0.05, -0.05, -0.05]", 0.2));
  run.advance_to(0);
  const World& w = run.simulation().world;
  const double a = 0.1 * std::pow(1 - 0.05e-4, 2000), overlap = 0.1 - a;
  CHECK(w.cell->size.x() == Approx(3 * a).epsilon(1e-12));
  for (const char* c : {"xx", "yy", "zz", "pressure"})
    CHECK(run.last("s", c) == Approx(1000 * overlap / (a * a)).epsilon(1e-9));
  CHECK(run.last("phi", "fraction") == Approx(4.0 / 3.0 * 3.14159265358979 * 1.25e-4 / (a * a * a)).epsilon(1e-9));
  Energy e = run.simulation().ledger.last();
  CHECK(e.elastic == Approx(81 * 0.5 * 1000 * overlap * overlap).epsilon(1e-9));  // 3 contacts per body
  CHECK(e.dissipated == 0.0);
  CHECK(e.work == Approx(e.elastic).epsilon(1e-4));  // of the trapezoid of the work
  CHECK(kinetic_energy(w) < 1e-15 * e.elastic);      // a lattice moves with the cell
}

TEST_CASE("a cell strains towards its pressure", "[physics][periodic][long]") {
  auto run = start_text(lattice(3, 0.1, "pressure = 500.0, rate_limit = 1.0", 0.9));
  run.advance_to(0);
  const PeriodicCell& cell = *run.simulation().world.cell;
  for (int k = 0; k < 3; ++k) CHECK(cell.stress()[k] == Approx(500.0).epsilon(1e-6));
  // k (0.1 - a) = 500 a^2; at 1/s the approach has the time constant P/(K rate) = 0.05 s
  const double a = (-1000 + std::sqrt(1e6 + 4 * 500 * 100.0)) / 1000;
  CHECK(cell.size.x() == Approx(3 * a).epsilon(1e-6));
  CHECK(run.last("s", "pressure") == Approx(500.0).epsilon(1e-6));
  CHECK(std::abs(run.energy_error()) < 1e-4);
}

TEST_CASE("the balance of packings that a cell presses closes, however its rate follows", "[physics][periodic]") {
  // forces before a strain and after it act on its way; each with the rate of its own step left 9e-4 to 1.8e-3 open
  Random random(5, 0);
  for (int k = 0; k < 4; ++k) {
    const bool capsules = k % 2 == 1;
    const double d = 0.01, volume = std::numbers::pi / 6.0 * d * d * d * (capsules ? 1.675 : 1.0);
    const double edge = std::cbrt(40.0 * volume / (capsules ? 0.1 : 0.2));
    auto run = start_text(fmt::format(
        R"(run = {{ duration = 1.0, time_step = 4e-5, output_interval = 10.0 }}
[world.domain]
min = [0, 0, 0]
max = [{0}, {0}, {0}]
periodic = ["x", "y", "z"]
pressure = {1}
rate_limit = 1.0
[material.a]
density = 2500.0
[contact]
method = "smooth"
restitution = {2}
friction = {3}
smooth = {{ law = "linear", stiffness = 1000.0 }}
[shape.s]
{4}
[[fill]]
name = "g"
shape = "s"
material = "a"
count = 40
method = "random"
velocity_deviation = 0.02
region = {{ box = {{ min = [0, 0, 0], max = [{0}, {0}, {0}] }} }}
)",
        edge, std::pow(10.0, random.uniform(2.5, 3.2)), random.uniform(0.3, 0.6), random.uniform(0.2, 1.0),
        capsules ? "capsule = { radius = 0.005, length = 0.0045 }" : "sphere = { radius = 0.005 }"));
    run.advance_to(0);
    CHECK(run.failure.empty());
    CHECK(std::abs(run.energy_error()) < 2e-4);
  }
}

TEST_CASE("a shaken periodic gas: any broad phase, any restart, momentum kept", "[physics][periodic]") {
  const auto scene = [](const std::string& broad) {
    return materials + "detection = { broad_phase = \"" + broad + "\" }\n" + R"(
run = { duration = 0.2, time_step = 1e-4, output_interval = 0.1, seed = 3 }
world.domain = { min = [0, 0, 0], max = [0.4, 0.4, 0.4], periodic = ["x", "y", "z"] }
contact = { method = "smooth", restitution = 1.0, friction = 0.5, smooth = { law = "hertz-mindlin" } }
[[fill]]
name = "fast"
shape = "ball"
material = "m"
count = 60
velocity = [3, 1, 2]
region = { box = { min = [0, 0, 0], max = [0.4, 0.4, 0.2] } }
[[fill]]
name = "slow"
shape = "ball"
material = "m"
count = 60
velocity = [-3, -1, -2]
region = { box = { min = [0, 0, 0.2], max = [0.4, 0.4, 0.4] } }
[shape.ball]
sphere = { radius = 0.02 }
)";
  };
  auto run = start_text(scene("spatial-hash"));
  run.advance_to(1000);
  StateSnapshot half;
  half.save([&](StateVisitor& v) { run.simulation().visit(v); });
  run.advance_to(2000);
  CHECK(linear_momentum(run.simulation().world).norm() < 1e-12);
  CHECK(run.simulation().ledger.last().losses.frictional > 0.01 * kinetic_energy(run.simulation().world));  // they met
  auto again = start_text(scene("spatial-hash"));
  half.restore([&](StateVisitor& v) { again.simulation().visit(v); });
  again.advance_to(2000);
  CHECK(again.hash() == run.hash());
  for (const std::string broad : {"all-pairs", "aabb-tree", "sweep-and-prune"}) {
    auto other = start_text(scene(broad));
    other.advance_to(2000);
    INFO(broad);
    CHECK(other.hash() == run.hash());
  }
}

TEST_CASE("a periodic cell refuses what cannot repeat in it", "[physics][periodic]") {
  const auto text = [](const std::string& domain, const std::string& more) {
    return materials + "run = { duration = 1.0, output_interval = 0.1 }\n" +
           "world.domain = { min = [0, 0, 0], max = [1, 1, 1], " + domain +
           " }\ncontact = { method = \"smooth\", restitution = 0.5, friction = 0.0, smooth = { law = \"hertz\" } }\n" +
           "[[body]]\nname = \"ball\"\nshape = { sphere = { radius = 0.1 } }\nmaterial = \"m\"\nposition = [0.5, 0.5, "
           "0.5]\n" +
           more;
  };
  const auto refusal = [&](const std::string& domain, const std::string& more) -> std::string {
    try {
      start_text(text(domain, more));
    } catch (const SceneError& e) {
      return e.what();
    }
    return "";
  };
  const std::string wall =
      "[[body]]\nname = \"wall\"\nfixed = true\nmaterial = \"m\"\nshape = { half_space = { normal = [1, 0, 0] } }\n";
  CHECK_THAT(refusal("periodic = [\"x\"]", wall), Catch::Contains("faces along x"));
  CHECK(refusal("periodic = [\"y\"]", wall).empty());
  CHECK_THAT(refusal("strain_rate = [0, 0, 1]", ""), Catch::Contains("only a periodic domain deforms"));
  CHECK_THAT(refusal("periodic = [\"x\"], strain_rate = [0, 0, 1]", ""), Catch::Contains("not periodic along z"));
  CHECK_THAT(refusal("periodic = [\"x\"], pressure = 1.0", ""), Catch::Contains("pressure needs periodic"));
  CHECK_THAT(refusal("periodic = [\"x\"]",
                     "[[body]]\nname = \"big\"\nmaterial = \"m\"\nshape = { sphere = { radius = 0.3 } }\nposition = "
                     "[0, 0, 0.9]\n"),
             Catch::Contains("less than two diameters of the largest free body ('big', 0.6 m across)") &&
                 Catch::Contains("make the domain 1.2 m wide or more"));
}

TEST_CASE("tiles carry bodies wherever their motion or the scene puts them among the cells", "[physics][periodic]") {
  // images reach one cell: driven tiles that had gone farther carried nothing
  Random random(8, 0);
  const std::string shapes[] = {
      "sphere = { radius = 0.06 }", "box = { size = [0.1, 0.1, 0.12] }",
      "clump = { spheres = [[0.04, 0, 0, 0.06], [-0.03, 0.04, 0, 0.06], [0, -0.05, 0, 0.06]] }"};
  for (int draw = 0; draw < 24; ++draw) {
    const bool driven = draw % 4 != 3;
    const Vec3 speed(random.uniform(1.0, 3.0), random.uniform(-3.0, -1.0), 0), way(4, -3, 0);
    const Vec3 tiles = driven ? speed : Vec3(Vec3::Zero()), off = driven ? Vec3(Vec3::Zero()) : way;
    const Vec3 own = tiles + Vec3(random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 0);
    std::string text = materials + "world.domain = { min = [0, 0, -1], max = [1, 1, 2], periodic = [\"x\", \"y\"] }\n" +
                       "world.gravity = [0, 0, -9.81]\nrun = { duration = 1.5, time_step = 5e-5 }\n" +
                       "contact = { method = \"" + (draw % 2 == 0 ? "nonsmooth" : "smooth") +
                       "\", restitution = 0, friction = 0 }\n[[body]]\nname = \"b\"\n" +
                       "material = \"m\"\nshape = { " + shapes[draw / 4 % 3] +
                       " }\nposition = [0.4, 0.7, 0.06]\nvelocity = " + vec(own) + "\n";
    const double x = random.uniform(0.3, 0.7), y = random.uniform(0.3, 0.7);
    const std::string steady = "motion = { velocity = " + vec(tiles) + " }\n";
    const std::string table = fmt::format(
        "motion = {{ of = \"velocity\", table = [[0, {0:.17g}, {1:.17g}, 0], [2, {0:.17g}, {1:.17g}, 0]] }}\n",
        tiles.x(), tiles.y());
    const std::string motion = !driven ? "fixed = true\n" : draw % 4 == 1 ? table : steady;
    for (int k = 0; k < 4; ++k) {
      const Vec3 low(k % 2 * x, k / 2 * y, -0.1), high(k % 2 == 0 ? x : 1.0, k / 2 == 0 ? y : 1.0, 0.0);
      text += "[[body]]\nmaterial = \"m\"\nshape = { box = { size = " + vec(high - low) +
              " } }\nposition = " + vec(0.5 * (low + high) + off) + "\n" + motion;
    }
    auto run = start_text(text);
    run.advance_to(0);
    const World& world = run.simulation().world;
    const Slot body = world.slot_of(Assembly::body_id(0));
    INFO("draw " << draw << ", velocity " << world.velocity[body].transpose() << ", written " << own.transpose());
    CHECK((world.velocity[body] - own).norm() < 1e-4);
    CHECK(world.position[body].z() == Approx(0.06).margin(1e-3));
  }
}

TEST_CASE("floors hold wherever their own point lies, standing or driven along", "[physics][periodic]") {
  // planes and meshes whose point lies cells away, and planes that are put back on their way
  Random random(9, 0);
  const std::string folder = "/tmp/epafi_periodic_" + std::to_string(getpid());
  for (int draw = 0; draw < 12; ++draw) {
    const Vec3 low(random.uniform(-40, 40), random.uniform(-40, 40), -1.0);
    const Vec3 point(random.uniform(-60, 60), random.uniform(-60, 60), 0.0);
    const bool is_mesh = draw % 3 == 0, is_driven = draw % 3 == 1;
    const std::string method = draw % 2 == 0 ? "smooth" : "nonsmooth", file = folder + ".obj";
    std::ofstream out(file);
    for (const double x : {-3.0, 5.0})
      for (const double y : {-3.0, 5.0}) out << fmt::format("v {:.17g} {:.17g} 0\n", low.x() + x, low.y() + y);
    out << "f 1 3 4\nf 1 4 2\n";
    out.close();
    INFO("draw " << draw << " " << method);
    auto run = start_text(
        materials + "run = { duration = 0.4, time_step = 2e-4, output_interval = 0.1 }\n" +
        "world = { gravity = [0, 0, -9.81], domain = { min = " + vec(low) + ", max = " + vec(low + Vec3(2, 2.4, 3)) +
        ", periodic = [\"x\", \"y\"] } }\n" + "contact = { method = \"" + method +
        "\", restitution = 0.3, friction = " + (is_driven ? "0.0" : "0.3") +
        " }\n[[body]]\nname = \"floor\"\nmaterial = \"m\"\nshape = " +
        (is_mesh ? "{ mesh = { file = \"" + file + "\" } }\n"
                 : std::string("{ half_space = { normal = [0, 0, 1] } }\nposition = ") + vec(point) + "\n") +
        (is_driven ? "motion = { velocity = [30.0, 0, 0] }\n" : "fixed = true\n") +
        "[[body]]\nname = \"ball\"\nshape = { sphere = { radius = 0.1 } }\nmaterial = \"m\"\nposition = " +
        vec(low + Vec3(random.uniform(0, 2), random.uniform(0, 2.4), 1.1)) + "\n");
    run.advance_to(2000);
    REQUIRE(run.failure.empty());
    const World& w = run.simulation().world;
    const Slot ball = w.slot_of(Assembly::body_id(1));
    REQUIRE(ball < w.size());
    CHECK(w.position[ball].z() == Approx(0.1).margin(1e-3));
    if (!is_driven) CHECK(w.angular_velocity[ball].norm() < 1e-6);  // a wrong image is a wrong lever
  }
}
