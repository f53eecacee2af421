/// @file tangential.h  Frictional contact of two half-spaces with the normal pressure known (Kalker 1990, chapter 4):
/// steady rolling, one step of transient rolling, or a shift. Semismooth Newton on the natural map of stick and slip,
/// its linear systems by GMRES with FFT convolution: 6 to 15 Newton steps whatever the grid, where Gauss-Seidel
/// diverges without relaxation.
#pragma once
#include <span>
#include <vector>

#include "engine/step/report.h"
#include "laws/wheel_rail/half_space/traction_kernel.h"
#include "laws/wheel_rail/rolling.h"

namespace epafi {

/// Bound of the traction on a grid: mu times the mean pressure of each cell [Pa]; 0 outside contact.
struct TractionBound {
  PatchGrid grid;
  std::vector<double> bound;
};

/// The same bound on grids ever twice as coarse, the finest last: Newton needs a start from a coarser grid.
using BoundLevels = std::vector<TractionBound>;

/// Bound of an ellipse that fills the grid exactly: nx by ny cells over 2 a by 2 b.
BoundLevels bound_of_ellipse(Ellipse ellipse, double normal_force, double friction, std::size_t nx, std::size_t ny);
/// Bound of any patch; leading edges between cells follow from p^2, which falls linearly towards an edge.
BoundLevels bound_of_pressure(const PatchGrid& grid, std::span<const double> pressure, double friction);

struct HalfSpaceTangential {
  PatchGrid grid;
  TangentialField traction;  ///< on the rail [Pa]
  TangentialField slip;      ///< rail against wheel: per rolled distance [-] in rolling, displacement [m] in a shift
  PatchForce force;
  double stick_share = 0.0;
  double frictional_power = 0.0;  ///< per rolling speed [N], or work of the shift [J]
  SolverReport report;            ///< residual: natural map over the bound, Euclidean
};

/// Steady rolling along x with this creepage; `start` may hold a traction field to begin with.
HalfSpaceTangential solve_steady_rolling(const TractionBound& bound, const ElasticPair& pair, const Creepage& creepage,
                                         const TangentialField* start = nullptr, double tolerance = 1e-5);
/// One cell of transient rolling after the traction field `before` (empty: none).
HalfSpaceTangential solve_rolling_step(const TractionBound& bound, const ElasticPair& pair, const Creepage& creepage,
                                       const TangentialField& before, double tolerance = 1e-5);
/// A start from rest without traction: `distance` [m], >= 0, of rolling cell by cell with this creepage; the force is
/// interpolated within the last cell, the field is that at its end.
HalfSpaceTangential solve_rolling_start(const TractionBound& bound, const ElasticPair& pair, const Creepage& creepage,
                                        double distance, double tolerance = 1e-5);
/// Tangential shift of the bodies by (x, y) [m] and a turn [rad] from rest (Cattaneo 1938), on the finest grid.
HalfSpaceTangential solve_shift(const BoundLevels& levels, const ElasticPair& pair, double x, double y, double turn,
                                double tolerance = 1e-6);

/// Steady rolling from the coarsest grid to the finest, and the limit of the force extrapolated from the last two (the
/// error of the force is of first order in the cell size). The field is that of the finest grid.
struct ExtrapolatedRolling {
  HalfSpaceTangential fine;
  PatchForce force;
  double error_estimate = 0.0;  ///< half the distance from the fine grid's force to the limit, over the bound [-]
};
/// `saturation`: linear force over the bound; where it is small, the tolerance is relative to it.
ExtrapolatedRolling solve_extrapolated(const BoundLevels& levels, const ElasticPair& pair, const Creepage& creepage,
                                       double saturation = 1.0);
/// The same after a start from rest, on the two finest grids.
ExtrapolatedRolling start_extrapolated(const BoundLevels& levels, const ElasticPair& pair, const Creepage& creepage,
                                       double distance);

}  // namespace epafi
