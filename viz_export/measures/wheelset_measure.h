/// @file wheelset_measure.h  A wheelset in the axes of the track: position, angles and the force on each wheel.
#pragma once
#include "viz_export/measures/measure.h"

namespace epafi {

/// Displacements [m] and angles [rad]; forces of the rails on the wheels along x, y, z of the track [N].
class WheelsetMeasure final : public Measure {
 public:
  explicit WheelsetMeasure(MeasureSetup setup) : setup_(std::move(setup)) {}
  std::vector<std::string> components() const override {
    return {"distance", "lateral", "vertical", "yaw",     "roll",    "left_x",
            "left_y",   "left_z",  "right_x",  "right_y", "right_z", "contacts"};
  }
  ContactView wants_contacts() const override { return ContactView::all; }
  void sample(const StepView& view, std::vector<double>& values) override;

 private:
  MeasureSetup setup_;
};

/// Amplitude of hunting: half of the lateral range of a wheelset within the last `window` [m].
class SwingMeasure final : public Measure {
 public:
  explicit SwingMeasure(MeasureSetup setup) : window_(setup.parameters.number("window")), place_(std::move(setup)) {}
  std::vector<std::string> components() const override { return {"amplitude"}; }
  void sample(const StepView& view, std::vector<double>& values) override;
  void visit(StateVisitor& visitor, const std::string& prefix) override {
    visitor.column(prefix + "/time", time_);
    visitor.column(prefix + "/lateral", lateral_);
  }

 private:
  double window_;
  WheelsetMeasure place_;
  std::vector<double> time_, lateral_;  ///< of the last window
};

}  // namespace epafi
