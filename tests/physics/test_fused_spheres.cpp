// The fast path of spheres against the generic loop, which is its reference: the same forces to rounding, the same
// ledger, the same contacts for observers; and the same bits for every thread count.
#include "detection/narrow/narrow_phase.h"
#include "engine/parallel.h"
#include "scenes/contact_setup.h"
#include "tests/support/catch.h"
#include "tests/support/scene_run.h"

using namespace epafi;
using namespace epafi::experiments;

namespace {

/// Spheres that fall into a box of planes, in contact and rolling after 1600 steps; side chosen so that three blocks
/// hold them.
const std::vector<std::string> small_bed{"params.n=2200"};

/// The floor as a box: its contacts take the generic loop beside the fused one.
const std::vector<std::string> bed_on_a_box{"params.n=2200", "body.floor.shape={ box = { size = [1, 1, 1] } }",
                                            "body.floor.position=[0, 0, -0.5]"};

SceneRun generic_bed(const std::vector<std::string>& overrides) {
  SceneRun run = prepare_scene(library("bed/bed.toml"), overrides);
  Assembly& a = *run.assembly;
  a.simulation->pipeline.narrow_phase =
      std::make_unique<BatchNarrowPhase>(*a.shapes, a.plan.reach, a.plan.needs.curvature);
  a.simulation->pipeline.contact_model = make_contact_model(a.scene);
  return run;
}

/// Bodies of `from` in `to`: both start there without springs.
void copy_state(SceneRun& from, SceneRun& to) {
  World &a = from.simulation().world, &b = to.simulation().world;
  for (std::uint32_t id = 0; id < a.ids_given(); ++id) {
    const Slot s = a.slot_of(static_cast<BodyId>(id)), t = b.slot_of(static_cast<BodyId>(id));
    b.position[t] = a.position[s], b.velocity[t] = a.velocity[s], b.angular_velocity[t] = a.angular_velocity[s];
  }
}

struct Difference {
  double force = 0, torque = 0, velocity = 0;
};

Difference compare(SceneRun& x, SceneRun& y) {
  World &a = x.simulation().world, &b = y.simulation().world;
  Difference worst, scale;
  for (std::uint32_t id = 0; id < a.ids_given(); ++id) {
    const Slot s = a.slot_of(static_cast<BodyId>(id)), t = b.slot_of(static_cast<BodyId>(id));
    if (!a.is_movable(s)) continue;
    worst.force = std::max(worst.force, (a.force[s] - b.force[t]).norm()),
    scale.force = std::max(scale.force, a.force[s].norm());
    worst.torque = std::max(worst.torque, (a.torque[s] - b.torque[t]).norm()),
    scale.torque = std::max(scale.torque, a.torque[s].norm());
    worst.velocity = std::max(worst.velocity, (a.velocity[s] - b.velocity[t]).norm()),
    scale.velocity = std::max(scale.velocity, a.velocity[s].norm());
  }
  return {worst.force / scale.force, worst.torque / scale.torque, worst.velocity / scale.velocity};
}

}  // namespace

TEST_CASE("the fused loop of spheres gives the forces, the ledger and the contacts of the generic loop",
          "[physics][fused]") {
  set_thread_count(2);
  const auto& overrides = GENERATE(small_bed, bed_on_a_box);
  SceneRun settled = run_scene("bed/bed.toml", overrides, 1600);
  REQUIRE(settled.assembly->plan.fused_spheres);
  SceneRun fused = prepare_scene(library("bed/bed.toml"), overrides), generic = generic_bed(overrides);
  copy_state(settled, fused), copy_state(settled, generic);
  fused.simulation().start(), generic.simulation().start();
  REQUIRE(generic.simulation().work.report.touching > 3000);
  CHECK(compare(fused, generic).force < 1e-12);  // sums of some ten terms, each to a few ulp of the largest
  for (int k = 0; k < 20; ++k) {
    REQUIRE_FALSE(fused.simulation().advance(k == 19));
    REQUIRE_FALSE(generic.simulation().advance(k == 19));
  }
  // rounding grows with the overlap's own: a gap of 1e-5 radii is known to 1e-11 of itself
  const Difference after = compare(fused, generic);
  CHECK(after.force < 1e-9);
  CHECK(after.torque < 1e-9);
  CHECK(after.velocity < 1e-10);
  const StepReport &r = fused.simulation().work.report, &q = generic.simulation().work.report;
  CHECK(r.touching == q.touching);
  CHECK(r.elastic == Approx(q.elastic).epsilon(1e-9));
  CHECK(fused.simulation().ledger.last().dissipated ==
        Approx(generic.simulation().ledger.last().dissipated).epsilon(1e-7));

  const ContactSet &c = fused.simulation().work.contacts, &d = generic.simulation().work.contacts;
  std::size_t k = 0;
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (!(d.gap[i] < 0)) continue;
    REQUIRE(k < c.size());
    REQUIRE(std::pair(c.a[k], c.b[k]) == std::pair(d.a[i], d.b[i]));
    CHECK(c.gap[k] == Approx(d.gap[i]).epsilon(1e-8));
    CHECK((c.normal[k] - d.normal[i]).norm() < 1e-12);
    CHECK((c.arm[k] - d.arm[i]).norm() < 1e-12);
    CHECK((c.force[k] - d.force[i]).norm() < 1e-8 * (1e-3 + d.force[i].norm()));
    ++k;
  }
  CHECK(k == c.size());
}

TEST_CASE("the fused loop of spheres gives the same bits for every thread count and after a Morton sort",
          "[physics][fused]") {
  std::vector<std::string> hashes;
  for (const int threads : {1, 2, 3, 8}) {
    set_thread_count(threads);
    hashes.push_back(run_scene("bed/bed.toml", small_bed, 1100).hash());
  }
  set_thread_count(1);
  for (const auto& h : hashes) CHECK(h == hashes.front());
}
