// Contacts of the fused loop as observers see them, among those of others: in canonical order, each with its values, the
// same for every thread count, and together what the bodies feel.
#include <tuple>

#include "engine/parallel.h"
#include "tests/support/catch.h"
#include "tests/support/keep_threads.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {
bool is_same(const ContactSet& p, const ContactSet& q) {
  return std::tie(p.a, p.b, p.feature, p.gap, p.normal, p.arm, p.effective_radius, p.area, p.force, p.moment) ==
         std::tie(q.a, q.b, q.feature, q.gap, q.normal, q.arm, q.effective_radius, q.area, q.force, q.moment);
}
}  // namespace

TEST_CASE("contacts of the fused loop are published in canonical order, the same for every thread count", "[physics][fused]") {
  const support::KeepThreads keep;
  set_thread_count(1);
  const bool rolls = GENERATE(false, true);
  std::vector<std::string> overrides{"params.n=4200", "body.floor.shape={ box = { size = [1, 1, 1] } }",
                                     "body.floor.position=[0, 0, -0.5]"};  // the floor's are of the generic loop
  if (rolls)
    for (const char* more : {"contact.smooth.rolling=spring", "contact.rolling_friction=0.1", "run.time_step=1.9e-5"})
      overrides.emplace_back(more);
  SceneRun run = run_scene("bed/bed.toml", overrides, rolls ? 3400 : 1600);
  REQUIRE(run.assembly->plan.fused_spheres);
  Simulation& sim = run.simulation();
  std::optional<ContactSet> first;
  for (const int threads : {1, 2, 3, 8}) {
    set_thread_count(threads);
    sim.start();  // no step: the same forces again, and none is published
    const std::size_t others = sim.work.contacts.size();
    sim.pipeline.contact_model->publish(sim.world, sim.work.contacts);
    const ContactSet& c = sim.work.contacts;
    CHECK((others > 50 && c.size() > others + 2000));
    for (std::size_t i = 1; i < c.size(); ++i)
      REQUIRE(std::tuple(c.a[i - 1], c.b[i - 1], c.feature[i - 1]) < std::tuple(c.a[i], c.b[i], c.feature[i]));
    CHECK((c.normal.size() == c.size() && c.force.size() == c.size() && c.moment.size() == (rolls ? c.size() : 0)));
    if (!first) first = c;
    CHECK(is_same(c, *first));
  }
  REQUIRE_FALSE(sim.advance(true));  // over no time springs stay as they were, whatever the bodies feel
  sim.pipeline.contact_model->publish(sim.world, sim.work.contacts);
  const ContactSet& c = sim.work.contacts;
  std::vector<Vec3> sum(sim.world.size(), Vec3::Zero());  // what contacts say the bodies feel
  for (std::size_t i = 0; i < c.size(); ++i) sum[c.a[i]] += c.force[i], sum[c.b[i]] -= c.force[i];
  double worst = 0.0, most = 0.0;
  for (Slot s = 0; s < sim.world.size(); ++s) {
    if (!sim.world.is_movable(s)) continue;
    worst = std::max(worst, (sum[s] - sim.world.force[s]).norm());
    most = std::max(most, sim.world.force[s].norm());
  }
  CHECK(worst < 1e-12 * most);
}
