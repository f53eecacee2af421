/// @file granular_measures.h  Granular measures: hysteresis of a contact, force chains, heaps, mixing, outlets.
#pragma once
#include <limits>
#include <utility>
#include <vector>

#include "viz_export/measures/measure.h"

namespace epafi {

/// Hysteresis of the deepest contact between two bodies: overlap [m], normal_force [N], and loop_area [J], the integral
/// of force over overlap since the contact began (trapezoid over the samples): what it has lost once it has ended.
/// Wants every step (interval = 0).
class HysteresisMeasure final : public Measure {
 public:
  explicit HysteresisMeasure(MeasureSetup setup) : setup_(std::move(setup)) {}
  std::vector<std::string> components() const override { return {"overlap", "normal_force", "loop_area"}; }
  ContactView wants_contacts() const override { return ContactView::all; }
  void sample(const StepView& view, std::vector<double>& values) override;
  void visit(StateVisitor& visitor, const std::string& prefix) override;

 private:
  MeasureSetup setup_;
  double overlap_ = 0, force_ = 0, area_ = 0;
};

/// Chains after Peters et al. (2005): bodies whose largest compressive stress is above the mean are linked where they
/// touch within 45 degrees of the direction of that stress of both; a chain has three bodies at least. chains, bodies,
/// longest (bodies of the largest), share (of all bodies); strong: part of contacts whose normal force is above the
/// mean (Radjai et al. 1996).
class ForceChains final : public Measure {
 public:
  explicit ForceChains(MeasureSetup setup) : shapes_(setup.shapes) {}
  std::vector<std::string> components() const override { return {"chains", "bodies", "longest", "share", "strong"}; }
  ContactView wants_contacts() const override { return ContactView::all; }
  void sample(const StepView& view, std::vector<double>& values) override;

 private:
  const ShapeStore* shapes_;
};

/// Slope of a heap. reach [m]: the distance from the axis within which 97 % of the mass lie; what lies farther out has
/// rolled off. The heap is cut into `bins` equal rings about `centre` (axis = "z": a cone; "x", "y": layers on both
/// sides of a ridge; without `bins` one mean diameter wide), and rings into fields one mean diameter long. The mean of
/// the highest tops of its fields is a ring's height: of the highest top alone chance would decide. A line is fitted to
/// the rings with the weight of their fields; those below 0.4 and above 0.8 of the greatest height count less, at 0.2
/// and 1 no more (sketch in docs/granular.md). angle [degrees], height [m] of the highest top above `centre`; NaN
/// without bodies. Gravity points down z.
class ReposeMeasure final : public Measure {
 public:
  explicit ReposeMeasure(MeasureSetup setup);
  std::vector<std::string> components() const override { return {"angle", "height", "reach"}; }
  void sample(const StepView& view, std::vector<double>& values) override;

 private:
  struct Top {
    double at = 0, height = -std::numeric_limits<double>::infinity();
  };
  struct Ring {
    double fields = 0, at = 0, height = 0;  ///< number of sectors with bodies; means of their highest points [m]
    double highest = -std::numeric_limits<double>::infinity();
  };
  double distance(const Vec3& x) const;
  double reach(const World& world) const;
  double mean_diameter(const World& world) const;
  long field(const Vec3& x, double ring_middle, double width) const;
  std::vector<Ring> surface(const World& world, double far) const;
  Vec3 centre_;
  std::string axis_;
  int bins_;  ///< 0: by the bodies
  const ShapeStore* shapes_;
};

/// Lacey's index (1954) of two groups over cubic cells of edge `cell` that hold bodies of either: 0 apart, 1 mixed by
/// chance; share: mean share of the first group.
class MixingMeasure final : public Measure {
 public:
  explicit MixingMeasure(MeasureSetup setup) : setup_(std::move(setup)), edge_(setup_.parameters.number("cell")) {}
  std::vector<std::string> components() const override { return {"lacey", "share"}; }
  void sample(const StepView& view, std::vector<double>& values) override;

 private:
  MeasureSetup setup_;
  double edge_;
};

/// Bodies removed by an outlet: count, mass [kg].
class OutletMeasure final : public Measure {
 public:
  explicit OutletMeasure(MeasureSetup setup) : tally_(setup.tally) {}
  std::vector<std::string> components() const override { return {"count", "mass"}; }
  void sample(const StepView&, std::vector<double>& values) override { values = {tally_->count, tally_->mass}; }

 private:
  const Tally* tally_;
};

}  // namespace epafi
