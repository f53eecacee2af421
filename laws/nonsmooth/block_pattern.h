/// @file block_pattern.h  Elimination order, fill and supernodes of a sparse symmetric pattern of blocks: minimum
/// degree (Amestoy, Davis and Duff 1996), found once per graph. A supernode is a run of columns with the same rows
/// below (Ng and Peyton 1993): its factor is stored as one dense panel, so that every update is a product of long rows.
/// Shared by the factors of block_cholesky.h and block_lu.h.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "engine/state/types.h"

namespace epafi {

struct BlockPattern {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  struct Supernode {
    std::uint32_t first = 0, width = 1;        ///< columns [first, first + width)
    std::size_t rows = 0, rows_end = 0;        ///< in `row`: its columns, then the rows below
    std::size_t blocks = 0;                    ///< of its panel, row by row: `width` blocks each
    std::size_t updates = 0, updates_end = 0;  ///< in `updates`
    std::size_t edges = 0, edges_end = 0;      ///< in `edge_of`: those whose earlier end is one of its columns
    std::size_t height() const { return rows_end - rows; }
  };
  /// An earlier supernode whose rows [first, last) are columns of a later one.
  struct Update {
    std::uint32_t supernode, first, last;
  };

  /// n block rows; edges (a, b), a != b, unique as unordered pairs. Returns at once if they are the same as before.
  void analyse(std::size_t n, const std::vector<Edge>& edges);
  std::size_t size() const { return at.size(); }
  std::size_t blocks() const { return supernodes.empty() ? 0 : blocks_; }

  std::vector<Edge> edges;
  std::vector<std::uint32_t> place, at;  ///< place of a block row in the elimination, and back
  std::vector<Supernode> supernodes;
  std::vector<std::uint32_t> row;  ///< places, ascending in each supernode
  std::vector<Update> updates;
  std::vector<std::uint32_t> edge_of;
  double products = 0.0;  ///< block products of a symmetric factorisation

 private:
  using Columns = std::vector<std::vector<std::uint32_t>>;
  void order(std::size_t n);
  Columns fill(std::size_t n) const;
  void merge(const Columns& columns);
  void find_updates();
  void sort_edges();

  std::size_t blocks_ = 0;
};

}  // namespace epafi
