#include "laws/wheel_rail/tangential/half_space_models.h"

#include <cmath>

namespace epafi {
namespace {

BoundLevels levels_of(const TangentialInput& in) {
  const NormalPatch& p = in.patch;
  return p.is_ellipse ? bound_of_ellipse(p.ellipse, p.normal_force, in.friction, in.cells.nx, in.cells.ny)
                      : bound_of_pressure(p.grid, p.pressure, in.friction);
}

double distance_of(const TangentialInput& in) { return in.distance > 0.0 ? in.distance : 2.0 * in.patch.ellipse.a; }

/// Force, error and fields of the finest grid as the result of a model.
TangentialOutcome outcome_of(const TangentialInput& in, const BoundLevels& levels, const HalfSpaceTangential& fine,
                             const PatchForce& force, double error) {
  TangentialOutcome out;
  out.force = force;
  out.stick_share = fine.stick_share;
  out.error_estimate = (levels.size() > 1 ? error : 0.1) + fine.report.residual;
  if (!fine.report.converged)
    out.reasons.push_back("Newton did not converge: residual " + std::to_string(fine.report.residual) + " after " +
                          std::to_string(fine.report.iterations) + " steps");
  if (out.error_estimate > 0.03)
    out.reasons.push_back("coarse grid: the forces of two grids differ by more than 0.03 mu N");
  if (std::abs(in.elastic.coupling) > most_coupling)
    out.reasons.push_back("unlike materials couple pressure and traction, which is left out");
  if (!in.store) return out;
  const PatchGrid& g = fine.grid;
  for (std::size_t k = 0; k < g.size(); ++k) {
    const double bound = levels.back().bound[k];
    if (!(bound > 0.0)) continue;
    out.map.x.push_back(g.x(k % g.nx));
    out.map.y.push_back(g.y(k / g.nx));
    out.map.pressure.push_back(bound / in.friction);
    out.map.traction_x.push_back(fine.traction.x[k]);
    out.map.traction_y.push_back(fine.traction.y[k]);
    out.map.slip_x.push_back(fine.slip.x[k]);
    out.map.slip_y.push_back(fine.slip.y[k]);
    out.map.sticks.push_back(fine.slip.x[k] == 0.0 && fine.slip.y[k] == 0.0);
  }
  return out;
}

}  // namespace

TangentialOutcome steady_half_space(const TangentialInput& in, double saturation) {
  const BoundLevels levels = levels_of(in);
  const ExtrapolatedRolling s = solve_extrapolated(levels, in.elastic, creepage_of_cells(in), saturation);
  return outcome_of(in, levels, s.fine, s.force, s.error_estimate);
}

TangentialOutcome starting_half_space(const TangentialInput& in) {
  const BoundLevels levels = levels_of(in);
  const ExtrapolatedRolling s = start_extrapolated(levels, in.elastic, creepage_of_cells(in), distance_of(in));
  return outcome_of(in, levels, s.fine, s.force, s.error_estimate);
}

TangentialOutcome shifted_half_space(const TangentialInput& in) {
  BoundLevels levels = levels_of(in);
  const Creepage c = creepage_of_cells(in);
  const double d = distance_of(in), bound = in.friction * in.patch.normal_force;
  const auto shifted = [&](const BoundLevels& on) {
    return solve_shift(on, in.elastic, d * c.longitudinal, d * c.lateral, d * c.spin);
  };
  const HalfSpaceTangential fine = shifted(levels);
  double error = 0.0;
  if (levels.size() > 1) {
    const PatchForce coarse = shifted(BoundLevels(levels.begin(), levels.end() - 1)).force;
    error = bound > 0.0 ? std::hypot(fine.force.fx - coarse.fx, fine.force.fy - coarse.fy) / bound : 0.0;
  }
  return outcome_of(in, levels, fine, fine.force, error);
}

}  // namespace epafi
