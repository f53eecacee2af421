/// @file elastic_block.h  A block of linear elastic hexahedra under the patch, graded towards it: how the surface nodes
/// of the patch yield to forces on them. Both bodies are one block of their combined modulus (exact for normal contact
/// without friction); far faces follow Boussinesq's half-space, so that the block's size costs little.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

namespace epafi {

struct BlockMesh {
  std::vector<double> x, y, z;  ///< coordinates of the node planes [m]; z = 0 is the surface, z > 0 inside
  std::size_t ix0 = 0, ix1 = 0, iy0 = 0, iy1 = 0;  ///< surface nodes that may touch: [ix0, ix1) by [iy0, iy1)

  std::size_t candidates() const { return (ix1 - ix0) * (iy1 - iy0); }
  double candidate_x(std::size_t k) const { return x[ix0 + k % (ix1 - ix0)]; }
  double candidate_y(std::size_t k) const { return y[iy0 + k / (ix1 - ix0)]; }
  std::size_t nodes() const { return x.size() * y.size() * z.size(); }
};

/// Equal cells over [-ax, ax] by [-ay, ay] about (cx, cy), `across` over the shorter side; outside and below they grow
/// by `growth` to `reach` times the longer half side.
BlockMesh make_block_mesh(double cx, double cy, double ax, double ay, int across, double growth, double reach);

/// Inward displacement of the candidates per force on each of them [m/N], column by column.
Eigen::MatrixXd surface_flexibility(const BlockMesh& mesh, double youngs_modulus, double poissons_ratio);

/// Stresses inside the block: xx, yy, zz, yz, xz, xy [Pa], tension positive, in the middle of each element, elements
/// row by row in x, then y, then z; displacements of the nodes [m] in the same order.
struct BlockStress {
  BlockMesh mesh;
  std::vector<std::array<double, 6>> stress;
  std::vector<std::array<double, 3>> displacement;

  std::size_t element(std::size_t i, std::size_t j, std::size_t k) const {
    return (k * (mesh.y.size() - 1) + j) * (mesh.x.size() - 1) + i;
  }
  double von_mises(std::size_t element) const;  ///< equivalent stress [Pa]
};

/// Under these forces on the candidates, into the block [N].
BlockStress block_stresses(const BlockMesh& mesh, double youngs_modulus, double poissons_ratio,
                           const Eigen::VectorXd& force);

/// Mass matrix of the surface over the candidates: int phi_i phi_j [m^2].
Eigen::MatrixXd surface_mass(const BlockMesh& mesh);

}  // namespace epafi
