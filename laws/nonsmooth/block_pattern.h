/// @file block_pattern.h  Elimination order and fill of a sparse symmetric pattern of blocks: minimum degree (Amestoy,
/// Davis and Duff 1996), found once per graph. Shared by the factors of block_cholesky.h and block_lu.h.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/types.h"

namespace epafi {

struct BlockPattern {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  struct Entry {
    std::uint32_t column;  ///< k < j with L_jk != 0
    std::size_t position;  ///< of L_jk
  };

  /// n block rows; edges (a, b), a != b, unique as unordered pairs. Returns at once if they are the same as before.
  void analyse(std::size_t n, const std::vector<Edge>& edges);
  std::size_t size() const { return at.size(); }

  std::vector<Edge> edges;
  std::vector<std::uint32_t> place, at;    ///< place of a block row in the elimination, and back
  std::vector<std::size_t> begin;          ///< of the columns of L, below the diagonal
  std::vector<std::uint32_t> row;          ///< places, ascending in each column
  std::vector<std::size_t> entries_begin;  ///< of the rows of L
  std::vector<Entry> entries;
  std::vector<std::size_t> edges_begin;  ///< edges by the place of their earlier end
  std::vector<std::uint32_t> edge_of;
  double products = 0.0;  ///< block products of a symmetric factorisation

 private:
  void order(std::size_t n);
  void find_fill(std::size_t n);
};

}  // namespace epafi
