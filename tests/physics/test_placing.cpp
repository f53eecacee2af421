// Bodies stand where their scene puts them: as written whatever else moves, out of what is there already, in their
// cell.
#include <fmt/format.h>

#include <cmath>

#include "engine/state/periodic_cell.h"
#include "engine/units/random.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"
#include "viz_export/measures/measure.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

const std::string placing_head = R"(run = { duration = 0.2, time_step = 1e-4 }
material.m = { density = 1000.0, youngs_modulus = "1 MPa", poissons_ratio = 0.25 }
contact = { method = "smooth", restitution = 0.5, friction = 0.3 }
)";

std::string triple(const Vec3& v) { return fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x(), v.y(), v.z()); }

Vec3 random_vector(Random& random, double low, double high) {
  Vec3 v;
  for (int k = 0; k < 3; ++k) v[k] = random.uniform(low, high);
  return v;
}

Quat random_turn(Random& random) {
  return Quat(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized();
}

/// Corners with a radius, in the author's axes: the box around them is that of a hull or of a union of balls.
struct Drawn {
  std::string shape;
  std::vector<Vec3> points;
  double radius = 0.0;
  bool may_move = true;
};

std::vector<Drawn> drawn_shapes(Random& random) {
  Drawn hull, clump, box{"", {}, 0.0}, capsule{"", {}, 0.3};
  const Vec3 offset = random_vector(random, -1, 1), size = random_vector(random, 0.2, 1.0);
  hull.shape = "{ polyhedron = { vertices = [";
  clump.shape = "{ clump = { spheres = [";
  for (int k = 0; k < 9; ++k) {
    hull.points.push_back(offset + random_vector(random, -1, 1).cwiseProduct(Vec3(1, 0.6, 0.3)));
    hull.shape += (k > 0 ? ", " : "") + triple(hull.points.back());
  }
  clump.radius = 0.2;
  for (int k = 0; k < 3; ++k) {
    clump.points.push_back(offset + random_vector(random, -0.3, 0.3));
    const Vec3& c = clump.points.back();
    clump.shape += fmt::format("{}[{:.17g}, {:.17g}, {:.17g}, 0.2]", k > 0 ? ", " : "", c.x(), c.y(), c.z());
  }
  hull.shape += "] } }";
  clump.shape += "] } }";
  box.shape = "{ box = { size = " + triple(size) + " } }";
  for (int k = 0; k < 8; ++k)
    box.points.emplace_back(0.5 * Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1).cwiseProduct(size));
  capsule.shape = "{ capsule = { radius = 0.3, length = 0.8 } }";
  capsule.points = {Vec3(0, 0, -0.4), Vec3(0, 0, 0.4)};
  return {hull, clump, box, capsule};
}

Aabb box_of(const Drawn& d, const Vec3& at, const Quat& turn) {
  Aabb box{Vec3::Constant(infinity), Vec3::Constant(-infinity)};
  for (const Vec3& p : d.points) {
    const Vec3 x = at + turn * p;
    box.min = box.min.cwiseMin(Vec3(x.array() - d.radius));
    box.max = box.max.cwiseMax(Vec3(x.array() + d.radius));
  }
  return box;
}

}  // namespace

