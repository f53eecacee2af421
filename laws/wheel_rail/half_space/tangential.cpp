#include "laws/wheel_rail/half_space/tangential.h"

#include <algorithm>
#include <cmath>

#include "engine/units/error.h"
#include "laws/wheel_rail/half_space/gmres.h"

namespace epafi {
namespace {

constexpr int most_newton = 60;
constexpr int restart = 60, most_products = 240;

/// Slip s(q) = free + K q on the cells in contact: zero in stick, opposite to the traction in slip.
struct SlipProblem {
  TractionKernel& kernel;
  const std::vector<double>& bound;
  std::vector<std::size_t> cells;  ///< with bound > 0
  std::vector<double> free;        ///< x and y by cell in contact
  TangentialField q, u;

  SlipProblem(TractionKernel& k, const TractionBound& b)
      : kernel(k), bound(b.bound), q(b.grid.size()), u(b.grid.size()) {
    for (std::size_t i = 0; i < bound.size(); ++i)
      if (bound[i] > 0.0) cells.push_back(i);
    free.assign(2 * cells.size(), 0.0);
  }
  /// out = K v on the cells in contact
  void apply(const std::vector<double>& v, std::vector<double>& out) {
    for (std::size_t c = 0; c < cells.size(); ++c) {
      q.x[cells[c]] = v[2 * c];
      q.y[cells[c]] = v[2 * c + 1];
    }
    kernel.apply(q, u);
    for (std::size_t c = 0; c < cells.size(); ++c) {
      out[2 * c] = u.x[cells[c]];
      out[2 * c + 1] = u.y[cells[c]];
    }
  }
};

/// Derivative of the projection on a disk at z: identity inside, (g/|z|)(I - z z^T/|z|^2) outside.
struct DiskDerivative {
  double xx, xy, yy;
};

void project_on_disk(double& x, double& y, double radius) {
  const double size = std::hypot(x, y);
  if (size > radius) {
    x *= radius / size;
    y *= radius / size;
  }
}

/// Residual F = q - P(q - R s) of stick and slip; also fills the derivative of P by cell. Returns |F| over the norm of
/// the bounds.
double natural_map(const SlipProblem& p, const std::vector<double>& q, const std::vector<double>& s, double R,
                   std::vector<double>& F, std::vector<DiskDerivative>& D) {
  double sum = 0.0, size = 0.0;
  for (std::size_t c = 0; c < p.cells.size(); ++c) {
    const double g = p.bound[p.cells[c]], zx = q[2 * c] - R * s[2 * c], zy = q[2 * c + 1] - R * s[2 * c + 1],
                 z = std::hypot(zx, zy);
    double px = zx, py = zy;
    D[c] = {1.0, 0.0, 1.0};
    if (z > g) {
      const double ex = zx / z, ey = zy / z, m = g / z;
      D[c] = {m * ey * ey, -m * ex * ey, m * ex * ex};
      px = g * ex;
      py = g * ey;
    }
    F[2 * c] = q[2 * c] - px;
    F[2 * c + 1] = q[2 * c + 1] - py;
    sum += F[2 * c] * F[2 * c] + F[2 * c + 1] * F[2 * c + 1];
    size += g * g;
  }
  return size > 0.0 ? std::sqrt(sum / size) : 0.0;
}

/// Newton's method on the natural map; q: start, then solution. Steps that leave the disk are projected onto it; a step
/// that increases the residual is halved at most twice (rare after a start from a coarser grid).
SolverReport newton(SlipProblem& p, std::vector<double>& q, std::vector<double>& s, double tolerance) {
  const std::size_t n = q.size();
  const double R = 1.0 / p.kernel.self();
  std::vector<double> F(n), dq(n), from;
  std::vector<DiskDerivative> D(n / 2);
  const auto residual_of = [&] {
    p.apply(q, s);
    for (std::size_t i = 0; i < n; ++i) s[i] += p.free[i];
    return natural_map(p, q, s, R, F, D);
  };
  SolverReport report{false, 0, residual_of()};
  while (!(report.converged = report.residual <= tolerance) && report.iterations < most_newton) {
    ++report.iterations;
    for (double& f : F) f = -f;
    const auto jacobian = [&](const std::vector<double>& v, std::vector<double>& out) {
      p.apply(v, out);
      for (std::size_t c = 0; c < n / 2; ++c) {
        const double zx = v[2 * c] - R * out[2 * c], zy = v[2 * c + 1] - R * out[2 * c + 1];
        out[2 * c] = v[2 * c] - D[c].xx * zx - D[c].xy * zy;
        out[2 * c + 1] = v[2 * c + 1] - D[c].xy * zx - D[c].yy * zy;
      }
    };
    gmres(jacobian, F, dq, std::clamp(0.1 * report.residual, 1e-4, 2e-2), restart, most_products);
    from = q;
    double residual = 0.0, step = 1.0;
    for (int halvings = 0; halvings < 3; ++halvings, step *= 0.5) {
      for (std::size_t c = 0; c < n / 2; ++c) {
        q[2 * c] = from[2 * c] + step * dq[2 * c];
        q[2 * c + 1] = from[2 * c + 1] + step * dq[2 * c + 1];
        project_on_disk(q[2 * c], q[2 * c + 1], p.bound[p.cells[c]]);
      }
      residual = residual_of();
      if (residual < report.residual) break;
    }
    report.residual = residual;
  }
  return report;
}

/// Runs Newton's method and collects the fields; per: rolled distance by which slip is divided.
HalfSpaceTangential solve(SlipProblem& p, const PatchGrid& grid, const TangentialField* start, double per,
                          double tolerance) {
  const std::size_t n = p.cells.size();
  std::vector<double> q(2 * n, 0.0), s(2 * n, 0.0);
  for (std::size_t c = 0; c < n; ++c) {
    const double g = p.bound[p.cells[c]];
    if (start && start->size() == grid.size()) {
      q[2 * c] = start->x[p.cells[c]];
      q[2 * c + 1] = start->y[p.cells[c]];
    } else {  // full slip, against the rigid slip
      const double size = std::hypot(p.free[2 * c], p.free[2 * c + 1]);
      if (size > 0.0) {
        q[2 * c] = -g * p.free[2 * c] / size;
        q[2 * c + 1] = -g * p.free[2 * c + 1] / size;
      }
    }
    project_on_disk(q[2 * c], q[2 * c + 1], g);
  }
  HalfSpaceTangential out;
  out.grid = grid;
  out.traction = out.slip = TangentialField(grid.size());
  out.report = newton(p, q, s, tolerance);
  std::size_t stick = 0;
  for (std::size_t c = 0; c < n; ++c) {
    const std::size_t i = p.cells[c];
    const double qx = q[2 * c], qy = q[2 * c + 1], x = grid.x(i % grid.nx), y = grid.y(i / grid.nx);
    const bool sticks = std::hypot(qx, qy) < p.bound[i] * (1.0 - 1e-6);
    stick += sticks;
    out.traction.x[i] = qx;
    out.traction.y[i] = qy;
    if (!sticks) {
      out.slip.x[i] = s[2 * c] / per;
      out.slip.y[i] = s[2 * c + 1] / per;
      out.frictional_power += grid.cell() * (std::abs(qx * out.slip.x[i]) + std::abs(qy * out.slip.y[i]));
    }
    out.force.fx += grid.cell() * qx;
    out.force.fy += grid.cell() * qy;
    out.force.mz += grid.cell() * (x * qy - y * qx);
  }
  out.stick_share = n ? static_cast<double>(stick) / static_cast<double>(n) : 0.0;
  return out;
}

/// Rigid slip over one cell, half a cell ahead of the centre, where the difference of displacements is taken.
void set_rigid_slip(SlipProblem& p, const PatchGrid& grid, const Creepage& c) {
  for (std::size_t k = 0; k < p.cells.size(); ++k) {
    const double x = grid.x(p.cells[k] % grid.nx) + 0.5 * grid.dx, y = grid.y(p.cells[k] / grid.nx);
    p.free[2 * k] = (c.longitudinal - c.spin * y) * grid.dx;
    p.free[2 * k + 1] = (c.lateral + c.spin * x) * grid.dx;
  }
}

/// Start values: tractions of full stick; the bound later cuts off their singular edge. From full slip Newton's method
/// does not find a narrow ring of slip.
TangentialField stuck_tractions(SlipProblem& p) {
  std::vector<double> b = p.free, q;
  for (double& v : b) v = -v;
  gmres([&](const std::vector<double>& v, std::vector<double>& out) { p.apply(v, out); }, b, q, 1e-3, restart,
        most_products);
  TangentialField out(p.q.size());
  for (std::size_t c = 0; c < p.cells.size(); ++c) {
    out.x[p.cells[c]] = q[2 * c];
    out.y[p.cells[c]] = q[2 * c + 1];
  }
  return out;
}

/// Start values: tractions of a grid of half the resolution, interpolated bilinearly.
TangentialField refine(const TangentialField& coarse, const PatchGrid& from, const PatchGrid& to) {
  TangentialField fine(to.size());
  const auto at = [&](const std::vector<double>& v, std::ptrdiff_t x, std::ptrdiff_t y) {
    const auto nx = static_cast<std::ptrdiff_t>(from.nx), ny = static_cast<std::ptrdiff_t>(from.ny);
    return v[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(y, 0, ny - 1) * nx +
                                      std::clamp<std::ptrdiff_t>(x, 0, nx - 1))];
  };
  for (std::size_t k = 0; k < to.size(); ++k) {
    const double fx = to.x(k % to.nx) / from.dx + 0.5 * static_cast<double>(from.nx) - 0.5;
    const double fy = to.y(k / to.nx) / from.dy + 0.5 * static_cast<double>(from.ny) - 0.5;
    const auto i = static_cast<std::ptrdiff_t>(std::floor(fx)), j = static_cast<std::ptrdiff_t>(std::floor(fy));
    const double u = fx - static_cast<double>(i), v = fy - static_cast<double>(j);
    const auto mix = [&](const std::vector<double>& c) {
      return (1 - v) * ((1 - u) * at(c, i, j) + u * at(c, i + 1, j)) +
             v * ((1 - u) * at(c, i, j + 1) + u * at(c, i + 1, j + 1));
    };
    fine.x[k] = mix(coarse.x);
    fine.y[k] = mix(coarse.y);
  }
  return fine;
}

}  // namespace

