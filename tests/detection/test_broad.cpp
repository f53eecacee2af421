#include <limits>
#include <set>

#include "engine/threads/parallel.h"
#include "tests/detection/broad_scenes.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/support/random_geometry.h"

using namespace epafi;
using namespace epafi::test;

namespace {

void drift(World& world, double dt = 1.0) {
  for (Slot s = 0; s < world.size(); ++s) world.position[s] += dt * world.velocity[s];
  world.time += dt;
}

/// Pairs of spheres closer than reach, by brute force.
PairColumn close_pairs(const BroadScene& scene) {
  BroadScene tight;
  tight.shapes = scene.shapes;
  tight.setup.reach = scene.setup.reach;
  return pairs_by_definition(tight, scene.world);
}

std::vector<std::string> names() {
  std::vector<std::string> out;
  for (const auto& e : all_broad_phases()) out.push_back(e.entry.name);
  return out;
}

}  // namespace

TEST_CASE("every method lists the pairs of the definition, sorted", "[detection][broad]") {
  for (const std::string kind : {"mono", "lognormal", "bimodal", "wide", "clustered", "line"})
    for (const auto& entry : all_broad_phases())
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        INFO(kind << " " << entry.entry.name << " seed " << seed);
        BroadScene scene = random_scene(kind, 700, seed);
        scene.setup.margin = 0.11;
        scene.setup.reach = 0.03;
        const auto broad = entry.make(scene.setup);
        PairList list;
        broad->find_pairs(scene.world, list);
        CHECK(list.pairs == pairs_by_definition(scene, scene.world));
        CHECK(list.pairs.size() > 20);
        CHECK(list.margin == 0.11);
        CHECK(list.generation == 1);
      }
}

TEST_CASE("lengths of 1e-6 to 1e3 m and coordinates of 1e6 m change no list", "[detection][broad][scale]") {
  for (const auto& entry : all_broad_phases())
    for (double unit : {1e-6, 1e-3, 1.0, 1e3})
      for (double shift : {0.0, 1e6}) {
        if (unit < 1e-3 && shift > 0.0) continue;  // an ulp of 1e6 m is 1e-10 m: 1e-4 of such a body
        INFO(entry.entry.name << " unit " << unit << " shift " << shift);
        BroadScene scene = random_scene("lognormal", 400, 9, unit, Vec3(shift, -shift, shift));
        scene.setup.margin = 0.1 * unit;
        const auto broad = entry.make(scene.setup);
        PairList list;
        broad->find_pairs(scene.world, list);
        CHECK(list.pairs == pairs_by_definition(scene, scene.world));
      }
}

TEST_CASE("distances a hair's breadth from the sum of the radii are told apart at any scale",
          "[detection][broad][scale]") {
  for (const double unit : {1e-30, 1.0, 1e30})
    for (const double far : {1.0, 1e4, 1e20}) {  // clusters so far apart, of which one is at the origin
      INFO("unit " << unit << ", clusters " << far << " apart");
      BroadScene scene;
      scene.setup.shapes = &scene.shapes;
      scene.setup.margin = 0.1 * unit;
      Random random(11, 0);
      for (int i = 0; i < 600; ++i) {
        const Vec3 x = random_point(random, 8.0) + far * Vec3(i % 3 == 0, i % 3 == 1, 0.0);
        const double apart = 1.1 * (1.0 + (i % 2 == 0 ? 1e-12 : -1e-12));  // radii and margins: 1.1
        scene.add_sphere(unit * x, 0.5 * unit);
        scene.add_sphere(unit * (x + apart * random_point(random, 1.0).normalized()), 0.5 * unit);
      }
      std::vector<PairList> lists;
      for (const auto& entry : all_broad_phases())
        entry.make(scene.setup)->find_pairs(scene.world, lists.emplace_back());
      CHECK(lists[0].pairs.size() > 700);
      for (const PairList& list : lists) CHECK(list.pairs == lists[0].pairs);
    }
}

