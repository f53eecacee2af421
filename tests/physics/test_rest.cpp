// What is set down comes to rest and stays: no trembling, no contacts that come and go, no gap under a resting body.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

constexpr double edge = 0.1;  // of all bodies here, about [m]

/// A file that tests write at the same time: each under a name of its own, renamed when it is whole.
struct OwnFile {
  std::string path, draft;
  explicit OwnFile(const std::string& name)
      : path(EPAFI_BINARY_DIR "/" + name), draft(path + "." + std::to_string(getpid())) {}
  std::string publish() const {
    std::filesystem::rename(draft, path);
    return path;
  }
};

/// A cube as an STL file, the sides of 0.1 m cut into two triangles each.
std::string cube_file() {
  const OwnFile file("rest_cube.stl");
  std::ofstream out(file.draft);
  const auto corner = [](int k) { return Vec3(k & 1 ? 0.05 : -0.05, k & 2 ? 0.05 : -0.05, k & 4 ? 0.05 : -0.05); };
  out << "solid cube\n";
  for (const auto& q : {std::array{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
    for (const auto& t : {std::array{q[0], q[1], q[2]}, {q[0], q[2], q[3]}}) {
      out << "facet normal 0 0 0\nouter loop\n";
      for (const int k : t) out << "vertex " << corner(k).transpose() << "\n";
      out << "endloop\nendfacet\n";
    }
  out << "endsolid cube\n";
  out.close();
  return file.publish();
}

/// A floor of 8 x 8 squares, each two triangles.
std::string floor_file() {
  const OwnFile file("rest_floor.obj");
  std::ofstream out(file.draft);
  for (int i = 0; i <= 8; ++i)
    for (int j = 0; j <= 8; ++j) out << "v " << 0.06 * (i - 4) << " " << 0.06 * (j - 4) << " 0\n";
  for (int i = 0; i < 8; ++i)
    for (int j = 1; j <= 8; ++j) {
      const int a = 9 * i + j, b = a + 9;
      out << "f " << a << " " << b << " " << b + 1 << "\nf " << a << " " << b + 1 << " " << a + 1 << "\n";
    }
  out.close();
  return file.publish();
}

const std::vector<std::pair<std::string, std::string>>& shapes() {
  static const std::vector<std::pair<std::string, std::string>> all{
      {"cube from STL", "{ solid = { file = \"" + cube_file() + "\" } }"},
      {"hull of a cube", "{ polyhedron = { file = \"" + cube_file() + "\" } }"},
      {"box", "{ box = { size = [0.1, 0.1, 0.1] } }"},
      {"cylinder", "{ cylinder = { radius = 0.05, length = 0.1 } }"},
      {"hull of 64 points", "{ polyhedron = { random = { vertices = 64, seed = 3 } }, scale_to_diameter = 0.1 }"},
      {"clump of four",
       "{ clump = { spheres = [[0.03, 0.03, 0, 0.03], [-0.03, 0.03, 0, 0.03], [0.03, -0.03, 0, 0.03], "
       "[-0.03, -0.03, 0, 0.03]] } }"}};
  return all;
}

const std::string rest_head = R"(
world = { gravity = [0, 0, -9.81] }
material.stone = { density = 2500.0, youngs_modulus = "20 MPa", poissons_ratio = 0.3 }
)";
const std::string nonsmooth = R"(
run = { duration = 3.0, time_step = 1e-3, output_interval = 1.0 }
contact = { method = "nonsmooth", restitution = 0.2, friction = 0.5 }
)";
const std::string longer = R"(
run = { duration = 4.0, time_step = 1e-3, output_interval = 1.0 }
contact = { method = "nonsmooth", restitution = 0.2, friction = 0.5 }
)";
/// Without the tangential dashpot 1e-6 of the drop's energy swings on in the friction springs.
const std::string smooth = R"(
run = { duration = 3.0, time_step = 2e-5, output_interval = 1.0 }
[contact]
method = "smooth"
restitution = 0.2
friction = 0.5
smooth = { law = "linear", stiffness = 2e6, tangential = "spring-dashpot", tangential_damping = 0.3 }
)";

std::string body(const std::string& name, const std::string& shape, const std::string& rest) {
  return "[[body]]\nname = \"" + name + "\"\nmaterial = \"stone\"\nshape = " + shape + "\n" + rest + "\n";
}

