/// @file body_measures.h  Position, velocity, angular velocity and drift of a body or the mean of a group.
#pragma once
#include "viz_export/measures/measure.h"

namespace epafi {

enum class BodyQuantity { position, velocity, angular_velocity };

/// Components x, y, z.
class BodyMeasure final : public Measure {
 public:
  BodyMeasure(MeasureSetup setup, BodyQuantity quantity) : setup_(std::move(setup)), quantity_(quantity) {}
  std::vector<std::string> components() const override { return {"x", "y", "z"}; }
  void sample(const StepView& view, std::vector<double>& values) override;

 private:
  MeasureSetup setup_;
  BodyQuantity quantity_;
};

/// Sum of the contact forces on a body or group, contacts within the group cancel: x, y, z [N].
class ForceMeasure final : public Measure {
 public:
  explicit ForceMeasure(MeasureSetup setup) : setup_(std::move(setup)) {}
  std::vector<std::string> components() const override { return {"x", "y", "z"}; }
  ContactView wants_contacts() const override { return ContactView::pieces; }
  void sample(const StepView& view, std::vector<double>& values) override;

 private:
  MeasureSetup setup_;
};

/// distance: largest horizontal displacement of the bodies' centres since the start; sag: largest downward one [m].
/// Horizontal is across gravity; z is up where there is none. With a second list of bodies: seen from its body, which
/// carries the starting places along and turns them with it; no numbers once that body is gone.
class DriftMeasure final : public Measure {
 public:
  explicit DriftMeasure(MeasureSetup setup) : setup_(std::move(setup)) {}
  std::vector<std::string> components() const override { return {"distance", "sag"}; }
  void sample(const StepView& view, std::vector<double>& values) override;
  void visit(StateVisitor& visitor, const std::string& prefix) override { visitor.column(prefix + "/start", start_); }

 private:
  Slot reference_in(const World& world) const;
  Vec3 carried(const World& world, const Vec3& place) const;
  Vec3 seen(const World& world, const Vec3& place) const;
  MeasureSetup setup_;
  std::vector<Vec3> start_;  ///< by place in setup_.bodies[0], in the axes of the body that it is seen from
};

}  // namespace epafi
