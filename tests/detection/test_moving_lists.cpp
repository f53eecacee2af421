// Lists that last while walls turn and cells deform: over many steps no pair within reach is missing, by brute force,
// and lists are not made in every step.
#include <set>

#include "engine/state/rotation.h"
#include "engine/step/cell_events.h"
#include "tests/detection/broad_scenes.h"
#include "tests/support/catch.h"

using namespace epafi;
using namespace epafi::test;

namespace {

/// A, B and the image code of B's place.
using Named = std::tuple<Slot, Slot, std::uint32_t>;

std::set<Named> named(const PairList& list) {
  std::set<Named> out;
  for (const Pair& p : list.pairs) out.insert({p.a, p.b, p.image & 0xffu});
  return out;
}

/// Pairs with gap < reach: spheres with all images, and with half-spaces.
std::vector<Named> close_pairs(const BroadScene& scene) {
  const World& world = scene.world;
  std::vector<Named> out;
  const auto radius = [&](Slot s) { return scene.shapes.bounding_radius({world.shape[s]}); };
  const auto span = [&](int k) { return world.cell && world.cell->repeats[static_cast<std::size_t>(k)] ? 1 : 0; };
  for (Slot i = 0; i < world.size(); ++i)
    for (Slot j = 0; j < world.size(); ++j) {
      if (!(world.id[i] < world.id[j]) || (!world.is_movable(i) && !world.is_movable(j))) continue;
      const bool plane_i = std::isinf(radius(i)), plane_j = std::isinf(radius(j));
      if (plane_i || plane_j) {
        const Slot p = plane_i ? i : j, s = plane_i ? j : i;
        const auto& shapes = scene.shapes.of<HalfSpace>();
        const Vec3 n = world.pose(p).orientation * shapes[ShapeRef{world.shape[p]}.index()].normal;
        if (n.dot(world.position[s] - world.position[p]) - radius(s) < scene.setup.reach) out.push_back({i, j, 0});
        continue;
      }
      for (int x = -span(0); x <= span(0); ++x)
        for (int y = -span(1); y <= span(1); ++y)
          for (int z = -span(2); z <= span(2); ++z) {
            const std::uint32_t code = image_code(x, y, z);
            Vec3 d = world.position[j] - world.position[i];
            if (code != 0) d += world.cell->shift(code);
            if (d.norm() < radius(i) + radius(j) + scene.setup.reach) out.push_back({i, j, code});
          }
    }
  return out;
}

/// Of a list as it is now; how many close pairs there are.
std::size_t check_complete(const BroadScene& scene, const PairList& list) {
  const std::set<Named> listed = named(list);
  const std::vector<Named> close = close_pairs(scene);
  for (const Named& pair : close) REQUIRE(listed.contains(pair));
  return close.size();
}

/// Spheres that move at random in a box of half the edge, within which they are thrown back.
void move_spheres(BroadScene& scene, double dt, double edge) {
  for (Slot s = 0; s < scene.world.size(); ++s) {
    if (!scene.world.is_movable(s)) continue;
    scene.world.position[s] += dt * scene.world.velocity[s];
    for (int k = 0; k < 3; ++k)
      if (std::abs(scene.world.position[s][k]) > edge)
        scene.world.velocity[s][k] = -std::copysign(scene.world.velocity[s][k], scene.world.position[s][k]);
  }
}

}  // namespace