TEST_CASE("a body stands as it is written, held or free, whatever else moves", "[physics][placing]") {
  const char* const held[] = {"fixed = true", "motion = { velocity = [0, 0, 1] }", ""};
  const char* const others[] = {
      "",
      "[[body]]\nname = \"ball\"\nshape = { sphere = { radius = 0.1 } }\nmaterial = \"m\"\nposition = [50, 0, 0]\n"};
  int seen = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    Random random(62, seed);
    for (const Drawn& d : drawn_shapes(random))
      for (const std::string hold : held)
        for (const std::string other : others) {
          const Vec3 at = random_vector(random, -5, 5);
          const bool turned = random.uniform(0, 1) < 0.5;
          const Quat q = turned ? random_turn(random) : Quat(1, 0, 0, 0);
          const std::string body =
              "[[body]]\nname = \"b\"\nmaterial = \"m\"\nshape = " + d.shape + "\n" + hold +
              "\nposition = " + triple(at) +
              (turned ? fmt::format("\norientation = [{:.17g}, {:.17g}, {:.17g}, {:.17g}]", q.w(), q.x(), q.y(), q.z())
                      : "") +
              "\n";
          INFO(body);
          auto drawn = start_text(placing_head + body + "place = \"as-drawn\"\n" + other);
          auto centred = start_text(placing_head + body + other);
          const World &w = drawn.simulation().world, &v = centred.simulation().world;
          const Slot s = w.slot_of(Assembly::body_id(0)), t = v.slot_of(Assembly::body_id(0));
          const Aabb there = drawn.assembly->shapes->bounding_box(w, s), right = box_of(d, at, q);
          CHECK((there.min - right.min).norm() + (there.max - right.max).norm() < 1e-12);
          const Aabb beside = centred.assembly->shapes->bounding_box(v, t);  // the same, moved
          CHECK(v.position[t] == at);
          CHECK((beside.extent() - right.extent()).norm() < 1e-12);
          CHECK((beside.centre() - right.centre() - (at - w.position[s])).norm() < 1e-12);
          ++seen;
        }
  }
  CHECK(seen == 8 * 4 * 3 * 2);
}

namespace {

/// Something that does not move, for bodies to be placed around.
std::string obstacle(Random& random, int kind) {
  const char* const shapes[] = {"{ box = { size = [0.5, 0.3, 0.4] } }",
                                "{ cylinder = { radius = 0.2, length = 0.7 } }",
                                "{ clump = { spheres = [[0, 0, 0, 0.2], [0.2, 0.1, 0, 0.2]] } }",
                                "{ half_space = { normal = [0.1, 0.2, 1] } }",
                                "{ sphere = { radius = 0.3 } }",
                                "{ polyhedron = { random = { vertices = 12, seed = 5 } } }"};
  const Quat q = random_turn(random);
  const Vec3 at = kind == 3 ? Vec3(0.5, 0.5, 0.1) : random_vector(random, 0.2, 0.8);
  std::string out = "[[body]]\nmaterial = \"m\"\nshape = " + std::string(shapes[kind]) + "\nposition = " + triple(at);
  if (kind != 3) out += fmt::format("\norientation = [{:.17g}, {:.17g}, {:.17g}, {:.17g}]", q.w(), q.x(), q.y(), q.z());
  return out + (random.uniform(0, 1) < 0.5 ? "\nfixed = true\n" : "\nmotion = { velocity = [0, 0, 1e-9] }\n");
}

std::string filling(const std::string& name, const std::string& shape, const std::string& method, int count) {
  return "[shape.of_" + name + "]\n" + shape + "\n[[fill]]\nname = \"" + name + "\"\nmaterial = \"m\"\nshape = \"of_" +
         name + "\"\ncount = " + std::to_string(count) + "\n" + method +
         "\nregion = { box = { min = [0, 0, 0], max = [1, 1, 1] } }\n";
}

/// Deepest contact of the present state [m].
double deepest(SceneRun& run) {
  Simulation& sim = run.simulation();
  const ContactPieces contacts(sim.world, sim.work.contacts, sim.pipeline.contact_model.get());
  return measure_overlap(sim.world, contacts, *run.assembly->shapes).max;
}

}  // namespace

TEST_CASE("fills keep out of held bodies, other fills and images", "[physics][placing][fill]") {
  const std::string grain[] = {"sphere = { radius = 0.03 }", "box = { size = [0.05, 0.04, 0.06] }",
                               "clump = { spheres = [[0, 0, 0, 0.02], [0.02, 0, 0, 0.02]] }"};
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    Random random(15, seed);
    const bool periodic = seed % 3 == 0;
    // with images: a cell smaller than the region, so that bodies at its ends would meet
    std::string scene = placing_head;
    if (periodic) scene += "[world]\ndomain = { min = [0, 0, -9], max = [0.9, 0.9, 9], periodic = [\"x\", \"y\"] }\n";
    for (int k = 0; k < 2; ++k) {
      const auto kind = static_cast<int>((seed + 3 * static_cast<unsigned>(k)) % 6);
      if (!(periodic && kind == 3)) scene += obstacle(random, kind);
    }
    scene += filling("first", grain[seed % 3], seed % 2 ? "method = \"lattice\"" : "method = \"random\"", 40);
    scene +=
        filling("second", grain[(seed + 1) % 3], seed % 4 < 2 ? "method = \"random\"" : "method = \"lattice\"", 40);
    INFO(scene);
    auto run = start_text(scene);
    CHECK(deepest(run) < 1e-9);
    CHECK(run.simulation().world.size() >= 80);
  }
}

