#include "laws/wheel_rail/half_space/normal.h"

#include <algorithm>
#include <cmath>

#include "engine/units/error.h"

namespace epafi {
namespace {

constexpr std::size_t coarsest = 24;  // cells along the shorter side of the coarsest multigrid level
constexpr int most_iterations = 500;

double sum_of(std::span<const double> v) {
  double s = 0.0;
  for (const double x : v) s += x;
  return s;
}

/// Gap averaged over two by two cells.
std::vector<double> coarse_gap(const PatchGrid& grid, std::span<const double> gap) {
  const std::size_t cx = grid.nx / 2, cy = grid.ny / 2;
  std::vector<double> out(cx * cy);
  for (std::size_t j = 0; j < cy; ++j) {
    for (std::size_t i = 0; i < cx; ++i) {
      const std::size_t k = 2 * j * grid.nx + 2 * i;
      out[j * cx + i] = 0.25 * (gap[k] + gap[k + 1] + gap[k + grid.nx] + gap[k + grid.nx + 1]);
    }
  }
  return out;
}

struct ActiveSet {
  std::vector<double> p, old, g, t, u, r;
  explicit ActiveSet(std::size_t n) : p(n, 0.0), old(n), g(n), t(n, 0.0), u(n), r(n) {}
};

/// Gap g = u + h - approach; where the force is prescribed the approach is the mean over the cells in contact.
double update_gap(ActiveSet& a, std::span<const double> h, const NormalTarget& target) {
  double approach = target.value;
  if (target.by_force) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.p.size(); ++i)
      if (a.p[i] > 0.0) {
        sum += a.u[i] + h[i];
        ++count;
      }
    approach = count ? sum / static_cast<double>(count) : *std::min_element(h.begin(), h.end());
  }
  for (std::size_t i = 0; i < a.p.size(); ++i) a.g[i] = a.u[i] + h[i] - approach;
  return approach;
}

/// Returns the sum of g^2 over contact; makes t conjugate to the last direction.
double new_direction(ActiveSet& a, double last, bool keep) {
  double G = 0.0;
  for (std::size_t i = 0; i < a.p.size(); ++i)
    if (a.p[i] > 0.0) G += a.g[i] * a.g[i];
  const double beta = keep && last > 0.0 ? G / last : 0.0;
  for (std::size_t i = 0; i < a.p.size(); ++i) a.t[i] = a.p[i] > 0.0 ? a.g[i] + beta * a.t[i] : 0.0;
  return G;
}

/// Step length along t; r = K t less its mean over contact where the force is prescribed.
double step_length(ActiveSet& a, bool by_force) {
  double mean = 0.0;
  if (by_force) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.p.size(); ++i)
      if (a.p[i] > 0.0) {
        mean += a.r[i];
        ++count;
      }
    mean = count ? mean / static_cast<double>(count) : 0.0;
  }
  double gt = 0.0, rt = 0.0;
  for (std::size_t i = 0; i < a.p.size(); ++i)
    if (a.p[i] > 0.0) {
      gt += a.g[i] * a.t[i];
      rt += (a.r[i] - mean) * a.t[i];
    }
  return rt > 0.0 ? gt / rt : 0.0;
}

/// Moves p along t, drops cells in tension, adds cells that overlap. True if the set of cells in contact only shrank.
bool move_pressures(ActiveSet& a, double tau) {
  bool same = true;
  for (std::size_t i = 0; i < a.p.size(); ++i) {
    if (a.p[i] > 0.0) {
      a.p[i] = std::max(0.0, a.p[i] - tau * a.t[i]);
    } else if (a.g[i] < 0.0) {
      a.p[i] = -tau * a.g[i];
      same = false;
    }
  }
  return same;
}

/// Displacements by convolution; group by group where the influence between regions is reduced by a factor.
class Yielding {
 public:
  Yielding(const PatchGrid& grid, const ElasticPair& pair, const Separation& apart)
      : grid_(grid), kernel_(grid, pair), apart_(apart) {
    if (apart.whole()) return;
    for (std::size_t j = 0; j < grid.ny; ++j) group_.push_back(apart.group(grid.y(j)));
    one_.resize(grid.size());
    part_.resize(grid.size());
  }
  double self() const { return kernel_.self(); }
  void apply(std::span<const double> p, std::span<double> u) {
    if (apart_.whole()) return kernel_.apply(p, u);
    std::fill(u.begin(), u.end(), 0.0);
    for (std::size_t g = 0; g < apart_.groups(); ++g) {
      for (std::size_t k = 0; k < p.size(); ++k) one_[k] = group_[k / grid_.nx] == g ? p[k] : 0.0;
      kernel_.apply(one_, part_);
      for (std::size_t k = 0; k < p.size(); ++k) u[k] += apart_.share(group_[k / grid_.nx], g) * part_[k];
    }
  }

 private:
  PatchGrid grid_;
  PressureKernel kernel_;
  const Separation& apart_;
  std::vector<std::size_t> group_;  ///< region of each row
  std::vector<double> one_, part_;
};

/// Data shared by all grid levels.
struct ElasticTask {
  const ElasticPair& pair;
  const NormalTarget& target;
  const Separation& apart;
};