HalfSpaceTangential solve_steady_rolling(const TractionBound& b, const ElasticPair& pair, const Creepage& creepage,
                                         const TangentialField* start, double tolerance) {
  TractionKernel kernel(b.grid, pair, KernelKind::difference);
  SlipProblem p(kernel, b);
  set_rigid_slip(p, b.grid, creepage);
  return solve(p, b.grid, start, b.grid.dx, tolerance);
}

namespace {

/// One rolling step of one cell, with kernels made once.
HalfSpaceTangential roll_on(TractionKernel& here, TractionKernel& ahead, const TractionBound& b,
                            const Creepage& creepage, const TangentialField& before, double tolerance) {
  SlipProblem p(here, b);
  set_rigid_slip(p, b.grid, creepage);
  const bool rolled = before.size() == b.grid.size();
  if (rolled) {
    TangentialField old(b.grid.size());
    ahead.apply(before, old);
    for (std::size_t c = 0; c < p.cells.size(); ++c) {
      p.free[2 * c] -= old.x[p.cells[c]];
      p.free[2 * c + 1] -= old.y[p.cells[c]];
    }
  }
  return solve(p, b.grid, rolled ? &before : nullptr, b.grid.dx, tolerance);
}

/// Richardson limit of two grids with error of first order, within Coulomb's bound. The error estimate, relative to the
/// bound, is half its distance to the fine grid, but at least that of the stepped edge of the patch: two grids may
/// agree by chance (ellipses of a/b = 0.6 and 0.8 on 32 cells: to 1e-4 at an error of 1e-2).
double set_limit(const TractionBound& b, const PatchForce& fine, const PatchForce& coarse, PatchForce& limit) {
  limit = {2.0 * fine.fx - coarse.fx, 2.0 * fine.fy - coarse.fy, 2.0 * fine.mz - coarse.mz};
  double size = 0.0;
  for (const double g : b.bound) size += g * b.grid.cell();
  const double length = std::hypot(limit.fx, limit.fy);
  if (length > size) {
    limit.fx *= size / length;
    limit.fy *= size / length;
  }
  if (!(size > 0.0)) return 0.0;
  constexpr double edge =
      0.7;  // error by the stepped edge for a vanishing force, times the cells along the shorter side
  const double share = std::min(1.0, length / size), cells = static_cast<double>(std::min(b.grid.nx, b.grid.ny));
  return std::max(0.5 * std::hypot(limit.fx - fine.fx, limit.fy - fine.fy) / size,
                  edge / cells * share * (1.0 - share));
}

}  // namespace

