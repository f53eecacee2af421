#include <algorithm>
#include <cmath>

#include "laws/wheel_rail/half_space/normal.h"
#include "laws/wheel_rail/normal/models.h"

namespace epafi {
namespace {

constexpr double default_cells = 32.0;  // along the shorter axis
constexpr std::size_t multiple = 8;     // for three coarser grids
constexpr double most_default = 16384;  // cells of a grid chosen by default: 32 across, 16 times as long
constexpr double longest = 1.0;         // length of any patch [m]: a wheel is not longer
constexpr double most_cells = 4e6;      // of any grid: needs 2 GB

/// A window of the tangent plane of the deepest region.
struct Window {
  double x0, x1, y0, y1;
};

/// Window in which the undeformed surfaces interpenetrate at this approach; at twice the Hertzian approach it contains
/// every elastic patch.
Window interpenetration(const NormalInput& in, double approach) {
  const ContactRegion& r = in.regions.front();
  const double a = std::sqrt(2.0 * approach / r.curvature_x);
  if (r.profile.size() == 0) {
    const double b = std::sqrt(2.0 * approach / r.curvature_y);
    return {-a, a, -b, b};
  }
  Window w{0.0, 0.0, 1e9, -1e9};
  for (std::size_t k = 0; k < r.profile.size(); ++k) {
    const double depth = approach - r.profile.gap[k];
    if (depth <= 0.0) continue;
    const double half = std::sqrt(2.0 * depth / r.profile.curvature_x[k]), y = r.profile.y(k);
    w = {std::min(w.x0, r.profile.centre_x[k] - half), std::max(w.x1, r.profile.centre_x[k] + half),
         std::min(w.y0, y - r.profile.step), std::max(w.y1, y + r.profile.step)};
  }
  return w;
}

std::size_t cells_over(double length, double cell) {
  const auto n = static_cast<std::size_t>(std::ceil(length / cell));
  return std::max<std::size_t>(2 * multiple, (n + multiple - 1) / multiple * multiple);
}

HalfSpaceNormal solve_in(const NormalInput& in, const Window& w, double dx, double dy, const Separation& apart) {
  const std::size_t nx = cells_over(w.x1 - w.x0, dx), ny = cells_over(w.y1 - w.y0, dy);
  const double cx = 0.5 * (w.x0 + w.x1), cy = 0.5 * (w.y0 + w.y1);
  const GapField f = in.source.field(in.regions.front(), cx, cy, dx, dy, nx, ny);
  return solve_half_space_normal({nx, ny, dx, dy}, f.gap, in.elastic, in.target, 1e-6, apart.shifted(cy));
}

/// Shifted by less than a cell so that a cell is centred at the plane's origin: narrow patches then have the cells of
/// the reference, and the same ones on both sides of the track.
double aligned(double low, double high, double cell) {
  const double middle = 0.5 * (low + high);
  return (std::round(middle / cell - 0.5) + 0.5) * cell - middle;
}

/// Bounding box of the cells in contact, extended by one cell; false if it meets the edge of the grid.
bool contact_box(const HalfSpaceNormal& s, double cx, double cy, Window& w) {
  std::size_t i0 = s.grid.nx, i1 = 0, j0 = s.grid.ny, j1 = 0;
  for (std::size_t k = 0; k < s.pressure.size(); ++k) {
    if (!(s.pressure[k] > 0.0)) continue;
    i0 = std::min(i0, k % s.grid.nx);
    i1 = std::max(i1, k % s.grid.nx);
    j0 = std::min(j0, k / s.grid.nx);
    j1 = std::max(j1, k / s.grid.nx);
  }
  if (i0 > i1) return true;
  w = {cx + s.grid.x(i0) - 1.5 * s.grid.dx, cx + s.grid.x(i1) + 1.5 * s.grid.dx, cy + s.grid.y(j0) - 1.5 * s.grid.dy,
       cy + s.grid.y(j1) + 1.5 * s.grid.dy};
  return i0 > 0 && j0 > 0 && i1 + 1 < s.grid.nx && j1 + 1 < s.grid.ny;
}

RegionPatch unsolved(std::string why) {
  RegionPatch none;
  none.patch.reasons.push_back(std::move(why));
  none.patch.error_estimate = 1.0;
  return none;
}

/// Cells of the case, else square ones, 32 along the shorter side; elongated along a patch so slender that there would
/// be too many (many narrow patches side by side, on noise).
std::pair<double, double> cell_sizes(const NormalInput& in, const Window& w, double shorter) {
  double dx = shorter / default_cells, dy = dx;
  const double cells = (w.x1 - w.x0) / dx * ((w.y1 - w.y0) / dy);
  if (cells > most_default) (w.x1 - w.x0 > w.y1 - w.y0 ? dx : dy) *= cells / most_default;
  return {in.dx > 0.0 ? in.dx : dx, in.dy > 0.0 ? in.dy : dy};
}

/// The window fitted to the patch of a coarse solution.
Window fitted(const NormalInput& in, Window w, const Separation& apart) {
  HalfSpaceNormal coarse;
  bool inside = false;
  for (int n = 0; n < 4 && !inside; ++n) {
    const double dx = (w.x1 - w.x0) / 24.0, dy = (w.y1 - w.y0) / 24.0, cx = 0.5 * (w.x0 + w.x1),
                 cy = 0.5 * (w.y0 + w.y1);
    coarse = solve_in(in, w, dx, dy, apart);
    Window box = w;
    inside = contact_box(coarse, cx, cy, box);
    if (inside)
      w = box;
    else
      w = {w.x0 - 0.25 * (w.x1 - w.x0), w.x1 + 0.25 * (w.x1 - w.x0), w.y0 - 0.25 * (w.y1 - w.y0),
           w.y1 + 0.25 * (w.y1 - w.y0)};
  }
  return w;
}

void set_solution(const HalfSpaceNormal& s, const Window& w, NormalPatch& p) {
  p.grid = s.grid;
  p.pressure = s.pressure;
  set_equivalent_ellipse(p);
  p.grid_x = 0.5 * (w.x0 + w.x1);
  p.grid_y = 0.5 * (w.y0 + w.y1);
  p.centre_x += p.grid_x;
  p.centre_y += p.grid_y;
  p.normal_force = s.normal_force;
  p.approach = s.approach;
  p.max_pressure = s.max_pressure;
  p.area = s.area;
}

}  // namespace

std::vector<RegionPatch> solve_half_space(const NormalInput& in) {
  // a first window from Hertz (or, with profiles, from interpenetration), then one fitted to the patch of a coarse
  // solution
  const ContactRegion& r = in.regions.front();
  const double B = std::max(0.5 * r.curvature_y, 0.02 * r.curvature_x), E = in.elastic.effective_modulus();
  double approach =
      in.target.by_force ? hertz_of_force(0.5 * r.curvature_x, B, E, in.target.value).approach : in.target.value;
  // undeformed regions are nearer to each other: take their distance at the approach of this load, not of the window
  const Separation apart(overlaps_of(r.profile, in.approach > 0.0 ? in.approach : approach), in.influence);
  Window w = interpenetration(in, approach);
  // a gap that opens faster than by its curvature at the rigid point (noise, a kink) overlaps only at a larger approach
  double farther = std::max(approach, in.approach);
  for (int n = 0; n < 20 && !(w.x1 > w.x0 && w.y1 > w.y0); ++n, farther *= 2.0) w = interpenetration(in, farther);
  if (!(w.x1 > w.x0 && w.y1 > w.y0)) return {unsolved("nothing overlaps: the samples of the gap stay open")};
  if (!(w.x1 - w.x0 < longest && w.y1 - w.y0 < longest))
    return {unsolved("the gap does not open along the track: no patch of finite length")};
  w = fitted(in, w, apart);
  const double shorter = std::min(w.x1 - w.x0, w.y1 - w.y0) * (1.0 - 3.0 / 26.0);
  const auto [dx, dy] = cell_sizes(in, w, shorter);
  const double cells = (w.x1 - w.x0) / dx * ((w.y1 - w.y0) / dy);
  if (!(cells <= most_cells))
    return {unsolved("a grid of " + std::to_string(std::llround(std::min(cells, 1e15))) +
                     " cells is beyond 4 million; write a coarser grid")};
  const double sx = aligned(w.x0, w.x1, dx), sy = aligned(w.y0, w.y1, dy);
  w = {w.x0 + sx, w.x1 + sx, w.y0 + sy, w.y1 + sy};
  const HalfSpaceNormal s = solve_in(in, w, dx, dy, apart);

  RegionPatch out;
  NormalPatch& p = out.patch;
  set_solution(s, w, p);
  // second order: on 16 cells the peak of a Hertzian patch is 3e-4 off
  const double across = 2.0 * std::min(p.ellipse.a / dx, p.ellipse.b / dy);
  p.error_estimate = 0.1 / (across * across) + s.report.residual;
  if (!s.report.converged)
    p.reasons.push_back("conjugate gradients did not converge: change " + std::to_string(s.report.residual) +
                        " after " + std::to_string(s.report.iterations) + " steps");
  if (across < 8.0) p.reasons.push_back("coarse grid: fewer than 8 cells across the patch");
  Window box = w;
  if (!contact_box(s, 0.0, 0.0, box)) p.reasons.push_back("the patch meets the edge of the grid");
  const double steepest = std::max(std::abs(r.wheel_curvature), std::abs(r.rail_curvature));
  if (r.wheel_curvature * r.rail_curvature < 0.0 && p.ellipse.b * steepest > 0.1)
    p.reasons.push_back(
        "conformal contact: the surface turns by more than 0.1 rad over half the patch, the bodies are no half-spaces");
  return {out};
}

}  // namespace epafi
