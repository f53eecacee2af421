#include "ranks/part_figures.h"

#include <algorithm>

#include "ranks/communicator.h"
#include "ranks/rows.h"

namespace epafi {

RankFigures gather_figures(const PartFigures& mine) {
  RankFigures all;
  all.ranks = rank_count();
  const double steps = std::max(1.0, mine.steps);
  double sums[3] = {mine.own / steps, mine.ghosts / steps, mine.bytes}, most = mine.own / steps;
  sum_over_ranks(sums);
  max_over_ranks({&most, 1});
  all.imbalance = sums[0] > 0.0 ? most * all.ranks / sums[0] : 1.0;
  all.ghosts = sums[0] > 0.0 ? sums[1] / sums[0] : 0.0;
  all.bytes_per_step = sums[2] / steps;
  all.moves = mine.moved;
  RowBytes row, rows;
  append_row(row, mine.seconds);
  gather_rows(row, sizeof mine.seconds, rows);
  for (std::size_t k = 0; k < rows.size() / sizeof mine.seconds; ++k)
    all.seconds.push_back(row_at<RankSeconds>(rows, k));
  return all;
}

}  // namespace epafi
