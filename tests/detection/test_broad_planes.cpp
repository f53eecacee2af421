#include "engine/lanes/targets.h"
#include "tests/detection/broad_scenes.h"
#include "tests/support/catch.h"

using namespace epafi;
using namespace epafi::test;

namespace {

struct Narrower {
  explicit Narrower(Target most) { limit_target(most); }
  ~Narrower() { limit_target(Target::avx512); }
};

/// A cloud cut by up to 27 half-spaces, of which some never move.
BroadScene cloud_between_planes(std::uint64_t seed, bool apart) {
  BroadScene scene = random_scene("lognormal", 120, seed);
  scene.setup.margin = 0.1;
  scene.setup.reach = 0.03;
  scene.setup.spheres.wanted = apart;
  Random random(seed, 2);
  const int planes = static_cast<int>(random.uniform(0.0, 28.0));
  for (int k = 0; k < planes; ++k) {
    const Vec3 n = random_point(random, 1.0).normalized();
    const auto id = static_cast<std::size_t>(scene.add_plane(random.uniform(-4.0, 0.5) * n, n));
    scene.setup.spheres.fixed.resize(id + 1, random.uniform() < 0.5);
  }
  return scene;
}

/// Those of the spheres' own list too.
PairColumn all_pairs_of(const PairList& list) {
  PairColumn out = list.pairs;
  const SpherePairs& spheres = list.spheres;
  for (Slot s = 0; s + 1 < spheres.first.size(); ++s)
    for (std::uint32_t k = spheres.first[s]; k < spheres.first[s + 1]; ++k) {
      const Slot b = spheres.partner[k];
      out.push_back({s, (b & SpherePairs::plane) != 0 ? spheres.planes[b & ~SpherePairs::plane] : b});
    }
  std::ranges::sort(out);
  return out;
}

}  // namespace

TEST_CASE("any number of half-spaces, fixed or not, is listed by definition at every width", "[detection][broad]") {
  for (const Target most : {Target::baseline, Target::avx2, Target::avx512}) {
    const Narrower narrower(most);
    for (const auto& entry : all_broad_phases())
      for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        INFO(entry.entry.name << " seed " << seed << " width " << static_cast<int>(most));
        const BroadScene scene = cloud_between_planes(seed, seed % 2 == 0);
        PairList list;
        entry.make(scene.setup)->find_pairs(scene.world, list);
        CHECK(all_pairs_of(list) == pairs_by_definition(scene, scene.world));
      }
  }
}

TEST_CASE("a body far from all others is listed with every half-space that may move", "[detection][broad]") {
  for (const auto& entry : all_broad_phases())
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      INFO(entry.entry.name << " seed " << seed);
      BroadScene scene = cloud_between_planes(seed, true);
      std::vector<bool>& fixed = scene.setup.spheres.fixed;
      const auto stray = static_cast<Slot>(scene.add_sphere({0.0, 0.0, 1e3}, 0.5));
      std::size_t loose = 0, listed = 0;
      for (std::size_t id = 120; id < stray; ++id) loose += fixed[id] ? 0 : 1;
      PairList list;
      entry.make(scene.setup)->find_pairs(scene.world, list);
      for (const Pair& p : list.pairs) listed += p.a == stray || p.b == stray ? 1 : 0;
      CHECK(listed == loose);
    }
}
