/// @file measure.h  A named quantity sampled during a run, with components. One file per kind, one line in
/// all_measures.h.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "detection/shape_store.h"
#include "engine/state/body_ids.h"
#include "engine/step/observer.h"
#include "engine/step/sources.h"
#include "engine/units/registry.h"

namespace epafi {

/// Bodies, parameters and times of a measure, resolved from the scene.
struct MeasureSetup {
  std::string name;
  Parameters parameters;        ///< fields of the kind
  std::vector<BodyIds> bodies;  ///< of `body` (one list) or `between` (two lists)
  const ShapeStore* shapes = nullptr;
  double interval = 0.0;         ///< [s]
  const Tally* tally = nullptr;  ///< of `outlet`
};

class Measure {
 public:
  virtual ~Measure() = default;
  virtual std::vector<std::string> components() const = 0;
  /// One value per component; NaN where the quantity does not exist at this moment.
  virtual void sample(const StepView& view, std::vector<double>& values) = 0;
  /// As Observer::bodies_come and bodies_leave.
  virtual void bodies_come(const World&, std::size_t /*first*/) {}
  virtual void bodies_leave(const World&, std::span<const BodyId>) {}
  virtual bool wants_energy() const { return false; }
  /// `sample` reads single bodies.
  virtual bool wants_bodies() const { return true; }
  /// Which single contacts `sample` reads: without it the set may lack those of the loop over spheres, or their other
  /// columns.
  virtual ContactView wants_contacts() const { return ContactView::none; }
  virtual void visit(StateVisitor&, const std::string& /*prefix*/) {}
};

/// Centre of the bodies' masses (plain mean for fixed ones), skipping those that were removed.
Vec3 mean_over(const World& world, const BodyIds& bodies, const std::function<Vec3(Slot)>& of);

}  // namespace epafi
