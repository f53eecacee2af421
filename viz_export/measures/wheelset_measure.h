/// @file wheelset_measure.h  A wheelset in the axes of the track: where it stands and what the rails do to each wheel.
#pragma once
#include "viz_export/measures/measure.h"

namespace epafi {

/// Displacements [m] and angles [rad]; forces of the rails on the wheels along x, y, z of the track [N].
class WheelsetMeasure final : public Measure {
 public:
  explicit WheelsetMeasure(MeasureSetup setup) : setup_(std::move(setup)) {}
  std::vector<std::string> components() const override {
    return {"distance", "lateral", "vertical", "yaw",     "roll",    "left_x", "left_y",
            "left_z",   "right_x", "right_y",  "right_z", "contacts"};
  }
  void sample(const StepView& view, std::vector<double>& values) override;

 private:
  MeasureSetup setup_;
};

}  // namespace epafi