void solve_on(const PatchGrid& grid, std::span<const double> gap, const ElasticTask& task, double tolerance,
              HalfSpaceNormal& out) {
  const NormalTarget& target = task.target;
  Yielding kernel(grid, task.pair, task.apart);
  ActiveSet a(grid.size());
  a.p = std::move(out.pressure);
  const double cell = grid.cell();
  if (!target.by_force && sum_of(a.p) <= 0.0) {
    for (std::size_t i = 0; i < a.p.size(); ++i)
      a.p[i] = std::max(0.0, (target.value - gap[i]) / (8.0 * kernel.self()));
  }
  double last = 0.0;
  bool keep = false;
  out.report = {false, 0, 1.0};
  while (out.report.iterations < most_iterations) {
    ++out.report.iterations;
    kernel.apply(a.p, a.u);
    out.approach = update_gap(a, gap, target);
    last = new_direction(a, last, keep);
    kernel.apply(a.t, a.r);
    a.old = a.p;
    keep = move_pressures(a, step_length(a, target.by_force));
    const double force = cell * sum_of(a.p);
    if (target.by_force && force > 0.0)
      for (double& p : a.p) p *= target.value / force;
    double change = 0.0, total = 0.0;
    for (std::size_t i = 0; i < a.p.size(); ++i) {
      change += std::abs(a.p[i] - a.old[i]);
      total += a.p[i];
    }
    out.report.residual = total > 0.0 ? change / total : 0.0;
    if (out.report.residual < tolerance) break;
  }
  out.report.converged = out.report.residual < tolerance;
  out.pressure = std::move(a.p);
}

void start_pressures(const PatchGrid& grid, std::span<const double> gap, const ElasticTask& task, double tolerance,
                     HalfSpaceNormal& out) {
  const NormalTarget& target = task.target;
  if (std::min(grid.nx, grid.ny) / 2 < coarsest || grid.nx % 2 || grid.ny % 2) {
    out.pressure.assign(grid.size(),
                        target.by_force ? target.value / (grid.cell() * static_cast<double>(grid.size())) : 0.0);
    return;
  }
  const PatchGrid half{grid.nx / 2, grid.ny / 2, 2.0 * grid.dx, 2.0 * grid.dy};
  const std::vector<double> gap_half = coarse_gap(grid, gap);
  HalfSpaceNormal coarse;
  start_pressures(half, gap_half, task, tolerance, coarse);
  solve_on(half, gap_half, task, std::max(tolerance, 1e-4), coarse);
  out.pressure.resize(grid.size());
  for (std::size_t j = 0; j < grid.ny; ++j) {
    for (std::size_t i = 0; i < grid.nx; ++i) {  // bilinear: 9 3 3 1 sixteenths
      const auto at = [&](std::ptrdiff_t x, std::ptrdiff_t y) {
        const std::ptrdiff_t sx = static_cast<std::ptrdiff_t>(half.nx), sy = static_cast<std::ptrdiff_t>(half.ny);
        return x < 0 || y < 0 || x >= sx || y >= sy ? 0.0 : coarse.pressure[static_cast<std::size_t>(y * sx + x)];
      };
      const auto x = static_cast<std::ptrdiff_t>(i / 2), y = static_cast<std::ptrdiff_t>(j / 2);
      const std::ptrdiff_t ex = i % 2 ? 1 : -1, ey = j % 2 ? 1 : -1;
      out.pressure[j * grid.nx + i] =
          (9.0 * at(x, y) + 3.0 * at(x + ex, y) + 3.0 * at(x, y + ey) + at(x + ex, y + ey)) / 16.0;
    }
  }
}

}  // namespace

HalfSpaceNormal solve_half_space_normal(const PatchGrid& grid, std::span<const double> gap, const ElasticPair& pair,
                                        const NormalTarget& target, double tolerance, const Separation& apart) {
  EPAFI_REQUIRE(gap.size() == grid.size(), "one gap per cell");
  HalfSpaceNormal out;
  out.grid = grid;
  const ElasticTask task{pair, target, apart};
  start_pressures(grid, gap, task, tolerance, out);
  solve_on(grid, gap, task, tolerance, out);
  out.normal_force = grid.cell() * sum_of(out.pressure);
  out.max_pressure = peak_pressure(grid, out.pressure);
  out.area = contact_area(grid, out.pressure);
  return out;
}

double peak_pressure(const PatchGrid& grid, std::span<const double> pressure) {
  const auto top = std::max_element(pressure.begin(), pressure.end());
  if (top == pressure.end() || !(*top > 0.0)) return 0.0;
  const auto k = static_cast<std::size_t>(top - pressure.begin());
  const std::size_t i = k % grid.nx, j = k / grid.nx;
  // p^2 is a quadratic near a Hertzian peak: through three cells each way
  const double middle = *top * *top;
  double rise = 0.0;
  const auto add = [&](double before, double after) {
    const double b = before * before, a = after * after, curvature = 2.0 * middle - a - b;
    if (before > 0.0 && after > 0.0 && curvature > 0.0) rise += (a - b) * (a - b) / (8.0 * curvature);
  };
  if (i > 0 && i + 1 < grid.nx) add(pressure[k - 1], pressure[k + 1]);
  if (j > 0 && j + 1 < grid.ny) add(pressure[k - grid.nx], pressure[k + grid.nx]);
  return std::sqrt(middle + rise);
}

double contact_area(const PatchGrid& grid, std::span<const double> pressure) {
  std::size_t cells = 0;
  for (const double p : pressure) cells += p > 0.0;
  return grid.cell() * static_cast<double>(cells);
}

}  // namespace epafi
