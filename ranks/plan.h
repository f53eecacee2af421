/// @file plan.h  Communication plan: the ranks and numbers of rows are found once, rows are sent repeatedly. Zoltan's
/// plans wait for all ranks in every exchange (an MPI_Allreduce in Zoltan_Comm_Do_Post); these wait only for
/// neighbours.
#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "ranks/row_bytes.h"

namespace epafi {

class Plan {
 public:
  Plan();
  /// to: the rank that each row goes to, this one included. By all ranks.
  explicit Plan(const std::vector<int>& to);
  Plan(Plan&&) noexcept;
  Plan& operator=(Plan&&) noexcept;
  ~Plan();

  /// Rows [begin, end) of one rank.
  struct Share {
    int rank;
    std::size_t begin, end;
  };

  std::size_t sent() const;
  std::size_t received() const;
  /// Rows that go to each rank, of those in the order of ranks, and that come from each.
  std::span<const Share> to_ranks() const;
  std::span<const Share> from_ranks() const;
  /// Sends rows of this size [B], in the order of `to`. They arrive by rank, in the order of the sender.
  void run(const RowBytes& rows, std::size_t row, RowBytes& arrived) {
    begin(rows, row, arrived);
    finish();
  }
  /// The same in two parts, without waiting for ranks that send nothing; the vectors must not change in between. Rows
  /// in the order of ranks are sent without a copy.
  void begin(const RowBytes& rows, std::size_t row, RowBytes& arrived);
  void finish();

 private:
  struct Messages;
  static std::vector<Share> shares_of(const std::vector<int>& counts);
  std::unique_ptr<Messages> messages_;
};

}  // namespace epafi