TEST_CASE("over many steps no close pair is missing, all methods agree, and lists are kept",
          "[detection][broad][long]") {
  for (const std::string kind : {"mono", "lognormal", "bimodal", "clustered"})
    for (double margin : {0.0, 0.2}) {
      INFO(kind << " margin " << margin);
      BroadScene scene = random_scene(kind, 500, 4);
      scene.setup.margin = margin;
      scene.setup.reach = 0.02;
      std::vector<std::unique_ptr<BroadPhase>> methods;
      for (const auto& e : all_broad_phases()) methods.push_back(e.make(scene.setup));
      std::vector<PairList> lists(methods.size());
      const int steps = 120;
      for (int k = 0; k < steps; ++k) {
        drift(scene.world);
        for (std::size_t m = 0; m < methods.size(); ++m) methods[m]->find_pairs(scene.world, lists[m]);
        for (std::size_t m = 1; m < methods.size(); ++m) {
          REQUIRE(lists[m].pairs == lists[0].pairs);
          REQUIRE(lists[m].generation == lists[0].generation);
        }
        const auto close = close_pairs(scene);
        REQUIRE(std::includes(lists[0].pairs.begin(), lists[0].pairs.end(), close.begin(), close.end()));
      }
      CHECK(lists[0].generation > 2);
      // a boulder moves more than half of a margin of 0.2 in one step: only a margin of its own keeps the list
      const bool kept = kind != "bimodal" || margin == 0.0;
      CHECK(lists[0].generation < (kept ? steps / 4 : steps + 1));
    }
}

TEST_CASE("bodies at rest keep their list for ever", "[detection][broad]") {
  for (const auto& entry : all_broad_phases()) {
    BroadScene scene = random_scene("mono", 200, 2);
    const auto broad = entry.make(scene.setup);
    PairList list;
    for (int k = 0; k < 50; ++k) {
      scene.world.time += 1e-3;
      broad->find_pairs(scene.world, list);
    }
    CHECK(list.generation == 1);
  }
}

TEST_CASE("planes list the bodies near them, immovable pairs are never listed", "[detection][broad]") {
  for (const auto& entry : all_broad_phases()) {
    INFO(entry.entry.name);
    BroadScene scene = random_scene("lognormal", 300, 6);
    scene.add_plane({0, 0, -2}, {0, 0, 1});
    scene.add_plane({3, 0, 0}, {-1, 0.5, 0.2});
    for (int i = 0; i < 40; ++i) scene.add_sphere({0.4 * i - 4, 0, 0}, 0.5, Vec3::Zero(), false);
    scene.add_sphere(Vec3::Zero(), 60.0, Vec3::Zero(), false);  // a giant around everything
    scene.setup.margin = 0.1;
    const auto broad = entry.make(scene.setup);
    PairList list;
    broad->find_pairs(scene.world, list);
    const auto expected = pairs_by_definition(scene, scene.world);
    CHECK(list.pairs == expected);
    const Slot plane = 300;
    const auto with_plane =
        std::count_if(expected.begin(), expected.end(), [&](const Pair& p) { return p.b == plane; });
    CHECK(with_plane > 10);
    CHECK(with_plane < 290);
  }
}

TEST_CASE("a giant near 300 000 bodies is listed with each of them, in order", "[detection][broad]") {
  BroadScene scene;
  scene.setup.shapes = &scene.shapes;
  scene.add_sphere(Vec3::Zero(), 100.0, Vec3::Zero(), false);
  constexpr Slot n = 300'000;  // more than one window of slots
  for (Slot i = 0; i < n; ++i) scene.add_sphere(1.2 * Vec3(i % 67 - 33.0, i / 67 % 67 - 33.0, i / 4489 - 33.0), 0.5);
  scene.setup.margin = 0.01;
  PairList list;
  make_broad_phase("spatial-hash", scene.setup, scene.world)->find_pairs(scene.world, list);
  REQUIRE(list.pairs.size() == n);
  Slot wrong = 0;
  for (Slot i = 0; i < n; ++i) wrong += static_cast<Slot>(list.pairs[i] != Pair{0, i + 1});
  CHECK(wrong == 0);
}

