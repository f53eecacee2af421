#include "laws/wheel_rail/fem/mesh_gaps.h"

#include <cmath>

#include "engine/units/registry.h"
#include "laws/factors.h"

namespace epafi {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

constexpr std::size_t finer = 6;  // refinement of the other surface: its chords then lie within 4e-4 of the approach
constexpr int most_evaluations = 6;
constexpr double settled = 1e-9;  // relative to the approach: largest motion of a node in the last iteration

/// Adds two triangles per cell of a grid of nodes that begins at `first`; cells with a NaN corner are left out. up:
/// counter-clockwise as seen from +z.
void add_grid(std::span<const Vec3> at, std::uint32_t first, std::size_t nx, std::size_t ny, bool up,
              std::vector<Triangle>& out) {
  const auto add = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
    if (at[p].allFinite() && at[q].allFinite() && at[r].allFinite())
      out.push_back(up ? Triangle{p, q, r} : Triangle{p, r, q});
  };
  for (std::size_t j = 0; j + 1 < ny; ++j)
    for (std::size_t i = 0; i + 1 < nx; ++i) {
      const auto k = first + static_cast<std::uint32_t>(j * nx + i), row = static_cast<std::uint32_t>(nx);
      add(k, k + 1, k + row + 1);
      add(k, k + row + 1, k + row);
    }
}

}  // namespace

MeshGaps::MeshGaps(const BlockMesh& mesh, const GapSource& source, const ContactRegion& region, GapMethod method)
    : method_(method), candidates_(static_cast<Eigen::Index>(mesh.candidates())) {
  for (std::size_t k = 0; k < mesh.candidates(); ++k) rest_.push_back({mesh.candidate_x(k), mesh.candidate_y(k), 0.0});
  const std::size_t nx = mesh.ix1 - mesh.ix0, ny = mesh.iy1 - mesh.iy0;
  const double dx = (mesh.x[mesh.ix0 + 1] - mesh.x[mesh.ix0]) / finer,
               dy = (mesh.y[mesh.iy0 + 1] - mesh.y[mesh.iy0]) / finer;
  // one cell of the block farther on every side
  const GapField h =
      source.field(region, 0.5 * (mesh.x[mesh.ix0] + mesh.x[mesh.ix1 - 1]),
                   0.5 * (mesh.y[mesh.iy0] + mesh.y[mesh.iy1 - 1]), dx, dy, finer * (nx + 1) + 1, finer * (ny + 1) + 1);
  const double cx = 0.5 * (mesh.x[mesh.ix0] + mesh.x[mesh.ix1 - 1]),
               cy = 0.5 * (mesh.y[mesh.iy0] + mesh.y[mesh.iy1 - 1]);
  for (std::size_t j = 0; j < h.ny; ++j)
    for (std::size_t i = 0; i < h.nx; ++i) rest_.push_back({cx + h.x(i), cy + h.y(j), -h.at(i, j)});
  std::vector<Triangle> other, own;
  add_grid(rest_, static_cast<std::uint32_t>(candidates_), h.nx, h.ny, true, other);  // normal points into the block
  add_grid(rest_, 0, nx, ny, false, own);
  incomplete_ = other.empty();
  if (!incomplete_) gaps_ = source.gaps_between(method, rest_, other, own, infinity);
}

/// gap + transfer W transfer^T p - approach level >= 0: at nodes one row per candidate, over the surface rows
/// integrated with the shape functions of the pressure.
SurfaceProblem MeshGaps::linearise(const Eigen::MatrixXd& W, const Eigen::VectorXd& displacement, double approach) {
  std::vector<Vec3> x = rest_;
  for (Eigen::Index k = 0; k < static_cast<Eigen::Index>(x.size()); ++k)
    x[static_cast<std::size_t>(k)].z() += k < candidates_ ? displacement[k] : approach;
  gaps_->evaluate(x, rows_);
  transfer_ = Eigen::MatrixXd::Zero(candidates_, candidates_);
  Eigen::VectorXd gap = Eigen::VectorXd::Zero(candidates_);
  for (std::size_t c = 0; c < rows_.gap.size(); ++c) {
    double at_rest = rows_.gap[c];
    const double nz = rows_.normal[c].z();
    std::array<Eigen::Index, 3> node{};
    std::array<double, 3> shape{};
    std::size_t own = 0;
    for (std::uint32_t r = rows_.begin[c]; r < rows_.begin[c + 1]; ++r) {
      const auto k = static_cast<Eigen::Index>(rows_.node[r]);
      if (k >= candidates_) continue;  // nodes of the rigid surface all move by the approach
      node[own] = k;
      shape[own++] = rows_.weight[r];
      at_rest -= nz * rows_.weight[r] * (displacement[k] - approach);
    }
    const bool integrate = method_ == GapMethod::surface_to_surface;
    for (std::size_t i = 0; i < own; ++i) {
      const double test = integrate ? rows_.area[c] * shape[i] : 1.0;
      gap[node[i]] += test * at_rest;
      for (std::size_t j = 0; j < own; ++j) transfer_(node[i], node[j]) += test * nz * shape[j];
    }
  }
  const Eigen::VectorXd level = transfer_.rowwise().sum();
  incomplete_ = !(level.minCoeff() > 0.0);
  return {product(product(transfer_, W), transfer_.transpose()), gap, level, level};
}

SurfaceContact MeshGaps::solve(const Eigen::MatrixXd& W, const NormalTarget& target, Enforcement method,
                               double penalty) {
  SurfaceContact out;
  Eigen::VectorXd displacement = Eigen::VectorXd::Zero(candidates_);
  force_ = displacement;
  for (int round = 0; round < most_evaluations && !incomplete_; ++round) {
    const SurfaceProblem problem = linearise(W, displacement, out.approach);
    if (incomplete_) break;
    const int before = out.report.iterations;
    out = solve_surface_contact(problem, target, method, penalty);
    out.report.iterations += before;
    force_ = transfer_.transpose() * out.p;
    const Eigen::VectorXd moved = W * force_;
    const double change = (moved - displacement).cwiseAbs().maxCoeff();
    displacement = moved;
    if (change < settled * out.approach) break;
  }
  return out;
}

}  // namespace epafi
