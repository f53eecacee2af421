#include "laws/wheel_rail/fem/elastic_block.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "laws/factors.h"

namespace epafi {
namespace {

using Stiffness = Eigen::Matrix<double, 24, 24>;
using std::numbers::pi;

using Strains = Eigen::Matrix<double, 6, 24>;

/// Stiffness matrix of isotropic elasticity for engineering shear strains.
Eigen::Matrix<double, 6, 6> elasticity(double E, double nu) {
  Eigen::Matrix<double, 6, 6> C = Eigen::Matrix<double, 6, 6>::Zero();
  const double lambda = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), G = E / (2.0 * (1.0 + nu));
  C.topLeftCorner<3, 3>().setConstant(lambda);
  for (int k = 0; k < 3; ++k) {
    C(k, k) += 2.0 * G;
    C(k + 3, k + 3) = G;
  }
  return C;
}

/// Strains xx, yy, zz, yz, xz, xy of a trilinear hexahedron of sides hx, hy, hz at xi in [-1, 1]^3; node n has the
/// corner bits (x, y, z) of n.
Strains strains_at(const double (&xi)[3], const double (&size)[3]) {
  Strains B = Strains::Zero();
  for (int n = 0; n < 8; ++n) {
    double d[3];
    for (int k = 0; k < 3; ++k) {
      d[k] = (n >> k & 1 ? 1.0 : -1.0) / size[k];
      for (int o = 0; o < 3; ++o)
        if (o != k) d[k] *= 0.5 * (1.0 + (n >> o & 1 ? xi[o] : -xi[o]));
    }
    const int c = 3 * n;
    B(0, c) = d[0];
    B(1, c + 1) = d[1];
    B(2, c + 2) = d[2];
    B(3, c + 1) = d[2];
    B(3, c + 2) = d[1];
    B(4, c) = d[2];
    B(4, c + 2) = d[0];
    B(5, c) = d[1];
    B(5, c + 1) = d[0];
  }
  return B;
}

/// Element stiffness, integrated by 2 x 2 x 2 Gauss points.
Stiffness element_stiffness(double hx, double hy, double hz, double E, double nu) {
  const Eigen::Matrix<double, 6, 6> C = elasticity(E, nu);
  Stiffness K = Stiffness::Zero();
  const double g = 0.57735026918962576, size[3] = {hx, hy, hz};
  for (int q = 0; q < 8; ++q) {
    const Strains B = strains_at({q & 1 ? g : -g, q & 2 ? g : -g, q & 4 ? g : -g}, size);
    K += B.transpose() * C * B * (hx * hy * hz / 8.0);
  }
  return K;
}

/// Boussinesq 1885: displacement at (x, y, z) inside a half-space from a unit force at the origin along z into it.
std::array<double, 3> boussinesq(double x, double y, double z, double E, double nu) {
  const double R = std::sqrt(x * x + y * y + z * z), s = (1.0 + nu) / (2.0 * pi * E);
  const double side = s * (z / (R * R * R) - (1.0 - 2.0 * nu) / (R * (R + z)));
  return {side * x, side * y, s * (z * z / (R * R * R) + 2.0 * (1.0 - nu) / R)};
}

/// Coordinates of grid planes: equal steps over [-a, a], then growing ones up to the reach.
std::vector<double> planes(double centre, double a, int cells, double growth, double reach) {
  std::vector<double> out;
  const double h = 2.0 * a / cells;
  for (int k = 0; k <= cells; ++k) out.push_back(centre - a + h * k);
  for (double step = h * growth; out.back() < centre + reach; step *= growth) {
    out.push_back(out.back() + step);
    out.insert(out.begin(), out.front() - step);
  }
  return out;
}

}  // namespace

BlockMesh make_block_mesh(double cx, double cy, double ax, double ay, int across, double growth, double reach) {
  const double h = 2.0 * std::min(ax, ay) / across, far = reach * std::max(ax, ay);
  const int nx = std::max(across, static_cast<int>(std::lround(2.0 * ax / h))),
            ny = std::max(across, static_cast<int>(std::lround(2.0 * ay / h)));
  BlockMesh m;
  m.x = planes(cx, ax, nx, growth, far);
  m.y = planes(cy, ay, ny, growth, far);
  m.z = {0.0};
  for (double step = h; m.z.back() < far; step *= growth) m.z.push_back(m.z.back() + step);
  m.ix0 = (m.x.size() - static_cast<std::size_t>(nx) - 1) / 2;
  m.ix1 = m.ix0 + static_cast<std::size_t>(nx) + 1;
  m.iy0 = (m.y.size() - static_cast<std::size_t>(ny) - 1) / 2;
  m.iy1 = m.iy0 + static_cast<std::size_t>(ny) + 1;
  return m;
}