TEST_CASE("a turned or moved plane lists the bodies it has come near", "[detection][broad]") {
  for (const auto& entry : all_broad_phases()) {
    BroadScene scene;
    scene.world = World({.rotation = true});
    scene.setup.shapes = &scene.shapes;
    const Slot high = scene.world.slot_of(scene.add_sphere({0, 0, 5}, 0.5));
    const Slot side = scene.world.slot_of(scene.add_sphere({5, 0, 3}, 0.5));
    const Slot plane = scene.world.slot_of(scene.add_plane({0, 0, 0}, {0, 0, 1}));
    const auto broad = entry.make(scene.setup);
    PairList list;
    broad->find_pairs(scene.world, list);
    CHECK(list.pairs.empty());
    scene.world.orientation[plane] =
        Quat(Eigen::AngleAxisd(0.6, Vec3::UnitY()).toRotationMatrix());  // n = (0.56, 0, 0.83)
    broad->find_pairs(scene.world, list);
    CHECK(list.pairs.empty());  // 5 * 0.56 + 3 * 0.83 is far
    scene.world.orientation[plane] =
        Quat(Eigen::AngleAxisd(-0.5, Vec3::UnitY()).toRotationMatrix());  // n = (-0.48, 0, 0.88)
    broad->find_pairs(scene.world, list);
    CHECK(list.pairs == PairColumn{{side, plane}});  // 5 * -0.48 + 3 * 0.88 = 0.24 < 0.5
    scene.world.orientation[plane] = Quat(1, 0, 0, 0);
    scene.world.position[plane].z() = 4.55;
    broad->find_pairs(scene.world, list);
    CHECK(list.pairs == PairColumn{{high, plane}, {side, plane}});
  }
}

TEST_CASE("the filter keeps pairs of types that have no cell off the list", "[detection][broad]") {
  for (const auto& entry : all_broad_phases()) {
    BroadScene scene = random_scene("mono", 200, 3);
    scene.add_plane({0, 0, 0}, {0, 0, 1});
    const auto sphere = ShapeStore::type_of<Sphere>(), plane = ShapeStore::type_of<HalfSpace>();
    scene.setup.filter.has_cell.assign(AllShapes::size * AllShapes::size, 0);
    scene.setup.filter.has_cell[sphere * AllShapes::size + plane] = 1;
    const auto broad = entry.make(scene.setup);
    PairList list;
    broad->find_pairs(scene.world, list);
    CHECK(list.pairs.size() > 50);
    for (const Pair& p : list.pairs) CHECK(p.b == 200);
  }
}

TEST_CASE("removal and sorting rename slots: the list follows, A keeps the lower id", "[detection][broad]") {
  for (const auto& entry : all_broad_phases()) {
    INFO(entry.entry.name);
    BroadScene scene = random_scene("lognormal", 500, 8);
    scene.add_plane({0, 0, 0}, {0, 0, 1});
    scene.setup.margin = 0.2;
    const auto broad = entry.make(scene.setup);
    PairList list;
    broad->find_pairs(scene.world, list);
    broad->reorder(scene.world.reorder(morton_order(scene.world)));
    broad->find_pairs(scene.world, list);
    CHECK(list.pairs == pairs_by_definition(scene, scene.world));
    CHECK(list.generation == 2);
    std::vector<BodyId> gone;
    for (std::uint32_t b = 3; b < 500; b += 5) gone.push_back(static_cast<BodyId>(b));
    broad->reorder(scene.world.remove(gone));
    broad->find_pairs(scene.world, list);
    CHECK(list.pairs == pairs_by_definition(scene, scene.world));
    std::size_t against_slots = 0;
    for (const Pair& p : list.pairs) {
      CHECK(scene.world.id[p.a] < scene.world.id[p.b]);
      against_slots += p.a > p.b;
    }
    CHECK(against_slots > 100);  // slot order is not id order here
    scene.add_sphere({0, 0, 0}, 1.0);
    broad->find_pairs(scene.world, list);
    CHECK(list.pairs == pairs_by_definition(scene, scene.world));
  }
}

