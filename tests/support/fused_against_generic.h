/// @file fused_against_generic.h  Two runs of one state, by the loop over spheres and by the generic loop.
#pragma once
#include "tests/support/same_contacts.h"
#include "tests/support/unfused.h"

namespace epafi::experiments {

/// Starts both from the state of `settled`; more than `least` contacts touch there.
inline void start_both(SceneRun& settled, SceneRun& fused, SceneRun& generic, std::uint64_t least) {
  copy_state(settled, fused);
  copy_state(settled, generic);
  fused.simulation().start();
  generic.simulation().start();
  REQUIRE(generic.simulation().work.report.touching > least);
}

/// After 20 steps: forces, ledger, virial and every contact agree. work_margin: absolute, of the work done [J].
inline void check_twenty_steps(SceneRun& fused, SceneRun& generic, double work_margin = 0.0) {
  for (int k = 0; k < 20; ++k) {
    REQUIRE_FALSE(fused.simulation().advance(k == 19));
    REQUIRE_FALSE(generic.simulation().advance(k == 19));
  }
  // rounding grows with the overlap's own: a gap of 1e-5 radii is known to 1e-11 of itself
  const Difference after = compare(fused, generic);
  CHECK(after.force < 1e-9);
  CHECK(after.torque < 1e-9);
  CHECK(after.velocity < 1e-10);
  const StepReport& report = fused.simulation().work.report;
  CHECK(report.touching == generic.simulation().work.report.touching);
  CHECK(report.elastic == Approx(generic.simulation().work.report.elastic).epsilon(1e-9));
  const Energy& now = fused.simulation().ledger.last();
  const Energy& expected = generic.simulation().ledger.last();
  CHECK(now.dissipated == Approx(expected.dissipated).epsilon(1e-7));
  CHECK(now.losses.viscous == Approx(expected.losses.viscous).epsilon(1e-7));
  CHECK(now.losses.frictional ==
        Approx(expected.losses.frictional).epsilon(1e-7).margin(1e-9 * expected.losses.viscous));
  CHECK(now.work == Approx(expected.work).epsilon(1e-7).margin(work_margin));
  if (const auto& cell = fused.simulation().world.cell)
    CHECK((cell->virial - generic.simulation().world.cell->virial).norm() < 1e-9 * cell->virial.norm());
  fused.simulation().pipeline.contact_model->publish(fused.simulation().world, fused.simulation().work.contacts);
  check_same_contacts(fused.simulation().work.contacts, generic.simulation().work.contacts);
}

}  // namespace epafi::experiments
