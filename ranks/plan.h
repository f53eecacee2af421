/// @file plan.h  Rows to ranks, as often as wanted: who sends how many to whom is found once. Zoltan's plans do the
/// same but wait for all ranks in every exchange (an MPI_Allreduce in Zoltan_Comm_Do_Post); these wait for neighbours
/// alone.
#pragma once
#include <cstddef>
#include <memory>
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

  std::size_t sent() const;
  std::size_t received() const;
  /// Rows of so many bytes, in the order of `to`. They come by rank, those of one rank as it sent them.
  void run(const RowBytes& rows, std::size_t row, RowBytes& arrived) {
    begin(rows, row, arrived);
    finish();
  }
  /// The same in two steps. Nobody waits for ranks that send him nothing; neither vector is touched in between. Rows in
  /// the order of their ranks are sent from where they are.
  void begin(const RowBytes& rows, std::size_t row, RowBytes& arrived);
  void finish();

 private:
  struct Share;
  struct Messages;
  static std::vector<Share> shares_of(const std::vector<int>& counts);
  std::unique_ptr<Messages> messages_;
};

}  // namespace epafi
