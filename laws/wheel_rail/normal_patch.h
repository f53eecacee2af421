/// @file normal_patch.h  Result of a normal model: one patch with its ellipse, and for some models its pressures on a
/// grid.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "laws/wheel_rail/half_space/pressure_kernel.h"
#include "laws/wheel_rail/normal/hertz_ellipse.h"

namespace epafi {

struct BlockStress;

struct NormalPatch {
  Ellipse ellipse;            ///< of Hertz, or the one with the patch's second moments of pressure
  bool is_ellipse = true;     ///< no grid: the pressure is that of Hertz
  bool is_line = false;       ///< plane contact over the length 2 b, the ellipse a by b is its box
  bool runs_along = false;    ///< of a line: it lies along the track
  double normal_force = 0.0;  ///< [N]
  double approach = 0.0;      ///< [m]
  double max_pressure = 0.0;  ///< [Pa]
  double area = 0.0;          ///< [m^2]
  PatchGrid grid;
  double grid_x = 0.0, grid_y = 0.0;          ///< middle of the grid in the tangent plane [m]
  std::vector<double> pressure;               ///< by cell [Pa]; empty for an ellipse
  double centre_x = 0.0, centre_y = 0.0;      ///< centre of pressure in the tangent plane [m]
  std::shared_ptr<const BlockStress> stress;  ///< of finite elements, if asked for
  double error_estimate = 0.0;                ///< relative, of the peak pressure
  std::vector<std::string> reasons;           ///< why it is not valid; empty: valid
  std::vector<std::string> notes;             ///< deviations from the input that do not affect validity
};

NormalPatch patch_of_hertz(const HertzContact& contact);

/// Ellipse with the second moments of the pressure (a Hertzian one has <x^2> = a^2/5), centre of pressure, force.
void set_equivalent_ellipse(NormalPatch& patch);

}  // namespace epafi
