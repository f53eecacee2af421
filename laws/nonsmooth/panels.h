/// @file panels.h  Walks over the panels of a BlockPattern that its factors share; the arithmetic is theirs.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "laws/nonsmooth/block_pattern.h"

namespace epafi {

/// each(edge, place, swapped) of all edges whose earlier end is a column of the panel. place: of the edge's block, from
/// the panel's first one; swapped: the edge's first block row is the later one. row: room for a number of each row;
/// afterwards it holds the rows of this panel.
template <class Each>
void for_each_edge(const BlockPattern& pattern, const BlockPattern::Supernode& panel, std::vector<std::uint32_t>& row,
                   const Each& each) {
  const std::uint32_t* rows = pattern.row.data() + panel.rows;
  for (std::uint32_t i = 0; i < panel.height(); ++i) row[rows[i]] = i;
  for (std::size_t k = panel.edges; k < panel.edges_end; ++k) {
    const std::uint32_t e = pattern.edge_of[k];
    const std::uint32_t a = pattern.place[pattern.edges[e].first], b = pattern.place[pattern.edges[e].second];
    each(e, row[std::max(a, b)] * panel.width + (std::min(a, b) - panel.first), a > b);
  }
}

/// Back substitution, from the last column to the first: y_j takes off the transposed blocks below its pivot times what
/// stands there, then finish(j, y_j) divides by the pivot.
template <class Block, class Vector, class Finish>
void substitute_back(const BlockPattern& pattern, const std::vector<Block>& blocks, std::vector<Vector>& all,
                     const Finish& finish) {
  for (std::size_t s = pattern.supernodes.size(); s-- > 0;) {
    const BlockPattern::Supernode& panel = pattern.supernodes[s];
    const std::uint32_t* rows = pattern.row.data() + panel.rows;
    const Block* block = blocks.data() + panel.blocks;
    for (std::size_t j = panel.width; j-- > 0;) {
      Vector& y = all[panel.first + j];
      for (std::size_t i = j + 1; i < panel.height(); ++i)
        y.noalias() -= block[i * panel.width + j].transpose() * all[rows[i]];
      finish(panel.first + j, y);
    }
  }
}

}  // namespace epafi