TEST_CASE("turning, shaking and pushing half-spaces keep their lists and miss nobody", "[detection][broad][walls]") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed)
    for (const std::string name : {"spatial-hash", "all-pairs"}) {
      INFO(name << " seed " << seed);
      BroadScene scene;
      scene.world = World({.rotation = true});
      scene.setup.shapes = &scene.shapes;
      scene.setup.reach = 0.01;
      Random random(seed, 3);
      const double edge = 4.0, dt = 1e-3;
      for (int i = 0; i < 150; ++i)
        scene.add_sphere(test::random_point(random, edge), random.uniform(0.15, 0.3),
                         0.5 * test::random_point(random, 1.0));
      if (seed % 2 == 0) scene.add_sphere(Vec3(3e3, 0, 0), 0.2);  // a stray: no plane may watch all that is between
      std::vector<Slot> planes;
      for (int p = 0; p < 6; ++p) {
        const Vec3 n = test::random_point(random, 1.0).normalized();
        planes.push_back(scene.world.slot_of(scene.add_plane(random.uniform(-6.0, -2.0) * n, n)));
      }
      const Vec3 axis = test::random_point(random, 1.0).normalized();
      const double rate = random.uniform(0.5, 3.0);
      const auto broad = make_broad_phase(name, scene.setup, scene.world);
      PairList list;
      std::size_t close = 0;
      constexpr int steps = 400;
      for (int k = 0; k < steps; ++k) {
        for (std::size_t p = 0; p < planes.size(); ++p) {
          const Slot s = planes[p];
          World& w = scene.world;
          const bool turns = p % 3 != 2;  // about the common axis, or about its own point; the third kind shakes
          w.angular_velocity[s] = turns ? Vec3(rate * axis) : Vec3(Vec3::Zero());
          if (p % 3 == 0) w.velocity[s] = rate * axis.cross(Vec3(w.position[s]));
          if (p % 3 == 2) w.velocity[s] = 2.0 * std::cos(40.0 * k * dt) * Vec3(axis.y(), axis.z(), axis.x());
          w.position[s] += dt * w.velocity[s];
          w.orientation[s] = turned(w.orientation[s], dt * w.angular_velocity[s]);
        }
        move_spheres(scene, dt, edge);
        scene.world.time += dt;
        broad->find_pairs(scene.world, list);
        close += k % 11 == 0 ? check_complete(scene, list) : 0;
      }
      CHECK(close > 100);
      CHECK(list.generation < steps / 5);
    }
}

TEST_CASE("lists of cells that strain hold beside the flow, held and fast bodies included",
          "[detection][broad][cell]") {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    BroadScene scene;
    scene.world = World({.periodic = true});
    scene.setup.shapes = &scene.shapes;
    scene.setup.reach = 0.005;
    Random random(seed, 5);
    const bool walled = seed % 4 == 3;  // z does not repeat: planes and held spheres stand in the flow
    const double dt = 1e-3;
    PeriodicCell cell;
    cell.size = Vec3(3.0, 3.5, 4.0);
    cell.low = test::random_point(random, 2.0);
    cell.repeats = {true, true, !walled};
    scene.world.cell = cell;
    const auto place = [&] {
      return Vec3(cell.low + cell.size.cwiseProduct(test::random_point(random, 0.5) + Vec3::Constant(0.5)));
    };
    for (int i = 0; i < 120; ++i)
      scene.add_sphere(place(), random.uniform(0.1, 0.25), (i % 10 == 0 ? 8.0 : 0.4) * test::random_point(random, 1.0));
    for (int i = 0; i < (seed % 2 == 1 ? 6 : 0); ++i) scene.add_sphere(place(), 0.3, Vec3::Zero(), false);
    if (walled) scene.add_plane(cell.low, Vec3::UnitZ());
    CellControl control;
    control.strain_rate = (seed % 3 == 0 ? 0.8 : -0.6) * Vec3(1.0, random.uniform(-1, 1), walled ? 0.0 : 0.5);
    DeformCell deform(control);
    WrapBodies wrap(0.3);
    std::vector<std::unique_ptr<BroadPhase>> methods;
    for (const auto& entry : all_broad_phases()) methods.push_back(entry.make(scene.setup));
    std::vector<PairList> lists(methods.size());
    std::vector<BodyId> nobody;
    std::size_t close = 0;
    std::set<std::uint32_t> images;
    constexpr int steps = 300;
    for (int k = 0; k < steps; ++k) {
      deform.before_step(scene.world, dt, nobody);
      wrap.before_step(scene.world, dt, nobody);
      for (Slot s = 0; s < scene.world.size(); ++s)
        if (scene.world.is_movable(s)) scene.world.position[s] += dt * scene.world.velocity[s];
      scene.world.time += dt;
      for (std::size_t m = 0; m < methods.size(); ++m) methods[m]->find_pairs(scene.world, lists[m]);
      if (k % 10 != 0) continue;
      INFO("seed " << seed << " step " << k);
      close += check_complete(scene, lists[0]);
      for (std::size_t m = 1; m < methods.size(); ++m) REQUIRE(lists[m].pairs == lists[0].pairs);
      for (const Named& pair : named(lists[0])) images.insert(std::get<2>(pair));
    }
    CHECK(close > 300);
    CHECK(lists[0].generation < steps / 3);
    CHECK(images.size() >= (walled ? 5 : 7));  // across every face, and none
  }
}