TEST_CASE("the list is the same for every thread count", "[detection][broad][threads][long]") {
  const support::KeepThreads keep;
  for (const auto& entry : all_broad_phases()) {
    std::vector<PairColumn> results;
    for (int threads : {1, 2, 3, 4, 7, 8}) {
      set_thread_count(threads);
      BroadScene scene = random_scene("lognormal", 3000, 12);
      scene.add_plane({0, 0, 0}, {0, 0, 1});
      const auto broad = entry.make(scene.setup);
      PairList list;
      PairColumn all;
      for (int k = 0; k < 25; ++k) {
        drift(scene.world);
        broad->find_pairs(scene.world, list);
        all.insert(all.end(), list.pairs.begin(), list.pairs.end());
      }
      results.push_back(all);
    }
    for (const auto& r : results) CHECK((r == results[0]));
  }
}

TEST_CASE("a spinning needle is listed before its tip arrives", "[detection][broad][rotation]") {
  for (const auto& entry : all_broad_phases()) {
    INFO(entry.entry.name);
    BroadScene scene;
    scene.world = World({.rotation = true, .anisotropy = true});
    scene.setup.shapes = &scene.shapes;
    Body needle;
    needle.mass = 1.0;
    needle.inertia = Vec3(1, 10, 10);
    needle.angular_velocity = Vec3(0, 0, 1);
    needle.shape = scene.shapes.add(Box{Vec3(2.0, 0.01, 0.01)}).packed;
    scene.world.add(needle);
    scene.add_sphere({0, 1.9, 0}, 0.05);
    scene.add_sphere({0, 3.0, 0}, 0.05);  // the tip stays 1 m away
    const auto broad = entry.make(scene.setup);
    PairList list;
    const double dt = 0.01;
    bool seen = false;
    for (int k = 0; k < 158; ++k) {  // to a quarter turn
      const double angle = dt * (k + 1);
      scene.world.orientation[0] = Quat(std::cos(0.5 * angle), 0, 0, std::sin(0.5 * angle));
      scene.world.time += dt;
      broad->find_pairs(scene.world, list);
      // the sphere is 1.9 m along y; its distance from the needle's axis line is 1.9 cos(angle)
      const bool close = 1.9 * std::cos(angle) <= 0.05;
      if (close) REQUIRE(list.pairs == PairColumn{{0, 1}});
      seen = seen || close;
    }
    CHECK(seen);
    CHECK(list.generation < 80);
  }
}

TEST_CASE("a wall that turns about its own axis keeps its list, however it lies", "[detection][broad][rotation]") {
  Random random(5, 1);
  for (int draw = 0; draw < 20; ++draw) {
    BroadScene scene;
    scene.world = World({.rotation = true, .anisotropy = true});
    scene.setup.shapes = &scene.shapes;
    Body wall;
    wall.orientation = testing::random_turn(random);
    const Vec3 axis = wall.orientation * Vec3::UnitZ();
    wall.angular_velocity = 2.0 * axis;
    wall.shape = scene.shapes.add(Tube(1.0, 1.0, false)).packed;
    scene.world.add(wall);
    for (int k = 0; k < 10; ++k) scene.add_sphere(Vec3(0.05 * k, 0, 0), 0.02);
    const auto broad = all_broad_phases()[0].make(scene.setup);
    PairList list;
    for (int k = 0; k < 200; ++k) {
      scene.world.orientation[0] = (Quat(Eigen::AngleAxisd(2e-4, axis)) * scene.world.orientation[0]).normalized();
      scene.world.time += 1e-4;
      broad->find_pairs(scene.world, list);
    }
    CHECK(list.generation <= 2);
  }
}

