/// @file count_measure.h  Number, mass and volume of bodies in a region or on one side of a plane.
#pragma once
#include <optional>

#include "viz_export/measures/bulk_measures.h"

namespace epafi {

/// number, mass [kg] and volume [m^3] of the bodies whose centres are in the region, and on the side of the plane that
/// its normal points to, where either is given. Of a body or group those that are there; without one all free bodies.
/// Fixed and driven bodies have no mass; those that a solid's overlaps count twice do so in its volume too.
class CountMeasure final : public Measure {
 public:
  explicit CountMeasure(MeasureSetup setup);
  std::vector<std::string> components() const override { return {"number", "mass", "volume"}; }
  void sample(const StepView& view, std::vector<double>& values) override;

 private:
  bool counts(const World& world, const MeasureRegion& region, Slot s) const;
  MeasureSetup setup_;
  ShapeVolumes volumes_;
  MeasureRegion region_;
  bool everywhere_;
  std::optional<Vec3> normal_;
  Vec3 point_ = Vec3::Zero();
};

}  // namespace epafi
