// Pairs that a contact model of spheres takes itself: the same set as in the full list, by slots, whatever the method.
#include "engine/threads/parallel.h"
#include "tests/detection/broad_scenes.h"
#include "tests/support/catch.h"

using namespace epafi;
using namespace epafi::test;

namespace {

/// Free spheres among planes (one of which is driven), and, as asked, a held sphere, a box and a free giant.
BroadScene spheres_and(bool held, bool box, bool giant, std::uint64_t seed) {
  BroadScene scene = random_scene(seed % 2 == 0 ? "lognormal" : "mono", 1500, seed);
  scene.setup.margin = 0.11;
  scene.setup.reach = 0.03;
  const double edge = 6.0;
  std::vector<BodyId> fixed;
  for (int k = 0; k < 6; ++k) {
    const Vec3 n = (k % 2 == 0 ? 1.0 : -1.0) * (Vec3::Unit(k / 2) + 0.1 * Vec3(1, 2, 3));
    fixed.push_back(scene.add_plane(-edge * n.normalized(), n));
  }
  if (held) scene.add_sphere(Vec3(1, 0, 0), 0.7, Vec3::Zero(), false);
  if (giant) scene.add_sphere(Vec3(0, 0, -20), 18.0);
  if (box) {
    Body b;
    b.position = Vec3(0, 1, 0);
    b.mass = 1.0;
    b.inertia = Vec3::Ones();
    b.shape = scene.shapes.add(Box{Vec3(0.5, 0.8, 0.4)}).packed;
    scene.world.add(b);
  }
  scene.setup.spheres.fixed.assign(scene.world.ids_given(), false);
  for (std::size_t k = 0; k + 1 < fixed.size(); ++k)
    scene.setup.spheres.fixed[static_cast<std::size_t>(fixed[k])] = true;
  scene.world.reorder(morton_order(scene.world));
  return scene;
}

void check_same(const PairList& found, const PairList& expected, std::size_t bodies) {
  CHECK(found.pairs == expected.pairs);
  CHECK(found.spheres.planes == expected.spheres.planes);
  REQUIRE(found.spheres.partner == expected.spheres.partner);
  bool same = true;
  for (std::size_t s = 0; s <= bodies; ++s) same = same && found.spheres.first[s] == expected.spheres.first[s];
  CHECK(same);
}

}  // namespace

TEST_CASE("pairs of spheres are listed by slots, the others as ever, by every method", "[detection][broad][spheres]") {
  for (int kind = 0; kind < 8; ++kind)
    for (const auto& entry : all_broad_phases())
      for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        INFO(entry.entry.name << " kind " << kind << " seed " << seed);
        const BroadScene scene = spheres_and((kind & 1) != 0, (kind & 2) != 0, (kind & 4) != 0, seed);
        PairList all, apart;
        entry.make(scene.setup)->find_pairs(scene.world, all);
        BroadSetup wanted = scene.setup;
        wanted.spheres.wanted = true;
        entry.make(wanted)->find_pairs(scene.world, apart);
        const std::size_t pairs = all.pairs.size();
        take_spheres(scene.world, wanted.spheres, all);
        check_same(apart, all, scene.world.size());
        CHECK(apart.spheres.size() + apart.pairs.size() == pairs);
        CHECK(apart.spheres.size() > 1000);
        CHECK(apart.spheres.planes.size() == 5);
        CHECK(!apart.pairs.empty());  // with the driven plane at least
      }
}

TEST_CASE("lists of spheres are the same for every number of threads", "[detection][broad][spheres][parallel]") {
  BroadScene scene = spheres_and(false, false, false, 3);
  scene.setup.spheres.wanted = true;
  PairList one;
  set_thread_count(1);
  make_broad_phase("spatial-hash", scene.setup, scene.world)->find_pairs(scene.world, one);
  for (int threads : {2, 3, 7}) {
    set_thread_count(threads);
    PairList many;
    make_broad_phase("spatial-hash", scene.setup, scene.world)->find_pairs(scene.world, many);
    check_same(many, one, scene.world.size());
  }
  set_thread_count(1);
}

TEST_CASE("a list of spheres follows bodies that moved, came and changed slots", "[detection][broad][spheres]") {
  BroadScene scene = spheres_and(false, false, false, 5);
  scene.setup.spheres.wanted = true;
  const auto broad = make_broad_phase("spatial-hash", scene.setup, scene.world);
  PairList list;
  const auto check = [&] {
    broad->find_pairs(scene.world, list);
    PairList fresh;
    make_broad_phase("spatial-hash", scene.setup, scene.world)->find_pairs(scene.world, fresh);
    check_same(list, fresh, scene.world.size());
  };
  check();
  for (Slot s = 0; s < scene.world.size(); ++s)
    if (scene.world.is_movable(s)) scene.world.position[s] += Vec3(0.2, 0, 0);
  check();
  scene.add_sphere(Vec3(0.3, 0.2, 0.1), 0.5);
  check();
  broad->reorder(scene.world.remove(std::vector<BodyId>{BodyId{4}, BodyId{700}}));
  check();
  broad->reorder(scene.world.reorder(morton_order(scene.world)));
  check();
}