TEST_CASE("degenerate worlds have the list of the definition", "[detection][broad][degenerate]") {
  for (const auto& name : names()) {
    INFO(name);
    const auto check = [&](BroadScene& scene) {
      scene.setup.margin = 0.01;
      const auto broad = make_broad_phase(name, scene.setup, scene.world);
      PairList list;
      broad->find_pairs(scene.world, list);
      CHECK(list.pairs == pairs_by_definition(scene, scene.world));
      return list.pairs.size();
    };
    BroadScene empty;
    empty.setup.shapes = &empty.shapes;
    CHECK(check(empty) == 0);
    BroadScene one;
    one.setup.shapes = &one.shapes;
    one.add_sphere(Vec3::Zero(), 1.0);
    CHECK(check(one) == 0);
    BroadScene same;  // 60 bodies in one place: every pair
    same.setup.shapes = &same.shapes;
    for (int i = 0; i < 60; ++i) same.add_sphere(Vec3(1, 2, 3), 0.1);
    CHECK(check(same) == 60 * 59 / 2);
    BroadScene far = random_scene("mono", 300, 1);  // one body has flown off
    far.add_sphere(Vec3(1e12, -1e15, 3), 0.5);
    far.add_sphere(Vec3(1e12, -1e15, 3.5), 0.5);
    CHECK(check(far) > 50);
  }
}

TEST_CASE("a body that is nowhere has no pairs and does not disturb the others", "[detection][broad][degenerate]") {
  for (const auto& entry : all_broad_phases()) {
    BroadScene scene = random_scene("mono", 200, 1);
    scene.setup.margin = 0.1;
    const auto broad = entry.make(scene.setup);
    PairList list;
    broad->find_pairs(scene.world, list);
    scene.world.position[17] = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
    scene.world.position[18].x() = infinity;
    broad->find_pairs(scene.world, list);
    CHECK(list.pairs == pairs_by_definition(scene, scene.world));
    for (const Pair& p : list.pairs) CHECK((p.a != 17 && p.b != 17 && p.a != 18 && p.b != 18));
  }
}

TEST_CASE("auto names its choice and the reason; unknown names give nothing", "[detection][broad]") {
  const BroadScene few = random_scene("mono", 10, 1), many = random_scene("wide", 2000, 1);
  CHECK(choose_broad_phase(few.world, few.setup).name == "all-pairs");
  CHECK(choose_broad_phase(few.world, few.setup).reason.find("10 bounded bodies") != std::string::npos);
  CHECK(choose_broad_phase(many.world, many.setup).name == "spatial-hash");
  CHECK(make_broad_phase("auto", many.setup, many.world)->name() == std::string("spatial-hash"));
  CHECK(make_broad_phase("octree", many.setup, many.world) == nullptr);
  CHECK(std::set<std::string>{"spatial-hash", "aabb-tree", "sweep-and-prune", "all-pairs"}.size() == names().size());
}