TEST_CASE("what a cell carries along does not used_margin its list", "[detection][broad][cell]") {
  BroadScene scene;
  scene.world = World({.periodic = true});
  scene.setup.shapes = &scene.shapes;
  PeriodicCell cell;
  cell.size = Vec3::Constant(10.0);
  cell.repeats = {true, true, true};
  scene.world.cell = cell;
  for (int i = 0; i < 1000; ++i) scene.add_sphere(Vec3(0.5 + i % 10, 0.5 + i / 10 % 10, 0.5 + i / 100), 0.48);
  CellControl control;
  control.strain_rate = Vec3(0.5, -0.5, 0.1);
  DeformCell deform(control);
  const auto broad = make_broad_phase("spatial-hash", scene.setup, scene.world);
  PairList list;
  std::vector<BodyId> nobody;
  constexpr double dt = 1e-4;
  for (int k = 0; k < 1000; ++k) {  // 5 %: bodies pass half a metre, the least margin is 0.03
    deform.before_step(scene.world, dt, nobody);
    scene.world.time += dt;
    broad->find_pairs(scene.world, list);
  }
  CHECK(list.generation < 12);
  check_complete(scene, list);
}

TEST_CASE("bodies that come are taken into a list that goes on, and miss nobody", "[detection][broad][sources]") {
  for (const bool apart : {false, true}) {
    BroadScene scene;
    scene.setup.shapes = &scene.shapes;
    scene.setup.reach = 0.01;
    Random random(7, 2);
    const double dt = 1e-3;
    std::vector<BodyId> reserved;  // ids need not rise with the slots
    for (int i = 0; i < 200; ++i) reserved.push_back(scene.world.reserve());
    scene.setup.spheres.fixed.assign(200, false);
    scene.setup.spheres.fixed.push_back(true);
    scene.add_plane({0, 0, -3}, Vec3::UnitZ());
    for (int i = 0; i < 60; ++i) scene.add_sphere(test::random_point(random, 2.5), random.uniform(0.2, 0.3));
    scene.setup.spheres.wanted = apart;
    const auto broad = make_broad_phase("spatial-hash", scene.setup, scene.world);
    PairList list;
    std::uint64_t births = 0;
    std::size_t close = 0;
    for (int k = 0; k < 400; ++k) {
      const bool comes = k % 2 == 0 && !reserved.empty();
      if (comes) {
        Body b;
        const double r = random.uniform(0.2, 0.3);
        b.position = test::random_point(random, 2.5);
        b.mass = r * r * r;
        b.inertia = Vec3::Constant(r * r * r * r * r);
        b.velocity =
            Vec3(0, 0, -1) + 0.2 * test::random_point(random, 1.0);  // they fall together: the list has a drift
        b.shape = scene.shapes.add(Sphere{r}).packed;
        scene.world.add(b, reserved.back());
        reserved.pop_back();
        ++births;
      }
      move_spheres(scene, dt, 2.8);
      scene.world.time += dt;
      broad->find_pairs(scene.world, list);
      if (k % 10 != 0) continue;
      PairList all = list;
      for (Slot s = 0; apart && s < scene.world.size(); ++s)
        for (std::uint32_t at = list.spheres.first[s]; at < list.spheres.first[s + 1]; ++at) {
          const Slot p = list.spheres.partner[at];
          const Slot b = (p & SpherePairs::plane) != 0 ? list.spheres.planes[p & ~SpherePairs::plane] : p;
          const bool in_order = scene.world.id[s] < scene.world.id[b];
          all.pairs.push_back(in_order ? Pair{s, b} : Pair{b, s});
        }
      close += check_complete(scene, all);
      CHECK(std::ranges::is_sorted(list.pairs));
    }
    CHECK(births == 200);
    CHECK(close > 500);
  }
}
