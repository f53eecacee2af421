#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/units/error.h"
#include "laws/wheel_rail/half_space/tangential.h"

namespace epafi {
namespace {

using std::numbers::pi;

/// A stuck patch starts with vanishing traction at its leading edge. Cells whose centre is nearer to it than a quarter
/// cell are left out: then centres lie three quarters of a cell behind the edge on average, which makes piecewise
/// constant tractions with slips taken half a cell ahead of second order (as the quarter points of a vortex lattice
/// do). Their bound goes to the next cell.
constexpr double least_distance = 0.25;

void trim_leading_edge(TractionBound& b, std::size_t row, double edge) {
  const PatchGrid& g = b.grid;
  for (std::size_t i = g.nx; i-- > 0;) {
    double& bound = b.bound[row * g.nx + i];
    if (!(bound > 0.0)) continue;
    if (g.x(i) <= edge - least_distance * g.dx) return;
    if (i > 0 && b.bound[row * g.nx + i - 1] > 0.0) {
      b.bound[row * g.nx + i - 1] += bound;
      bound = 0.0;
    }
  }
}

/// Integral of sqrt(A^2 - x^2) from -A to x.
double half_disk(double x, double A) {
  const double t = std::clamp(x / A, -1.0, 1.0);
  return 0.5 * A * A * (t * std::sqrt(1.0 - t * t) + std::asin(t) + 0.5 * pi);
}

TractionBound ellipse_level(Ellipse e, double normal_force, double friction, std::size_t nx, std::size_t ny) {
  TractionBound b{{nx, ny, 2.0 * e.a / static_cast<double>(nx), 2.0 * e.b / static_cast<double>(ny)}, {}};
  b.bound.assign(nx * ny, 0.0);
  constexpr int lines = 8;  // lines per row for the mean over y; along x the mean is exact
  double sum = 0.0;
  for (std::size_t j = 0; j < ny; ++j) {
    for (int l = 0; l < lines; ++l) {
      const double y = (b.grid.y(j) + ((l + 0.5) / lines - 0.5) * b.grid.dy) / e.b,
                   A = e.a * std::sqrt(std::max(0.0, 1.0 - y * y));
      if (!(A > 0.0)) continue;
      for (std::size_t i = 0; i < nx; ++i) {
        const double x = b.grid.x(i), p = half_disk(x + 0.5 * b.grid.dx, A) - half_disk(x - 0.5 * b.grid.dx, A);
        b.bound[j * nx + i] += p;
        sum += p;
      }
    }
  }
  const double scale = sum > 0.0 ? friction * normal_force / (sum * b.grid.cell()) : 0.0;
  for (std::size_t j = 0; j < ny; ++j) {
    for (std::size_t i = 0; i < nx; ++i) b.bound[j * nx + i] *= scale;
    const double y = b.grid.y(j) / e.b;
    trim_leading_edge(b, j, e.a * std::sqrt(std::max(0.0, 1.0 - y * y)));
  }
  return b;
}

TractionBound pressure_level(const PatchGrid& grid, std::span<const double> pressure, double friction) {
  TractionBound b{grid, std::vector<double>(pressure.begin(), pressure.end())};
  for (double& g : b.bound) g *= friction;
  for (std::size_t j = 0; j < grid.ny; ++j) {
    for (std::size_t i = grid.nx; i-- > 0;) {
      const double p = pressure[j * grid.nx + i];
      if (!(p > 0.0)) continue;
      // p^2 falls linearly to the edge: from the outermost cell and the one behind it
      const double inner = i > 0 ? pressure[j * grid.nx + i - 1] : 0.0, drop = inner * inner - p * p;
      const double beyond = drop > 0.0 ? std::min(1.0, p * p / drop) : 0.5;
      trim_leading_edge(b, j, grid.x(i) + beyond * grid.dx);
      break;
    }
  }
  return b;
}

/// Grid levels down to this many cells along the shorter side.
constexpr std::size_t coarsest_bound = 8;

std::vector<PatchGrid> levels_of(PatchGrid grid) {
  std::vector<PatchGrid> all{grid};
  while (grid.nx % 2 == 0 && grid.ny % 2 == 0 && std::min(grid.nx, grid.ny) >= 2 * coarsest_bound) {
    grid = {grid.nx / 2, grid.ny / 2, 2.0 * grid.dx, 2.0 * grid.dy};
    all.insert(all.begin(), grid);
  }
  return all;
}

}  // namespace

BoundLevels bound_of_ellipse(Ellipse e, double normal_force, double friction, std::size_t nx, std::size_t ny) {
  EPAFI_REQUIRE(nx > 0 && ny > 0 && e.a > 0.0 && e.b > 0.0, "cells over an ellipse");
  BoundLevels all;
  for (const PatchGrid& g :
       levels_of({nx, ny, 2.0 * e.a / static_cast<double>(nx), 2.0 * e.b / static_cast<double>(ny)}))
    all.push_back(ellipse_level(e, normal_force, friction, g.nx, g.ny));
  return all;
}

BoundLevels bound_of_pressure(const PatchGrid& grid, std::span<const double> pressure, double friction) {
  std::vector<double> p(pressure.begin(), pressure.end());
  std::vector<PatchGrid> grids = levels_of(grid);
  BoundLevels all(grids.size());
  for (std::size_t level = grids.size(); level-- > 0;) {
    all[level] = pressure_level(grids[level], p, friction);
    if (level == 0) break;
    const PatchGrid &g = grids[level], &h = grids[level - 1];
    std::vector<double> half(h.size());
    for (std::size_t k = 0; k < half.size(); ++k) {
      const std::size_t c = 2 * (k / h.nx) * g.nx + 2 * (k % h.nx);
      half[k] = 0.25 * (p[c] + p[c + 1] + p[c + g.nx] + p[c + g.nx + 1]);
    }
    p = std::move(half);
  }
  return all;
}

}  // namespace epafi