TEST_CASE("sizes over 1:100 of equal volume per decade have few candidates, however many bodies (B11 d)",
          "[detection][broad][B11]") {
  for (const int n : {2000, 20000})
    for (const std::string method : {"spatial-hash", "aabb-tree"}) {
      BroadScene scene;
      Random random(17, 0);
      std::vector<double> radius;
      double volume = 0.0;
      for (int i = 0; i < n; ++i) {  // their number falls with the fourth power of the size: r^3 dN is even in log r
        radius.push_back(0.5 / std::cbrt(1.0 - random.uniform() * (1.0 - 1e-6)));
        volume += 4.18879 * radius.back() * radius.back() * radius.back();
      }
      const double edge = 0.5 * std::cbrt(volume / 0.6);
      for (const double r : radius)
        scene.add_sphere(random_point(random, edge), r, 0.01 * r * random_point(random, 1.0));
      const auto broad = make_broad_phase(method, BroadSetup{&scene.shapes, 0.0, 0.0, {}}, scene.world);
      PairList list;
      for (int step = 0; step < 4; ++step) {
        drift(scene.world);
        broad->find_pairs(scene.world, list);
      }
      const auto touch = [&](const Pair& p) {
        const double sum = scene.shapes.bounding_radius({scene.world.shape[p.a]}) +
                           scene.shapes.bounding_radius({scene.world.shape[p.b]});
        return (scene.world.position[p.a] - scene.world.position[p.b]).norm() <= sum;
      };
      const auto touching = static_cast<std::size_t>(std::count_if(list.pairs.begin(), list.pairs.end(), touch));
      INFO(n << " bodies by " << method << ": " << list.pairs.size() << " candidates, " << touching << " touch");
      CHECK(touching > static_cast<std::size_t>(n) / 2);
      CHECK(list.pairs.size() < 10 * touching);
      if (n == 2000) {
        const PairColumn all = pairs_by_definition(scene, scene.world);  // margin 0: those that touch
        CHECK(all.size() == touching);
      }
    }
}

TEST_CASE("what falls side by side keeps its list, and meets what does not fall", "[detection][broad]") {
  for (const auto& entry : all_broad_phases()) {
    BroadScene scene;
    scene.setup.shapes = &scene.shapes;
    constexpr double dt = 1e-3, g = 10.0;
    for (int i = 0; i < 64; ++i) scene.add_sphere({0.99 * (i % 4), 0.99 * (i / 4 % 4), 0.99 * (i / 16)}, 0.5);
    for (int i = 0; i < 16; ++i) scene.add_sphere({1.0 * (i % 4), 1.0 * (i / 4), -8.0}, 0.5, Vec3::Zero(), false);
    scene.add_plane({0, 0, -9}, Vec3::UnitZ());
    const auto broad = entry.make(scene.setup);
    PairList list;
    for (int k = 0; k < 1200; ++k) {  // 7.2 m, 14 radii; 18 lists, 62 of ways without a common frame
      for (Slot s = 0; s < 64; ++s) {
        scene.world.velocity[s].z() -= g * dt;
        scene.world.position[s] += dt * scene.world.velocity[s];
      }
      scene.world.time += dt;
      broad->find_pairs(scene.world, list);
      const auto close = close_pairs(scene);
      REQUIRE(std::includes(list.pairs.begin(), list.pairs.end(), close.begin(), close.end()));
    }
    CHECK(list.generation < 30);
    CHECK(close_pairs(scene).size() == 144 + 16);  // of each other, and of the lowest with the fixed ones
  }
}

TEST_CASE("margins of spheres at rest grow where these end lists early, and shrink again", "[detection][broad]") {
  BroadScene scene;
  scene.setup.shapes = &scene.shapes;
  for (int i = 0; i < 64; ++i) scene.add_sphere(0.99 * Vec3(i % 4, i / 4 % 4, i / 16), 0.5);
  const auto broad = make_broad_phase("spatial-hash", scene.setup, scene.world);
  PairList list;
  const auto wait = [&](int steps) {
    for (int k = 0; k < steps; ++k) {
      scene.world.time += 1.0;
      broad->find_pairs(scene.world, list);
    }
  };
  wait(2);
  CHECK(2.0 / list.inverse_half_margin[0] == Approx(0.06 * 0.5));
  for (int k = 0; k < 12; ++k) {
    scene.world.position[0].x() -= 1.2 / list.inverse_half_margin[0];  // a jump past half its margin, from rest
    wait(3);
    for (const Pair& p : close_pairs(scene)) CHECK(std::binary_search(list.pairs.begin(), list.pairs.end(), p));
  }
  CHECK(2.0 / list.inverse_half_margin[0] == Approx(0.16 * 0.5));
  wait(400);
  scene.world.position[0].x() += 1.2 / list.inverse_half_margin[0];
  wait(1);
  CHECK(2.0 / list.inverse_half_margin[0] == Approx(0.16 * 0.5 / 1.4));
}