TEST_CASE("what is poured comes in where no wall is", "[physics][placing][fill]") {
  for (int kind = 0; kind < 6; ++kind) {
    Random random(16, static_cast<std::uint64_t>(kind));
    const std::string wall = obstacle(random, kind);
    INFO(wall);
    auto run = start_text(placing_head + wall +
                          filling("p", "box = { size = [0.05, 0.04, 0.06] }", "method = \"pour\"\nrate = 1e4", 60));
    run.advance_to(100);  // without gravity they stay where they came
    CHECK(run.simulation().world.size() == 61);
    CHECK(deepest(run) < 1e-9);
  }
}

TEST_CASE("a place is put inside its cell, wherever it was", "[physics][placing][periodic]") {
  PeriodicCell cell;
  cell.repeats = {true, false, true};
  Random random(3, 0);
  for (int k = 0; k < 2000; ++k) {
    cell.low = random_vector(random, -3, 3);
    cell.size = random_vector(random, 0.1, 3);
    const Vec3 x = random_vector(random, -20, 20), y = cell.inside(x);
    for (const int axis : {0, 2}) {
      CHECK((y[axis] >= cell.low[axis] && y[axis] < cell.low[axis] + cell.size[axis]));
      const double laps = (x[axis] - y[axis]) / cell.size[axis];
      CHECK(std::abs(laps - std::round(laps)) < 1e-12 * 400);
    }
    CHECK(y.y() == x.y());
  }
  cell.low = Vec3::Zero();
  cell.size = Vec3::Constant(1);
  CHECK(cell.inside(Vec3(-1e-20, 0, 1)) == Vec3(0, 0, 0));  // -1e-20 + 1 is the far face
}

TEST_CASE("amounts beyond the memory are refused before they take any", "[physics][placing][fill]") {
  const std::string big = "region = { box = { min = [0, 0, 0], max = [1e5, 1e5, 1e5] } }\n";
  for (const char* amount : {"count = 1000000000000", "mass = 1e14", "until = \"full\""})
    for (const char* method : {"lattice", "random"}) {
      const std::string fill =
          std::string(
              "shape.g.sphere.radius = 0.01\n[[fill]]\nname = \"sand\"\nmaterial = \"m\"\nshape = \"g\"\nmethod = \"") +
          method + "\"\n" + amount + "\n" + big;
      CHECK_THROWS_WITH(start_text(placing_head + fill),
                        Catch::Contains("[[fill]] 'sand'") && Catch::Contains("GB are there"));
    }
}

TEST_CASE("bodies outside the domain are reported before they are removed", "[physics][placing]") {
  const std::string body =
      "[[body]]\nname = \"b\"\nshape = { sphere = { radius = 0.1 } }\nmaterial = \"m\"\nposition = [0, 0, 3]\n";
  const auto domain = [](const char* outside) {
    return std::string("world.domain = { min = [-1, -1, -1], max = [1, 1, 1], outside = \"") + outside + "\" }\n";
  };
  CHECK_THROWS_WITH(start_text(placing_head + domain("error") + body), Catch::Contains("1 of 1 bodies stand outside"));
  auto run = start_text(placing_head + domain("delete") + body);
  REQUIRE(run.assembly->warnings.size() == 1);
  CHECK_THAT(run.simulation().warnings.all().at(0).text, Catch::Contains("1 of 1 bodies stand outside"));
}
