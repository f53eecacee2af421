/// @file strips.h  A contact patch as strips along the rolling direction, each cut into equal cells: what FASTSIM and
/// strip theory march over. Strips of an ellipse end on the ellipse, so that the edge costs no accuracy.
#pragma once
#include <cstdint>
#include <vector>

#include "laws/wheel_rail/half_space/pressure_kernel.h"
#include "laws/wheel_rail/rolling.h"

namespace epafi {

/// Cells [first, first + count) of a strip run from the leading edge (large x) backwards.
struct Strip {
  double y = 0.0;                        ///< of the middle line [m]
  double width = 0.0;                    ///< dy [m], > 0
  double leading = 0.0, trailing = 0.0;  ///< x of the ends [m], leading > trailing
  std::uint32_t first = 0, count = 0;
  double slip = 0.0;  ///< longitudinal creepage beyond that of the plane [-]; FASTSIM reads it

  double cell() const { return (leading - trailing) / count; }
  double x(std::uint32_t k) const { return leading - (k + 0.5) * cell(); }
};

struct StripPatch {
  std::vector<Strip> strips;
  std::vector<double> pressure;  ///< at the cells' centres, scaled so that the sum is the normal force [Pa]
  std::size_t cells() const { return pressure.size(); }
};

/// Shape of the pressure that bounds the traction.
enum class Bound { elliptic, parabolic };

/// `across` strips of `along` cells over an ellipse.
StripPatch strips_of_ellipse(Ellipse ellipse, double normal_force, std::uint32_t along, std::uint32_t across,
                             Bound bound);

/// One strip of `along` cells: a plane contact of half-width a and length 2 b.
StripPatch strip_of_line(Ellipse box, double normal_force, std::uint32_t along);
/// Every run of cells in contact along x; the parabolic bound is the square of the pressure, scaled to the same force.
StripPatch strips_of_field(const PatchGrid& grid, const std::vector<double>& pressure, Bound bound);

/// Tractions and slip of a solved patch, cell by cell, and what follows from them.
struct StripSolution {
  PatchForce force;
  double stick_share = 0.0;                    ///< area of stick over area of contact
  double frictional_power = 0.0;               ///< traction times slip over the patch, per rolling speed [N]
  std::vector<double> traction_x, traction_y;  ///< [Pa]; empty unless asked for
  std::vector<double> slip_x, slip_y;          ///< [-]; empty unless asked for, and where a law has stick without slip
  std::vector<std::uint8_t> sticks;            ///< 1 in stick; empty unless asked for
};

}  // namespace epafi
