/// @file contact_measures.h  One contact between two named bodies or groups, and the coordination number.
#pragma once
#include "viz_export/measures/measure.h"

namespace epafi {

/// Deepest contact between two groups: overlap [m], normal_force, tangential_force [N] (sums over their contacts), slip
/// [m/s], point_x, point_y, point_z [m], count. All 0, and the point NaN, where they do not touch.
class ContactMeasure final : public Measure {
 public:
  explicit ContactMeasure(MeasureSetup setup);
  std::vector<std::string> components() const override {
    return {"overlap", "normal_force", "tangential_force", "slip", "point_x", "point_y", "point_z", "count"};
  }
  ContactView wants_contacts() const override { return ContactView::pieces; }
  void sample(const StepView& view, std::vector<double>& values) override;

 private:
  MeasureSetup setup_;
  std::vector<char> side_;  ///< by body id: bit 0 in the first group, bit 1 in the second
};

/// number: contacts in which a free body takes part, per free body (2 N_cc + N_cw over N), counting pairs that touch;
/// without_rattlers: the same without rattlers, bodies of fewer than `least` contacts, taken away until none is left;
/// rattlers: how many. Balance takes 4 contacts without friction, 2 with it.
class Coordination final : public Measure {
 public:
  explicit Coordination(const MeasureSetup& setup) : least_(setup.parameters.number("least")) {}
  std::vector<std::string> components() const override { return {"number", "without_rattlers", "rattlers"}; }
  ContactView wants_contacts() const override { return ContactView::pieces; }
  void sample(const StepView& view, std::vector<double>& values) override;

 private:
  double least_;
};

}  // namespace epafi
