// Finite elements: a graded block of trilinear hexahedra, contact at its nodes (node-to-surface) or integrated over
// them (surface-to-surface). A reference without a half-space kernel; a thousand times slower than boundary elements at
// the same error.
#include <algorithm>
#include <cmath>

#include "laws/wheel_rail/fem/elastic_block.h"
#include "laws/wheel_rail/fem/mesh_gaps.h"
#include "laws/wheel_rail/fem/surface_contact.h"
#include "laws/wheel_rail/normal/models.h"

namespace epafi {
namespace {

constexpr int default_across = 8;  // elements over the shorter axis: 1 s; 12 take 6 s for little gain
constexpr int most_across = 24;    // runs for minutes
constexpr double margin = 1.25;    // relative to the estimated patch
constexpr double reach = 6.0;
/// Growth of element size outside the patch. A finer mesh grows more slowly, else the grading limits its error: with
/// 1.5 throughout, the peak stays 0.9 % high at any resolution of the patch.
double growth_of(int across) { return std::pow(1.5, static_cast<double>(default_across) / across); }

/// Elements over the shorter axis of this width [m]. The grid of a case is meant for boundary elements; where it is too
/// fine for finite elements the default is used, with a note.
int elements_across(const NormalInput& in, double width, NormalPatch& p) {
  const double cell = std::min(in.dx, in.dy);
  if (!(cell > 0.0)) return default_across;
  const double written = std::max(2.0, std::round(width / cell));
  if (written <= most_across) return static_cast<int>(written);
  p.notes.push_back("the grid is too fine for finite elements, at most " + std::to_string(most_across) +
                    " across the patch; " + std::to_string(default_across) + " were taken");
  return default_across;
}

/// Centre, area and the ellipse of equal second moments; returns the pressure by candidate [Pa].
std::vector<double> set_place(const BlockMesh& mesh, const MeshGaps& gaps, const SurfaceContact& s,
                              const Eigen::VectorXd& tributary, std::size_t cells, NormalPatch& p) {
  std::vector<double> pressure(cells);
  double sx = 0.0, sy = 0.0, sxx = 0.0, syy = 0.0;
  for (Eigen::Index k = 0; k < tributary.size(); ++k) {
    const auto c = static_cast<std::size_t>(k);
    const double f = gaps.force()[k], x = mesh.candidate_x(c), y = mesh.candidate_y(c);
    pressure[c] = f / tributary[k];  // nodal values of pressures over the surface oscillate from node to node
    sx += f * x;
    sy += f * y;
    sxx += f * x * x;
    syy += f * y * y;
    if (s.p[k] > 0.0) p.area += tributary[k];
  }
  p.centre_x = sx / s.force;
  p.centre_y = sy / s.force;
  p.ellipse = {std::sqrt(5.0 * (sxx / s.force - p.centre_x * p.centre_x)),
               std::sqrt(5.0 * (syy / s.force - p.centre_y * p.centre_y))};
  return pressure;
}

std::vector<RegionPatch> solve(const NormalInput& in, Enforcement method, bool over_surface) {
  RegionPatch out = solve_semi_hertz(in).front();  // position and size of the patch
  NormalPatch& p = out.patch;
  const Ellipse e = p.ellipse;
  const double E = in.elastic.effective_modulus(), nu = in.elastic.poissons_ratio, cx = p.centre_x, cy = p.centre_y;
  const double peak_by_strips = p.max_pressure;
  p = NormalPatch{};
  const int across = elements_across(in, 2.0 * margin * std::min(e.a, e.b), p);
  const BlockMesh mesh = make_block_mesh(cx, cy, margin * e.a, margin * e.b, across, growth_of(across), reach);
  const Eigen::MatrixXd W = surface_flexibility(mesh, E * (1.0 - nu * nu), nu), M = surface_mass(mesh);
  const Eigen::VectorXd tributary = M.rowwise().sum();
  // default penalty compliance: 1/1000 of the elastic one, for both discretisations
  const double penalty = over_surface ? 10.0 * in.penalty * E / e.a : in.penalty * E * e.a;
  MeshGaps gaps(mesh, in.source, in.regions.front(),
                over_surface ? GapMethod::surface_to_surface : GapMethod::node_to_surface);
  const SurfaceContact s = gaps.solve(W, in.target, method, penalty);
  if (gaps.incomplete()) {
    p.reasons.push_back("the surfaces do not face each other all over the patch; choose a model of the whole gap");
    return {out};
  }
  const double hx = mesh.x[mesh.ix0 + 1] - mesh.x[mesh.ix0], hy = mesh.y[mesh.iy0 + 1] - mesh.y[mesh.iy0];
  const PatchGrid grid{mesh.ix1 - mesh.ix0, mesh.iy1 - mesh.iy0, hx, hy};
  const std::vector<double> pressure = set_place(mesh, gaps, s, tributary, grid.size(), p);
  p.normal_force = s.force;
  p.approach = s.approach;
  p.max_pressure = peak_pressure(grid, pressure);
  if (in.stresses)
    p.stress = std::make_shared<const BlockStress>(block_stresses(mesh, E * (1.0 - nu * nu), nu, gaps.force()));
  // measured against Hertz: 1 % in peak and approach from 8 elements on, up to 1.6 % in the peak over the surface
  p.error_estimate = (over_surface ? 0.02 : 0.01) * std::max(1.0, 64.0 / (across * across));
  // two pressure peaks need more elements than one (10 % off for S1002 on UIC60 under 82.5 kN)
  if (peak_by_strips > 0.0)
    p.error_estimate = std::max(p.error_estimate, std::abs(p.max_pressure / peak_by_strips - 1.0));
  if (!s.report.converged)
    p.reasons.push_back("contact did not settle: penetration " + std::to_string(1e9 * s.penetration) + " nm after " +
                        std::to_string(s.report.iterations) + " rounds");
  if (s.penetration > 1e-2 * s.approach)
    p.reasons.push_back("the penalty leaves a penetration of more than 1 % of the approach");
  if (across < 6) p.reasons.push_back("coarse grid: fewer than 6 elements across the patch");
  return {out};
}

}  // namespace

std::vector<RegionPatch> solve_fem(const NormalInput& in) { return solve(in, Enforcement::lagrange, false); }
std::vector<RegionPatch> solve_fem_penalty(const NormalInput& in) { return solve(in, Enforcement::penalty, false); }
std::vector<RegionPatch> solve_fem_augmented(const NormalInput& in) {
  return solve(in, Enforcement::augmented_lagrangian, false);
}
std::vector<RegionPatch> solve_fem_surface(const NormalInput& in) {
  return solve(in, Enforcement::augmented_lagrangian, true);
}

}  // namespace epafi
