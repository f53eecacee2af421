#include "viz_export/measures/count_measure.h"

#include "engine/threads/parallel.h"

namespace epafi {

CountMeasure::CountMeasure(MeasureSetup setup)
    : setup_(std::move(setup)),
      volumes_(setup_.shapes),
      region_(setup_.parameters),
      everywhere_(!setup_.parameters.has("region.box.min")) {
  if (!setup_.parameters.has("plane.normal")) return;
  normal_ = setup_.parameters.vec3("plane.normal");
  point_ = setup_.parameters.vec3("plane.point");
}

bool CountMeasure::counts(const World& world, const MeasureRegion& region, Slot s) const {
  const Vec3& x = world.position[s];
  if (normal_ && (x - point_).dot(*normal_) < 0.0) return false;
  return everywhere_ || region.holds(MeasureRegion::in_cell(world, x));
}

void CountMeasure::sample(const StepView& view, std::vector<double>& values) {
  const World& w = view.world;
  const MeasureRegion region = region_.now(w);
  volumes_.find(w);
  const bool named = !setup_.bodies.empty();
  const std::size_t count = named ? setup_.bodies[0].size() : w.size();
  const Sum3 sum = block_sum<Sum3>(count, [&](std::size_t i) -> Sum3 {
    const Slot s = named ? w.slot_of(setup_.bodies[0][i]) : static_cast<Slot>(i);
    if (s == no_slot || (!named && !w.is_movable(s)) || !counts(w, region, s)) return {};
    return {1.0, w.is_movable(s) ? 1.0 / w.inverse_mass[s] : 0.0, volumes_.of(w.shape[s])};
  });
  values = {sum.a, sum.b, sum.c};
}

}  // namespace epafi