HalfSpaceTangential solve_rolling_step(const TractionBound& b, const ElasticPair& pair, const Creepage& creepage,
                                       const TangentialField& before, double tolerance) {
  TractionKernel here(b.grid, pair, KernelKind::here), ahead(b.grid, pair, KernelKind::ahead);
  return roll_on(here, ahead, b, creepage, before, tolerance);
}

HalfSpaceTangential solve_rolling_start(const TractionBound& b, const ElasticPair& pair, const Creepage& creepage,
                                        double distance, double tolerance) {
  TractionKernel here(b.grid, pair, KernelKind::here), ahead(b.grid, pair, KernelKind::ahead);
  const double cells = std::max(0.0, distance / b.grid.dx), whole = std::floor(cells), part = cells - whole;
  HalfSpaceTangential last, now;
  const auto steps = static_cast<std::size_t>(part > 0.0 ? whole + 1.0 : whole);
  for (std::size_t k = 0; k < steps; ++k) {
    last = std::move(now);
    now = roll_on(here, ahead, b, creepage, last.traction, tolerance);
    if (!now.report.converged) return now;
  }
  if (now.traction.size() == 0) {
    now.traction = now.slip = TangentialField(b.grid.size());
    now.grid = b.grid;
  }
  const auto between = [&](double from, double to) { return part > 0.0 ? from + part * (to - from) : to; };
  now.force = {between(last.force.fx, now.force.fx), between(last.force.fy, now.force.fy),
               between(last.force.mz, now.force.mz)};
  return now;
}

