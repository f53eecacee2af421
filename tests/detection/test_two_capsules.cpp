#include "detection/narrow/pairs/capsule_sieve.h"

#include <cstring>

#include "detection/narrow/pairs/capsule_pairs.h"
#include "detection/shape_store.h"
#include "engine/lanes/targets.h"
#include "tests/support/catch.h"
#include "tests/support/random_geometry.h"

using namespace epafi;

namespace {

/// Capsules near each other, some of them parallel, and every pair of them.
struct Heap {
  ShapeStore shapes;
  World world{[] {
    Columns c;
    c.rotation = c.orientation = c.anisotropy = true;
    return c;
  }()};
  std::vector<Pair> pairs;

  explicit Heap(Random& random) {
    for (int k = 0; k < 24; ++k) {
      Body body;
      body.position = 3.0 * testing::random_point(random);
      body.orientation = random.uniform() < 0.2 ? Quat(1, 0, 0, 0) : testing::random_turn(random);
      body.shape = shapes.add(Capsule(random.uniform(0.2, 1.0), random.uniform(0.0, 3.0))).packed;
      body.mass = 1.0;
      body.inertia = Vec3(1, 1, 2);
      world.add(body);
    }
    for (Slot a = 0; a < world.size(); ++a)
      for (Slot b = a + 1; b < world.size(); ++b) pairs.push_back({a, b});
  }
};

bool same(const ContactSet& x, const ContactSet& y) {
  const auto bytes = [](const auto& p, const auto& q) {
    return p.size() == q.size() && (p.empty() || std::memcmp(p.data(), q.data(), p.size() * sizeof(p[0])) == 0);
  };
  return bytes(x.a, y.a) && bytes(x.b, y.b) && bytes(x.feature, y.feature) && bytes(x.gap, y.gap) &&
         bytes(x.normal, y.normal) && bytes(x.arm, y.arm) && bytes(x.effective_radius, y.effective_radius);
}

}  // namespace

TEST_CASE("capsules several at a time have the contacts of the closed form, to the bit", "[detection][capsule]") {
  for (const Target most : {Target::baseline, Target::avx2, Target::avx512}) {
    limit_target(most);
    Random random(401, 0);
    std::size_t contacts = 0, together = 0;
    for (int round = 0; round < 200; ++round) {
      const Heap heap(random);
      const double reach = random.uniform() < 0.5 ? 0.0 : random.uniform(0.0, 0.3);
      const std::vector<Capsule>& capsules = heap.shapes.of<Capsule>();
      const auto shape = [&](Slot s) -> const Capsule& { return capsules[ShapeRef{heap.world.shape[s]}.index()]; };
      ContactSet alone, found;
      alone.with_curvature = found.with_curvature = true;
      ContactSink one(alone), several(found);
      const auto ask = [&](const Pair& p, ContactSink& sink) {
        sink.begin(p.a, p.b);
        collide_closed(shape(p.a), shape(p.b), PairQuery{heap.world.pose(p.a), heap.world.pose(p.b), reach, true},
                       sink);
        sink.end();
      };
      for (const Pair& p : heap.pairs) ask(p, one);
      for (const NearCapsules& c :
           near_capsules(heap.world, capsules, heap.pairs, [&](const Pair&) { return reach; })) {
        const Pair& p = heap.pairs[c.pair];
        together += c.is_found;
        if (!c.is_found) {
          ask(p, several);
          continue;
        }
        several.begin(p.a, p.b);
        several.add(c.point);
      }
      contacts += alone.size();
      INFO("round " << round << ", target " << static_cast<int>(most));
      CHECK(same(alone, found));
    }
    CHECK(contacts > 2000);
    CHECK(2 * together > contacts);
  }
  limit_target(Target::avx512);
}
