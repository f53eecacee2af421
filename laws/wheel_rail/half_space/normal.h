/// @file normal.h  Frictionless contact of two half-spaces on a grid: conjugate gradients on the active set (Polonsky
/// and Keer 1999) with FFT convolution, started from the solution on a grid twice as coarse. Exact for any gap on which
/// both bodies are half-spaces; wrong where the patch is not small against the radii (conformal contact).
#pragma once
#include <span>
#include <vector>

#include "engine/step/report.h"
#include "laws/wheel_rail/half_space/pressure_kernel.h"
#include "laws/wheel_rail/separation.h"

namespace epafi {

struct HalfSpaceNormal {
  PatchGrid grid;
  std::vector<double> pressure;  ///< [Pa], >= 0
  double normal_force = 0.0;     ///< [N]
  double approach = 0.0;         ///< [m]
  double max_pressure = 0.0;  ///< of the parabola through p^2 around the largest cell (exact for a Hertzian peak) [Pa]
  double area = 0.0;          ///< with the cells of the edge counted by the pressure of their neighbours [m^2]
  SolverReport report;        ///< residual: change of pressure in the last iteration, relative
};

/// Prescribed force or approach.
struct NormalTarget {
  bool by_force = true;
  double value = 0.0;  ///< force [N] or approach [m]
};

/// gap[i]: undeformed distance of the surfaces [m] at the cells of the grid, any origin of height when by force. Rows
/// of cells that `apart` puts into different groups (y from the grid's middle) press on each other with its share;
/// every group costs a convolution.
HalfSpaceNormal solve_half_space_normal(const PatchGrid& grid, std::span<const double> gap, const ElasticPair& pair,
                                        const NormalTarget& target, double tolerance = 1e-8,
                                        const Separation& apart = {});

/// The peak of a field of pressures and the area of contact, to second order in the cell size.
double peak_pressure(const PatchGrid& grid, std::span<const double> pressure);
double contact_area(const PatchGrid& grid, std::span<const double> pressure);

}  // namespace epafi
