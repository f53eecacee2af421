// The bytes of `epafi explain` against what a process takes on top of them: they are a count by types, so the process
// has more (columns keep room to grow, drawn surfaces, the scene itself), and not by far.
#include <unistd.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <fstream>

#include "scenes/memory_plan.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

MemoryPlan memory_of(const std::string& scene, const std::vector<std::string>& overrides = {}) {
  return prepare_scene(library(scene), overrides).assembly->plan.memory;
}

/// By the plan, with the pairs and contacts that are there now [B].
double planned_bytes(SceneRun& run) {
  const Simulation& sim = run.simulation();
  const MemoryPlan& m = run.assembly->plan.memory;
  const auto bodies = static_cast<double>(sim.world.size());
  const auto pairs = static_cast<double>(sim.work.pairs.pairs.size() + sim.work.pairs.spheres.size());
  const auto contacts = static_cast<double>(std::max(sim.work.contacts.size(), sim.work.report.touching));
  return bodies * static_cast<double>(m.body + m.list) + pairs * static_cast<double>(m.pair) +
         contacts * static_cast<double>(m.contact) + static_cast<double>(polyhedra_bytes(*run.assembly->shapes));
}

/// What this process holds now without what belongs to files, its code among them [B].
double resident() {
#if defined(__GLIBC__)
  malloc_trim(0);  // what earlier cases have freed
#endif
  std::ifstream statm("/proc/self/statm");
  double all = 0.0, pages = 0.0, of_files = 0.0;
  statm >> all >> pages >> of_files;
  return (pages - of_files) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace

TEST_CASE("a scene pays memory for what it declares, not for more", "[scenes][memory]") {
  const MemoryPlan bed = memory_of("bed/bed.toml", {"params.n=1000"});
  CHECK(memory_of("bed/bed.toml", {"params.n=1000", "contact.friction=0"}).contact + 32 == bed.contact);  // a spring
  CHECK(memory_of("bed/bed.toml", {"params.n=1000", "contact.friction=0"}).body < bed.body);              // no rotation
  const MemoryPlan rolling =
      memory_of("bed/bed.toml", {"params.n=1000", "contact.smooth.rolling=spring", "contact.rolling_friction=0.1"});
  CHECK(rolling.contact > bed.contact + 2 * 32);  // its spring, and what the contact feels now
  CHECK(rolling.body == bed.body + 32);           // spin at the time of the detection
  CHECK(bed.contact < bed.in_set);                // spheres in their own loop have no contact in the set
  const std::string stack = "stacking/stack.toml";
  CHECK(memory_of(stack).contact > memory_of(stack, {"contact.method=smooth"}).contact);
}

// sanitizers keep shadows of all memory
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define EPAFI_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define EPAFI_SANITIZED
#endif
#endif

#ifndef EPAFI_SANITIZED
TEST_CASE("what explain predicts is most of what a run takes", "[scenes][memory]") {
  const auto [scene, overrides, most] = GENERATE(table<std::string, std::vector<std::string>, double>(
      {{"bed/bed.toml", {"params.n=60000"}, 1.4}, {"pile/polyhedra.toml", {"run.duration=0.1"}, 1.9}}));
  const support::KeepThreads keep;
  set_thread_count(1);  // each thread has room of its own
  const double before = resident();
  SceneRun run = prepare_scene(library(scene), overrides);
  run.simulation().start();
  run.advance_to(40);
  const double taken = resident() - before, planned = planned_bytes(run);
  INFO(scene << ": planned " << 1e-6 * planned << " MB, taken " << 1e-6 * taken);
  CHECK(planned > 5e6);
  CHECK(taken > planned);
  CHECK(taken < most * planned);
}
#endif
