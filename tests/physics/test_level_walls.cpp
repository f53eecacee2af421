// Capsules, superquadrics and ellipsoids that slide over seams of level walls, and come to rest there, are carried as
// by one plate: with as many points, as deep, and with a ledger that closes, whatever the floor is made of.
#include <fmt/format.h>

#include <fstream>

#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"
#include "tests/support/scene_run.h"

using namespace epafi;

namespace {

constexpr double stiffness = 1e5, wide = 1.0, thick = 0.04;
constexpr std::uint64_t passed_by = 4000, looked_at_every = 20;

enum class Floor { plate, boxes, driven, four, polyhedra, meshes, solid, periodic, kinds };

struct Draw {
  Floor floor = Floor::plate;
  std::string shape;
  double height, x, y, size;  ///< of the body; of its centre from the seams [m]
  double speed, heading;
  Quat lay;
};

/// A prism whose top is at height 0.
std::string write_floor(const std::string& name, std::span<const std::array<double, 2>> outline) {
  const std::string path = fmt::format("{}/level_wall_{}.obj", EPAFI_BINARY_DIR, name);
  std::ofstream out(path);
  for (const double z : {0.0, -thick})
    for (const auto& [x, y] : outline) out << fmt::format("v {:.17g} {:.17g} {:.17g}\n", x, y, z);
  const std::size_t n = outline.size();
  std::string top = "f", bottom = "f";
  for (std::size_t k = 0; k < n; ++k) {
    top += fmt::format(" {}", k + 1);
    bottom += fmt::format(" {}", 2 * n - k);
    out << fmt::format("f {} {} {} {}\n", k + 1, n + k + 1, n + (k + 1) % n + 1, (k + 1) % n + 1);
  }
  out << top << '\n' << bottom << '\n';
  return path;
}

std::string body_of(const std::string& shape, const Vec3& at, const std::string& more) {
  return fmt::format(
      "[[body]]\nshape = {{ {} }}\nmaterial = \"a\"\nplace = \"as-drawn\"\nposition = [{:.17g}, {:.17g}, "
      "{:.17g}]\n{}\n",
      shape, at.x(), at.y(), at.z(), more);
}

std::string box_of(const std::array<double, 2>& x, const std::array<double, 2>& y, const std::string& more) {
  return body_of(fmt::format("box = {{ size = [{:.17g}, {:.17g}, {}] }}", x[1] - x[0], y[1] - y[0], thick),
                 Vec3(0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1]), -0.5 * thick), more);
}

/// Its seams are at x = 0 and, of some, y = 0.
std::string floor_of(Floor kind) {
  const std::array left = {-wide, 0.0}, right = {0.0, wide}, all = {-wide, wide};
  const std::string fixed = "fixed = true", driven = "motion = { velocity = [0, 0, 0] }";
  switch (kind) {
    case Floor::plate:
      return box_of(all, all, fixed);
    case Floor::boxes:
      return box_of(left, all, fixed) + box_of(right, all, fixed);
    case Floor::driven:
      return box_of(left, all, driven) + box_of(right, all, fixed);
    case Floor::four:
      return box_of(left, left, fixed) + box_of(right, left, fixed) + box_of(left, right, fixed) +
             box_of(right, right, fixed);
    case Floor::polyhedra:
    case Floor::meshes: {
      std::string text;
      for (const auto& [name, x] : {std::pair{"left", left}, {"right", right}}) {
        const std::vector<std::array<double, 2>> outline = {{x[0], -wide}, {x[1], -wide}, {x[1], wide}, {x[0], wide}};
        text += body_of(fmt::format("{} = {{ file = \"{}\" }}", kind == Floor::meshes ? "mesh" : "polyhedron",
                                    write_floor(name, outline)),
                        Vec3::Zero(), fixed);
      }
      return text;
    }
    case Floor::solid: {  // a T, whose parts meet at x = 0
      const double half = 0.5 * wide;
      const std::vector<std::array<double, 2>> outline = {{-wide, -wide}, {0.0, -wide}, {0.0, -half}, {wide, -half},
                                                          {wide, half},   {0.0, half},  {0.0, wide},  {-wide, wide}};
      return body_of("solid = { file = \"" + write_floor("solid", outline) + "\" }", Vec3::Zero(), fixed);
    }
    default:
      return body_of(fmt::format("box = {{ size = [{0}, {0}, {1}] }}", wide, thick),
                     Vec3(0.5 * wide, 0.5 * wide, -0.5 * thick), fixed);
  }
}