/// Contacts that carry more than a thousandth of the weight, by name.
std::set<std::tuple<Slot, Slot, Feature>> loaded(const Simulation& sim, double weight) {
  std::set<std::tuple<Slot, Slot, Feature>> out;
  const ContactSet& c = sim.work.contacts;
  for (std::size_t i = 0; i < c.size(); ++i)
    if (c.force[i].norm() > 1e-3 * weight) out.insert({c.a[i], c.b[i], c.feature[i]});
  return out;
}

/// Runs to the end; the last sixth must be rest.
void check_rest(const std::string& method, const std::string& scene, double drop) {
  SceneRun run = start_text(rest_head + method + scene);
  Simulation& sim = run.simulation();
  double weight = 0;
  for (Slot s = 0; s < sim.world.size(); ++s)
    if (sim.world.is_movable(s)) weight += 9.81 / sim.world.inverse_mass[s];
  const std::uint64_t last = run.assembly->steps, from = last / 6 * 5;
  run.advance_to(from);
  REQUIRE(run.failure.empty());
  const auto names = loaded(sim, weight);
  REQUIRE(!names.empty());
  double liveliest = 0, widest = 0;
  bool flickers = false;
  for (std::uint64_t k = from + 1; k <= last; ++k) {
    run.advance_to(k);
    liveliest = std::max(liveliest, kinetic_energy(sim.world));
    flickers = flickers || loaded(sim, weight) != names;
    const ContactSet& c = sim.work.contacts;
    for (std::size_t i = 0; i < c.size(); ++i)
      if (names.count({c.a[i], c.b[i], c.feature[i]})) widest = std::max(widest, std::abs(c.gap[i]));
  }
  CHECK(liveliest < 1e-12 * weight * drop);
  CHECK_FALSE(flickers);
  CHECK(widest < 1e-4 * edge);  // the allowance of the position correction is 1e-4 of the radius
}

void check_pile(const std::string& method, const std::pair<std::string, std::string>& lower,
                const std::pair<std::string, std::string>& top) {
  INFO(top.first << " on " << lower.first << method);
  check_rest(method,
             body("floor", "{ half_space = { normal = [0, 0, 1] } }", "fixed = true") +
                 body("lower", lower.second, "position = [0, 0, 0.06]") +
                 body("a", top.second, "position = [0.003, 0.002, 0.19]\neuler_deg = [3, 2, 10]"),
             0.1);
}

}  // namespace

TEST_CASE("cubes from STL and hulls, cylinders, large hulls and clumps come to rest on a plane and on triangles",
          "[physics][rest][long]") {
  for (const std::string& method : {nonsmooth, smooth})
    for (const auto& [name, shape] : shapes())
      for (const std::string& floor :
           {std::string("{ half_space = { normal = [0, 0, 1] } }"), "{ mesh = { file = \"" + floor_file() + "\" } }"}) {
        INFO(name << " on " << floor << method);
        check_rest(method,
                   body("floor", floor, "fixed = true") +
                       body("a", shape, "position = [0.003, 0.002, 0.07]\neuler_deg = [3, 2, 10]"),
                   0.02);
      }
}

TEST_CASE("they come to rest on each other", "[physics][rest][long]") {
  for (const auto& [lower_name, lower] : shapes())
    for (const auto& top : shapes()) {
      if (lower_name == "hull of 64 points") continue;  // nothing stands on its corners
      const bool rolls_on = lower_name == "clump of four" && top.first == "hull of 64 points";  // for up to 3 s
      check_pile(rolls_on ? longer : nonsmooth, {lower_name, lower}, top);
      if (lower_name != "cylinder") check_pile(smooth, {lower_name, lower}, top);  // below
    }
}

/// A lean of the load once let the deepest point of the rim come and go, and 1e-10 of the drop's energy stayed. What
/// rolls is set on a wider cylinder: from one of its own width it rolls over the edge.
TEST_CASE("they come to rest on a cylinder by smooth contact", "[physics][rest][long]") {
  const std::pair<std::string, std::string> wide{"wide cylinder", "{ cylinder = { radius = 0.08, length = 0.1 } }"};
  for (const auto& top : shapes()) {
    const bool rolls = top.first == "clump of four" || top.first == "hull of 64 points";
    check_pile(smooth, rolls ? wide : shapes()[3], top);
  }
}
