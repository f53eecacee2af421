/// @file bulk_measures.h  Measures of a region of a packing: stress, solid fraction, profiles over its height.
#pragma once
#include <cmath>
#include <limits>

#include "viz_export/measures/measure.h"
#include "viz_export/measures/shape_volumes.h"

namespace epafi {

/// Box of a measure, `region = { box = { min, max } }`; not written: the periodic cell as it is now, nothing where
/// space does not repeat along all axes.
struct MeasureRegion {
  bool whole_cell;
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();  ///< [m]
  explicit MeasureRegion(const Parameters& p) : whole_cell(!p.has("region.box.min")) {
    if (!whole_cell) {
      low = p.vec3("region.box.min");
      high = p.vec3("region.box.max");
    }
  }
  /// The present region.
  MeasureRegion now(const World& world) const {
    MeasureRegion r = *this;
    if (whole_cell && world.cell) {
      r.low = world.cell->low;
      r.high = world.cell->low + world.cell->size;
    }
    return r;
  }
  /// x, or where it stands in the periodic cell.
  static Vec3 in_cell(const World& world, Vec3 x) {
    for (int k = 0; world.cell && k < 3; ++k)
      if (world.cell->repeats[static_cast<std::size_t>(k)])
        x[k] -= std::floor((x[k] - world.cell->low[k]) / world.cell->size[k]) * world.cell->size[k];
    return x;
  }
  bool holds(const Vec3& x) const { return (x.array() >= low.array()).all() && (x.array() < high.array()).all(); }
  double volume() const { return (high - low).prod(); }
};

/// Stress of the contacts whose points lie in the region, by Love and Weber: sigma = 1/V sum f (x) l, f the force on A,
/// l from B's centre (a contact with a wall: from the contact point) to A's; compression positive, symmetric part [Pa].
/// pressure: a third of the trace. Motion of the bodies is left out: in a flow it adds rho v'v'.
class StressMeasure final : public Measure {
 public:
  explicit StressMeasure(MeasureSetup setup) : region_(setup.parameters) {}
  std::vector<std::string> components() const override { return {"pressure", "xx", "yy", "zz", "xy", "xz", "yz"}; }
  ContactView wants_contacts() const override { return ContactView::all; }
  void sample(const StepView& view, std::vector<double>& values) override;

 private:
  MeasureRegion region_;
};

/// fraction: volume of the free bodies in the region over its volume; a body that its faces cut counts by the part of
/// the sphere of equal volume that is inside (1000 points, 1e-2 of such a body). bodies: centres inside. Overlaps count
/// twice.
class SolidFractionMeasure final : public Measure {
 public:
  explicit SolidFractionMeasure(MeasureSetup setup) : region_(setup.parameters), volumes_(setup.shapes) {}
  std::vector<std::string> components() const override { return {"fraction", "bodies"}; }
  void sample(const StepView& view, std::vector<double>& values) override;

 private:
  MeasureRegion region_;
  ShapeVolumes volumes_;
};

/// Means by mass over `bins` layers of the region along `axis`: velocity_x_0, velocity_y_0, velocity_z_0, density_0
/// [kg/m^3], the next layer _1 ... Velocities are NaN in an empty layer.
class ProfileMeasure final : public Measure {
 public:
  explicit ProfileMeasure(MeasureSetup setup);
  std::vector<std::string> components() const override;
  void sample(const StepView& view, std::vector<double>& values) override;

 private:
  MeasureRegion region_;
  int axis_ = 2, bins_ = 10;
};

}  // namespace epafi
