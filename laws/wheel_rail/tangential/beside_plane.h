/// @file beside_plane.h  Error of the tangent plane: the surface of a patch is not plane, so the rolling radius and the
/// longitudinal slip vary across it. FASTSIM with and without that slip gives the change of the force.
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
