#include "laws/nonsmooth/block_pattern.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>

namespace epafi {

void BlockPattern::analyse(std::size_t n, const std::vector<Edge>& wanted) {
  if (n == at.size() && wanted == edges) return;
  edges = wanted;
  order(n);
  find_fill(n);
}

void BlockPattern::order(std::size_t n) {
  std::vector<Eigen::Triplet<double>> triplets;
  for (std::size_t i = 0; i < n; ++i) triplets.emplace_back(static_cast<int>(i), static_cast<int>(i), 1.0);
  for (const auto& [a, b] : edges) {
    triplets.emplace_back(static_cast<int>(a), static_cast<int>(b), 1.0);
    triplets.emplace_back(static_cast<int>(b), static_cast<int>(a), 1.0);
  }
  Eigen::SparseMatrix<double> graph(static_cast<int>(n), static_cast<int>(n));
  graph.setFromTriplets(triplets.begin(), triplets.end());
  Eigen::AMDOrdering<int>::PermutationType permutation;
  Eigen::AMDOrdering<int>()(graph, permutation);
  at.resize(n), place.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    at[k] = static_cast<std::uint32_t>(permutation.indices()[static_cast<Eigen::Index>(k)]);
    place[at[k]] = static_cast<std::uint32_t>(k);
  }
}

/// Column j of L: what column j of A has, and what its children in the elimination tree hand up.
void BlockPattern::find_fill(std::size_t n) {
  std::vector<std::vector<std::uint32_t>> columns(n), children(n), own(n);
  for (std::uint32_t e = 0; e < edges.size(); ++e) {
    const std::uint32_t a = place[edges[e].first], b = place[edges[e].second];
    columns[std::min(a, b)].push_back(std::max(a, b)), own[std::min(a, b)].push_back(e);
  }
  begin.assign(1, 0), row.clear(), edges_begin.assign(1, 0), edge_of.clear(), products = 0.0;
  for (std::uint32_t j = 0; j < n; ++j) {
    auto& column = columns[j];
    for (const std::uint32_t child : children[j]) {
      column.insert(column.end(), columns[child].begin() + 1, columns[child].end());
      columns[child].clear();
    }
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    if (!column.empty()) children[column.front()].push_back(j);
    row.insert(row.end(), column.begin(), column.end());
    begin.push_back(row.size());
    edge_of.insert(edge_of.end(), own[j].begin(), own[j].end());
    edges_begin.push_back(edge_of.size());
    products += 0.5 * static_cast<double>(column.size()) * static_cast<double>(column.size() + 1);
  }
  entries_begin.assign(n + 1, 0);
  for (const std::uint32_t r : row) ++entries_begin[r + 1];
  for (std::size_t j = 0; j < n; ++j) entries_begin[j + 1] += entries_begin[j];
  entries.resize(row.size());
  std::vector<std::size_t> next(entries_begin.begin(), entries_begin.end() - 1);
  for (std::uint32_t k = 0; k < n; ++k)
    for (std::size_t p = begin[k]; p < begin[k + 1]; ++p) entries[next[row[p]]++] = {k, p};
}

}  // namespace epafi
