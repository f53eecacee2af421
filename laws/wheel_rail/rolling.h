/// @file rolling.h  Types of the tangential laws of rolling contact: creepage, the case, the resultant. x along the
/// track, y to the right, z down; creepage is that of the rail against the wheel over the speed, forces act on the rail
/// and oppose it: F_x = -G a b c11 xi in the limit of small creepage (Kalker 1990, section 2.2).
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "laws/wheel_rail/elastic_pair.h"
#include "laws/wheel_rail/normal/hertz_ellipse.h"

namespace epafi {

/// Rigid slip over rolling speed: (longitudinal - spin y, lateral + spin x).
struct Creepage {
  double longitudinal = 0.0;  ///< xi [-]
  double lateral = 0.0;       ///< eta [-]
  double spin = 0.0;          ///< phi [1/m]
};

/// Resultant of the tangential tractions on the rail: forces [N], moment about the patch's normal [N m].
struct PatchForce {
  double fx = 0.0, fy = 0.0, mz = 0.0;
};

/// One elliptic patch in rolling.
struct RollingCase {
  Ellipse ellipse;
  double normal_force = 0.0;  ///< N [N], > 0
  ElasticPair elastic;
  double friction = 0.0;  ///< mu [-], >= 0
  Creepage creepage;

  double bound() const { return friction * normal_force; }  ///< mu N [N]
};

}  // namespace epafi