HalfSpaceTangential solve_shift(const BoundLevels& levels, const ElasticPair& pair, double x, double y, double turn,
                                double tolerance) {
  HalfSpaceTangential out;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const TractionBound& b = levels[k];
    TractionKernel kernel(b.grid, pair, KernelKind::here);
    SlipProblem p(kernel, b);
    for (std::size_t c = 0; c < p.cells.size(); ++c) {
      p.free[2 * c] = x - turn * b.grid.y(p.cells[c] / b.grid.nx);
      p.free[2 * c + 1] = y + turn * b.grid.x(p.cells[c] % b.grid.nx);
    }
    TangentialField start = k == 0 ? stuck_tractions(p) : refine(out.traction, levels[k - 1].grid, b.grid);
    out = solve(p, b.grid, &start, 1.0, tolerance);
  }
  return out;
}

ExtrapolatedRolling solve_extrapolated(const BoundLevels& levels, const ElasticPair& pair, const Creepage& creepage,
                                       double saturation) {
  EPAFI_REQUIRE(!levels.empty(), "a grid");
  ExtrapolatedRolling out;
  PatchForce last;
  constexpr double little = 0.1;  // relative to the bound: nearly full stick
  constexpr double least = 1e-6;  // relative to the bound: rounding error
  const double tolerance = 1e-5 * std::clamp(saturation, least, 1.0);
  const TangentialField nothing(levels[0].grid.size());
  for (std::size_t k = 0; k < levels.size(); ++k) {
    if (k == 0) {
      out.fine = solve_steady_rolling(levels[0], pair, creepage, saturation < little ? &nothing : nullptr, tolerance);
    } else {
      const TangentialField start = refine(out.fine.traction, levels[k - 1].grid, levels[k].grid);
      last = out.fine.force;
      out.fine = solve_steady_rolling(levels[k], pair, creepage, &start, tolerance);
    }
  }
  out.force = out.fine.force;
  if (levels.size() > 1) out.error_estimate = set_limit(levels.back(), out.fine.force, last, out.force);
  return out;
}

ExtrapolatedRolling start_extrapolated(const BoundLevels& levels, const ElasticPair& pair, const Creepage& creepage,
                                       double distance) {
  EPAFI_REQUIRE(!levels.empty(), "a grid");
  ExtrapolatedRolling out;
  out.fine = solve_rolling_start(levels.back(), pair, creepage, distance);
  out.force = out.fine.force;
  if (levels.size() < 2) return out;
  const HalfSpaceTangential coarse = solve_rolling_start(levels[levels.size() - 2], pair, creepage, distance);
  out.error_estimate = set_limit(levels.back(), out.fine.force, coarse.force, out.force);
  return out;
}

}  // namespace epafi
