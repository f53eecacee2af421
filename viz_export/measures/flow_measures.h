/// @file flow_measures.h  Mass through a plane, and the energies of the ledger.
#pragma once
#include <limits>

#include "viz_export/measures/measure.h"

namespace epafi {

/// mass [kg] that went through the plane in the direction of its normal since the start (backwards counts negative),
/// rate [kg/s] over the last `window` seconds. Bodies that enter or are removed between two samples are counted at that
/// time, so the mass does not depend on the sampling interval.
class MassFlow final : public Measure {
 public:
  explicit MassFlow(MeasureSetup setup);
  std::vector<std::string> components() const override { return {"rate", "mass"}; }
  void sample(const StepView& view, std::vector<double>& values) override;
  void bodies_come(const World& world, std::size_t first) override;
  void bodies_leave(const World& world, std::span<const BodyId> bodies) override;
  void visit(StateVisitor& visitor, const std::string& prefix) override;

 private:
  int level(const World& world, Slot s) const;
  double passed(const World& world, Slot s);

  MeasureSetup setup_;
  Vec3 point_, normal_;
  double window_;
  double mass_ = 0;
  static constexpr int unseen = std::numeric_limits<int>::min();
  std::vector<int> level_;              ///< by body id: planes passed
  std::vector<double> times_, masses_;  ///< samples of the last window
};

/// Components kinetic, potential, elastic, dissipated, work [J], relative_error, and the parts of what smooth contacts
/// dissipated: viscous, frictional, plastic, adhesive [J]; NaN under non-smooth contact, where one impulse does it all.
class EnergyMeasure final : public Measure {
 public:
  std::vector<std::string> components() const override {
    return {"kinetic",        "potential", "elastic",    "dissipated", "work",
            "relative_error", "viscous",   "frictional", "plastic",    "adhesive"};
  }
  bool wants_energy() const override { return true; }
  bool wants_bodies() const override { return false; }
  void sample(const StepView& view, std::vector<double>& values) override {
    const Energy& e = view.ledger.last();
    values = {e.kinetic, e.potential, e.elastic, e.dissipated, e.work, view.ledger.relative_error()};
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const Losses& l = e.losses;
    if (view.report.has_solver)
      values.insert(values.end(), 4, nan);
    else
      values.insert(values.end(), {l.viscous, l.frictional, l.plastic, l.adhesive});
  }
};

}  // namespace epafi
