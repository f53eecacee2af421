/// @file beside_plane.h  What the tangent plane costs: the surface of a patch leaves its plane, and the rolling radius,
/// with it the longitudinal slip, is another in each row. FASTSIM with and without that slip tells the force it makes.
#pragma once
#include <vector>

#include "laws/wheel_rail/tangential_models.h"

namespace epafi {

/// Longitudinal slip of the surface beyond that of its plane, at even steps across the track, linear between them.
struct SlipBesidePlane {
  double first = 0.0, step = 1.0;  ///< y of the first value, from the middle of the patch's grid or ellipse [m]
  std::vector<double> value;       ///< [-]; empty: none
  double at(double y) const;
};

/// Change of the force by that slip over mu N [-]: 0 without slip. Right to FASTSIM's own tenth or so of the change.
double force_beside_plane(const TangentialInput& in, const SlipBesidePlane& slip);

}  // namespace epafi
