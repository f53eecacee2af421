#include <Eigen/Dense>
#include <algorithm>

#include "engine/units/random.h"
#include "laws/nonsmooth/block_cholesky.h"
#include "laws/nonsmooth/block_lu.h"
#include "tests/support/catch.h"

using namespace epafi;

namespace {

/// A ring of n bodies with chords: fill that a band would not have.
std::vector<BlockPattern::Edge> ring(std::uint32_t n) {
  std::vector<BlockPattern::Edge> edges;
  for (std::uint32_t i = 0; i < n; ++i) {
    edges.push_back({std::max(i, (i + 1) % n), std::min(i, (i + 1) % n)});
    if (i % 3 == 0 && i + 7 < n) edges.push_back({i + 7, i});
  }
  return edges;
}

/// A cubic lattice: its last separators fill to wide panels.
std::vector<BlockPattern::Edge> lattice(std::uint32_t side) {
  std::vector<BlockPattern::Edge> edges;
  for (std::uint32_t i = 0; i < side * side * side; ++i) {
    if (i % side > 0) edges.push_back({i, i - 1});
    if (i / side % side > 0) edges.push_back({i, i - side});
    if (i >= side * side) edges.push_back({i, i - side * side});
  }
  return edges;
}

template <int N>
Eigen::Matrix<double, N, N> random_block(Random& random) {
  Eigen::Matrix<double, N, N> m;
  for (int k = 0; k < N * N; ++k) m(k / N, k % N) = random.uniform(-1, 1);
  return m;
}

template <int N>
double error(const Eigen::MatrixXd& a, std::vector<Eigen::Matrix<double, N, 1>> x, const Eigen::VectorXd& b) {
  Eigen::VectorXd flat(a.rows());
  for (std::size_t i = 0; i < x.size(); ++i) flat.segment<N>(N * static_cast<Eigen::Index>(i)) = x[i];
  return (a * flat - b).norm() / b.norm();
}

/// Both factors on one pattern: the symmetric positive definite matrix, and an unsymmetric one with heavy diagonal.
template <int N>
void check_factors(std::uint32_t n, const std::vector<BlockPattern::Edge>& edges) {
  Random random(N, n);
  BlockCholesky<N> cholesky;
  BlockLu<N> lu;
  cholesky.analyse(n, edges);
  lu.analyse(n, edges);
  const Eigen::Index size = N * static_cast<Eigen::Index>(n);
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size), c = a;
  for (std::uint32_t i = 0; i < n; ++i) {
    const auto m = random_block<N>(random);
    cholesky.diagonal[i] = m * m.transpose() + 4.0 * N * Eigen::Matrix<double, N, N>::Identity();
    lu.diagonal[i] = cholesky.diagonal[i] + m;
    a.block<N, N>(N * i, N * i) = cholesky.diagonal[i];
    c.block<N, N>(N * i, N * i) = lu.diagonal[i];
  }
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [p, q] = edges[e];
    cholesky.off_diagonal[e] = random_block<N>(random);
    lu.lower[e] = random_block<N>(random);
    lu.upper[e] = random_block<N>(random);
    a.block<N, N>(N * p, N * q) = cholesky.off_diagonal[e];
    a.block<N, N>(N * q, N * p) = cholesky.off_diagonal[e].transpose();
    c.block<N, N>(N * p, N * q) = lu.lower[e];
    c.block<N, N>(N * q, N * p) = lu.upper[e];
  }
  Eigen::VectorXd b(size);
  for (double& x : b) x = random.uniform(-1, 1);
  std::vector<Eigen::Matrix<double, N, 1>> x(n);
  const auto fill = [&] {
    for (std::uint32_t i = 0; i < n; ++i) x[i] = b.segment<N>(N * i);
  };
  REQUIRE(cholesky.factor());
  fill();
  cholesky.solve(x);
  CHECK(error<N>(a, x, b) < 1e-13);  // condition numbers below 10: a few hundred ulp
  REQUIRE(lu.factor());
  fill();
  lu.solve(x);
  CHECK(error<N>(c, x, b) < 1e-13);
}

}  // namespace

TEST_CASE("a lattice's factor is stored in few wide panels, each row of L once", "[laws][factor]") {
  BlockPattern pattern;
  pattern.analyse(125, lattice(5));
  std::size_t columns = 0;
  for (const auto& panel : pattern.supernodes) {
    CHECK(panel.first == columns);
    columns += panel.width;
    CHECK(std::is_sorted(pattern.row.begin() + static_cast<std::ptrdiff_t>(panel.rows),
                         pattern.row.begin() + static_cast<std::ptrdiff_t>(panel.rows_end)));
  }
  CHECK(columns == 125);
  CHECK(pattern.supernodes.size() < 100);
  CHECK(pattern.supernodes.back().width > 10);  // the last separator has 25 nodes
}

TEST_CASE("block Cholesky and LU solve what the dense matrix says", "[laws][factor]") {
  for (const std::uint32_t n : {3u, 20u, 61u}) {
    check_factors<6>(n, ring(n));
    check_factors<3>(n, ring(n));
  }
  check_factors<6>(64, lattice(4));
  check_factors<3>(125, lattice(5));
}

TEST_CASE("a matrix that is not positive definite is refused, a singular one too", "[laws][factor]") {
  BlockCholesky<3> cholesky;
  cholesky.analyse(2, {{1, 0}});
  cholesky.diagonal = {Mat3::Identity(), Mat3::Identity()};
  cholesky.off_diagonal = {2.0 * Mat3::Identity()};  // Schur complement 1 - 4 < 0
  CHECK_FALSE(cholesky.factor());
  BlockLu<3> lu;
  lu.analyse(1, {});
  lu.diagonal = {Mat3::Zero()};
  CHECK_FALSE(lu.factor());
}