namespace {

/// The block's equations. Its far faces are displaced as Boussinesq's half-space is by a unit force in the middle of
/// the candidate nodes.
struct BlockSystem {
  const BlockMesh& m;
  std::size_t nx, ny, nz;
  std::vector<int> number;    ///< number of each free node, -1 on far faces
  std::vector<double> given;  ///< displacement of far nodes per force [m/N]
  Eigen::VectorXd far_load;   ///< load on free nodes by these displacements, per force
  SparseFactor solver;

  BlockSystem(const BlockMesh& mesh, double E, double nu)
      : m(mesh),
        nx(mesh.x.size()),
        ny(mesh.y.size()),
        nz(mesh.z.size()),
        number(mesh.nodes(), -1),
        given(3 * mesh.nodes(), 0.0) {
    const int unknowns = number_nodes(E, nu);
    far_load = Eigen::VectorXd::Zero(3 * unknowns);
    std::vector<Eigen::Triplet<double>> entries;
    for (std::size_t k = 0; k + 1 < nz; ++k)
      for (std::size_t j = 0; j + 1 < ny; ++j)
        for (std::size_t i = 0; i + 1 < nx; ++i) add_element(i, j, k, E, nu, entries);
    Eigen::SparseMatrix<double> K(3 * unknowns, 3 * unknowns);
    K.setFromTriplets(entries.begin(), entries.end());
    solver.compute(K);
  }
  std::size_t node(std::size_t i, std::size_t j, std::size_t k) const { return (k * ny + j) * nx + i; }
  std::size_t corner(std::size_t i, std::size_t j, std::size_t k, std::size_t n) const {
    return node(i + (n & 1), j + (n >> 1 & 1), k + (n >> 2));
  }
  /// Degree of freedom of a candidate node along z.
  int dof(std::size_t c) const {
    const std::size_t width = m.ix1 - m.ix0;
    return 3 * number[node(m.ix0 + c % width, m.iy0 + c / width, 0)] + 2;
  }

 private:
  int number_nodes(double E, double nu) {
    const double cx = 0.5 * (m.x[m.ix0] + m.x[m.ix1 - 1]), cy = 0.5 * (m.y[m.iy0] + m.y[m.iy1 - 1]);
    int unknowns = 0;
    for (std::size_t k = 0; k < nz; ++k)
      for (std::size_t j = 0; j < ny; ++j)
        for (std::size_t i = 0; i < nx; ++i) {
          if (i > 0 && j > 0 && i + 1 < nx && j + 1 < ny && k + 1 < nz) {
            number[node(i, j, k)] = unknowns++;
            continue;
          }
          const auto u = boussinesq(m.x[i] - cx, m.y[j] - cy, m.z[k], E, nu);
          for (std::size_t c = 0; c < 3; ++c) given[3 * node(i, j, k) + c] = u[c];
        }
    return unknowns;
  }
  void add_element(std::size_t i, std::size_t j, std::size_t k, double E, double nu,
                   std::vector<Eigen::Triplet<double>>& entries) {
    const Stiffness K = element_stiffness(m.x[i + 1] - m.x[i], m.y[j + 1] - m.y[j], m.z[k + 1] - m.z[k], E, nu);
    for (std::size_t a = 0; a < 8; ++a) {
      const int row = number[corner(i, j, k, a)];
      if (row < 0) continue;
      for (std::size_t b = 0; b < 8; ++b) {
        const std::size_t other = corner(i, j, k, b);
        for (std::size_t p = 0; p < 3; ++p)
          for (std::size_t q = 0; q < 3; ++q) {
            const double v = K(static_cast<Eigen::Index>(3 * a + p), static_cast<Eigen::Index>(3 * b + q));
            const int r = 3 * row + static_cast<int>(p);
            if (number[other] >= 0)
              entries.emplace_back(r, 3 * number[other] + static_cast<int>(q), v);
            else
              far_load[r] -= v * given[3 * other + q];
          }
      }
    }
  }
};

}  // namespace

