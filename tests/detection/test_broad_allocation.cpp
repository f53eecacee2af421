/// The one place of this executable that replaces operator new: counts allocations.
#include <atomic>
#include <cstdlib>
#include <new>

#include "engine/threads/parallel.h"
#include "tests/detection/broad_scenes.h"
#include "tests/support/catch.h"

namespace {
std::atomic<std::size_t> allocations{0};
}

void* operator new(std::size_t bytes) {
  ++allocations;
  if (void* p = std::malloc(bytes > 0 ? bytes : 1)) return p;
  throw std::bad_alloc();
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {  // or a sanitizer's meets the free() below
  ++allocations;
  return std::malloc(bytes > 0 ? bytes : 1);
}
void operator delete(void* p) noexcept { std::free(p); }
void operator delete(void* p, std::size_t) noexcept { std::free(p); }

using namespace epafi;
using namespace epafi::test;

namespace {
/// There and back: the rebuilds of a second round meet nothing larger than those of the first. Returns how many.
std::uint64_t round_trip(BroadScene& scene, BroadPhase& broad, PairList& list) {
  const std::uint64_t first = list.generation;
  for (int k = 0; k < 240; ++k) {
    scene.world.time += 1.0;
    for (Slot s = 0; s < scene.world.size(); ++s)
      scene.world.position[s] += (k < 120 ? 1.0 : -1.0) * scene.world.velocity[s];
    broad.find_pairs(scene.world, list);
  }
  return list.generation - first;
}
}  // namespace

TEST_CASE("a settled broad phase allocates nothing, neither keeping nor rebuilding its list", "[detection][broad]") {
  const int threads = thread_count();
  for (const auto& entry : all_broad_phases()) {
    INFO(entry.entry.name);
    BroadScene scene = random_scene("bimodal", 1200, 5), small = random_scene("mono", 1200, 5);
    const auto broad = entry.make(scene.setup), other = entry.make(small.setup);
    PairList list, list_of_small;
    // The two threads that come last have seen no long runs of partners: they find nothing to make for themselves.
    set_thread_count(1);
    for (int k = 0; k < 3; ++k) round_trip(scene, *broad, list);
    set_thread_count(3);
    round_trip(small, *other, list_of_small);
    const std::size_t before = allocations;
    const std::uint64_t rebuilds = round_trip(scene, *broad, list);
    const std::size_t after = allocations;
    set_thread_count(threads);
    CHECK(rebuilds > 2);
    CHECK(after - before == 0);
  }
}
