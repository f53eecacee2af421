/// @file shape_volumes.h  Volumes of shapes, each found once: that of a clump of balls takes 0.1 ms.
#pragma once
#include <cmath>
#include <limits>
#include <vector>

#include "detection/shape_store.h"
#include "engine/state/world.h"

namespace epafi {

class ShapeVolumes {
 public:
  explicit ShapeVolumes(const ShapeStore* shapes) : shapes_(shapes) {}
  /// Computes the volumes of all bodies in the world; call by one thread before parallel use.
  void find(const World& world) {
    for (const std::uint32_t packed : world.shape) {
      const ShapeRef shape{packed};
      if (known_.size() <= shape.type()) known_.resize(shape.type() + 1);
      std::vector<double>& column = known_[shape.type()];
      if (column.size() <= shape.index()) column.resize(shape.index() + 1, unknown);
      if (std::isnan(column[shape.index()])) column[shape.index()] = volume(shape);
    }
  }
  /// [m^3]; 0 of half-spaces and surfaces.
  double of(std::uint32_t packed) const { return known_[ShapeRef{packed}.type()][ShapeRef{packed}.index()]; }

 private:
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double volume(ShapeRef ref) const {
    return shapes_->with(ref, [](const auto& shape) {
      if constexpr (requires { shape.mass_properties(); })
        return shape.mass_properties().mass;  // at density 1
      else
        return 0.0;
    });
  }
  const ShapeStore* shapes_;
  std::vector<std::vector<double>> known_;  ///< by type and index
};

}  // namespace epafi
