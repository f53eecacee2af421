/// The one place of this executable that replaces operator new: counts allocations.
#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/support/catch.h"
#include "tests/support/rigid_experiment.h"

namespace {
std::atomic<std::size_t> allocations{0};
}

[[gnu::noinline]] void* operator new(std::size_t bytes) {
  ++allocations;
  if (void* p = std::malloc(bytes > 0 ? bytes : 1)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void* operator new(std::size_t bytes,
                                     const std::nothrow_t&) noexcept {  // or a sanitizer's meets the free() below
  ++allocations;
  return std::malloc(bytes > 0 ? bytes : 1);
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }

using namespace epafi;
using namespace epafi::test;

TEST_CASE("a step of a settled stack allocates nothing, by sweeps, by newton and by auto",
          "[laws][nonsmooth][memory]") {
  for (const char* solver : {"pgs", "nsgs", "newton", "auto"})
    for (const char* impact : {"newton", "sequential"}) {
      INFO(solver << " with the law of impact " << impact);
      RigidSettings s{.friction = 0.5, .restitution = 0.3, .dt = 1.0 / 240, .reach = 1e-2, .solver = solver};
      s.parameters.set("tolerance", 1e-8);
      s.parameters.set("iterations", 500.0);
      s.parameters.set("impact", impact);
      RigidExperiment x(s);
      x.plane(Vec3::Zero(), Vec3::UnitZ());
      for (int i = 0; i < 6; ++i) x.box(Vec3::Constant(0.5), 1000.0, Vec3(1e-3 * (i % 3), 0, 0.5 + i - 2e-4 * (i + 1)));
      x.run(100);
      REQUIRE(x.work.contacts.size() == 24);
      const std::size_t before = allocations;
      x.run(100);
      CHECK(allocations - before == 0);
    }
}