Eigen::MatrixXd surface_flexibility(const BlockMesh& m, double E, double nu) {
  const BlockSystem s(m, E, nu);
  const auto n = static_cast<Eigen::Index>(m.candidates());
  Eigen::MatrixXd W(n, n);
  const Eigen::VectorXd far = s.solver.solve(s.far_load);
  Eigen::VectorXd load = Eigen::VectorXd::Zero(s.far_load.size());
  for (Eigen::Index c = 0; c < n; ++c) {
    const int own = s.dof(static_cast<std::size_t>(c));
    load[own] = 1.0;
    const Eigen::VectorXd u = s.solver.solve(load);
    load[own] = 0.0;
    for (Eigen::Index r = 0; r < n; ++r) {
      const int other = s.dof(static_cast<std::size_t>(r));
      W(r, c) = u[other] + far[other];
    }
  }
  return W;
}

BlockStress block_stresses(const BlockMesh& m, double E, double nu, const Eigen::VectorXd& force) {
  const BlockSystem s(m, E, nu);
  const double whole = force.sum();
  Eigen::VectorXd load = whole * s.far_load;
  for (Eigen::Index c = 0; c < force.size(); ++c) load[s.dof(static_cast<std::size_t>(c))] += force[c];
  const Eigen::VectorXd u = s.solver.solve(load);
  BlockStress out{m, {}, std::vector<std::array<double, 3>>(m.nodes())};
  for (std::size_t k = 0; k < m.nodes(); ++k)
    for (std::size_t c = 0; c < 3; ++c)
      out.displacement[k][c] = s.number[k] >= 0 ? u[3 * s.number[k] + static_cast<int>(c)] : whole * s.given[3 * k + c];
  const Eigen::Matrix<double, 6, 6> C = elasticity(E, nu);
  for (std::size_t k = 0; k + 1 < s.nz; ++k)
    for (std::size_t j = 0; j + 1 < s.ny; ++j)
      for (std::size_t i = 0; i + 1 < s.nx; ++i) {
        Eigen::Matrix<double, 24, 1> v;
        for (std::size_t n = 0; n < 8; ++n)
          for (std::size_t c = 0; c < 3; ++c)
            v[static_cast<Eigen::Index>(3 * n + c)] = out.displacement[s.corner(i, j, k, n)][c];
        const Eigen::Matrix<double, 6, 1> t =
            C * strains_at({0.0, 0.0, 0.0}, {m.x[i + 1] - m.x[i], m.y[j + 1] - m.y[j], m.z[k + 1] - m.z[k]}) * v;
        out.stress.push_back({t[0], t[1], t[2], t[3], t[4], t[5]});
      }
  return out;
}

double BlockStress::von_mises(std::size_t e) const {
  const auto& t = stress[e];
  const double x = t[0] - t[1], y = t[1] - t[2], z = t[2] - t[0];
  return std::sqrt(0.5 * (x * x + y * y + z * z) + 3.0 * (t[3] * t[3] + t[4] * t[4] + t[5] * t[5]));
}

Eigen::MatrixXd surface_mass(const BlockMesh& m) {
  const auto n = static_cast<Eigen::Index>(m.candidates()), width = static_cast<Eigen::Index>(m.ix1 - m.ix0);
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t j = m.iy0; j + 1 < m.iy1; ++j)
    for (std::size_t i = m.ix0; i + 1 < m.ix1; ++i) {
      const double area = (m.x[i + 1] - m.x[i]) * (m.y[j + 1] - m.y[j]) / 36.0;
      const Eigen::Index first = static_cast<Eigen::Index>(j - m.iy0) * width + static_cast<Eigen::Index>(i - m.ix0);
      const Eigen::Index corner[4] = {first, first + 1, first + width, first + width + 1};
      for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b) {
          const int differ = a ^ b;  // 4 on the same corner, 2 along an edge, 1 across
          M(corner[a], corner[b]) += area * (differ == 0 ? 4.0 : differ == 3 ? 1.0 : 2.0);
        }
    }
  return M;
}

}  // namespace epafi