std::string scene_of(const Draw& d) {
  const std::string domain = d.floor != Floor::periodic
                                 ? ""
                                 : fmt::format(
                                       "domain = {{ min = [0, 0, -1], max = [{0}, {0}, 1], periodic = [\"x\", "
                                       "\"y\"] }}\n",
                                       wide);
  const std::string more =
      fmt::format("orientation = [{:.17g}, {:.17g}, {:.17g}, {:.17g}]\nvelocity = [{:.17g}, {:.17g}, 0]", d.lay.w(),
                  d.lay.x(), d.lay.y(), d.lay.z(), d.speed * std::cos(d.heading), d.speed * std::sin(d.heading));
  return fmt::format(
             "[run]\nduration = 1\ntime_step = 2e-5\n[world]\ngravity = [0, 0, -9.81]\n{}[material]\na = {{ density = "
             "2500, youngs_modulus = 1e7, poissons_ratio = 0.25 }}\n[contact]\nmethod = \"smooth\"\nrestitution = "
             "0.1\nfriction = 0.3\nsmooth = {{ law = \"linear\", stiffness = {} }}\n",
             domain, stiffness) +
         floor_of(d.floor) + body_of(d.shape, Vec3(d.x, d.y, d.height - 1e-6), more);
}

/// Every third starts exactly over the seam and along it or across it; a third of them stand.
Draw random_draw(Random& random, int number) {
  Draw d;
  d.size = random.uniform(0.02, 0.04);
  const Quat about_z(Eigen::AngleAxisd(number % 3 == 0 ? 0.0 : random.uniform(0, 2 * testing::pi), Vec3::UnitZ()));
  d.lay = about_z;
  d.height = d.size;
  if (number % 4 < 2) {
    const double length = d.size * (number % 4 == 0 ? random.uniform(0.5, 4.0) : random.uniform(0.02, 0.24));
    d.shape = fmt::format("capsule = {{ radius = {:.17g}, length = {:.17g} }}", d.size, length);
    d.lay = about_z * Quat(Eigen::AngleAxisd(0.5 * testing::pi, Vec3::UnitY()));
  } else {
    const double x = random.uniform(1.0, 2.0) * d.size, y = random.uniform(1.0, 2.0) * d.size;
    d.shape = fmt::format("semi_axes = [{:.17g}, {:.17g}, {:.17g}]", x, y, d.size);
    d.shape = number % 4 == 2 ? "ellipsoid = { " + d.shape + " }"
                              : fmt::format("superquadric = {{ {}, across = {}, along = {} }}", d.shape,
                                            2 + 2 * (random.bits() % 4), 2 + 2 * (random.bits() % 4));
  }
  d.x = number % 3 == 0 ? 0.0 : random.uniform(-1, 1) * d.size;
  d.y = number % 3 == 0 ? 0.0 : random.uniform(-1, 1) * d.size;
  d.heading = random.uniform(0, 2 * testing::pi);
  d.speed = random.bits() % 3 == 0 ? 0.0 : random.uniform(0.1, 1.0);
  return d;
}

struct Way {
  std::vector<double> overlaps;     ///< in each step looked at [m]
  std::vector<std::size_t> points;  ///< and of how many
  double weight = 0.0, open = 0.0;  ///< of the body [N]; the ledger at its end
};

Way way_of(const Draw& d) {
  experiments::SceneRun run = experiments::start_text(scene_of(d));
  const Simulation& sim = run.simulation();
  Slot body = 0;
  while (!sim.world.is_movable(body)) ++body;
  Way way;
  way.weight = 9.81 / sim.world.inverse_mass[body];
  for (std::uint64_t n = looked_at_every; n <= passed_by; n += looked_at_every) {
    run.advance_to(n);
    REQUIRE(run.failure.empty());
    way.overlaps.push_back(0.0);
    way.points.push_back(0);
    for (const double gap : sim.work.contacts.gap) {
      way.overlaps.back() -= std::min(gap, 0.0);
      way.points.back() += gap < 0.0;
    }
  }
  way.open = run.energy_error();
  return way;
}

}  // namespace

TEST_CASE("round and smooth bodies are carried over the seams of level walls as by one plate", "[seams][physics]") {
  Random random(701, 1);
  constexpr int kinds = static_cast<int>(Floor::kinds) - 1;
  for (int number = 0; number < 4 * kinds; ++number) {  // each body on each floor
    Draw d = random_draw(random, number);
    const Way plate = way_of(d);
    d.floor = static_cast<Floor>(1 + number % kinds);
    const Way walls = way_of(d);
    double apart = 0.0, most = 0.0;
    for (std::size_t k = 0; k < plate.overlaps.size(); ++k) {
      apart = std::max(apart, std::abs(walls.overlaps[k] - plate.overlaps[k]));
      most = std::max(most, plate.overlaps[k]);
    }
    const double carried = walls.overlaps.back() * stiffness / walls.weight;
    INFO("draw " << number << ", floor " << static_cast<int>(d.floor) << ", " << d.shape << ", speed " << d.speed
                 << ", at " << d.x << ' ' << d.y << ": overlaps differ by " << apart / most << " of the largest, open "
                 << plate.open << ' ' << walls.open << ", weight carried " << carried);
    CHECK(apart < 1e-3 * most);  // up to 0.9 if each pair chooses normals and points for itself
    CHECK(walls.points == plate.points);
    CHECK(std::abs(walls.open) < 1e-6 + 1.5 * std::abs(plate.open));  // up to 0.15 if so
    if (d.speed == 0.0) CHECK(std::abs(carried - 1.0) < 1e-3);        // up to 1.9 if so
  }
}
