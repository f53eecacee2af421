/// @file communicator.h  The processes of a run, as MPI numbers them: 0 leads. The only door to mpi.h.
/// Everything here but rank_count and rank_number is called by all ranks in the same order.
#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "ranks/row_bytes.h"

namespace epafi {

/// Start and end of MPI; main thread only.
void begin_ranks(int& argc, char**& argv);
void end_ranks();
/// Ends all ranks at once, whatever they do; mpirun's exit code is this one.
[[noreturn]] void abort_ranks(int code);

int rank_count();
int rank_number();

/// Broadcasts the data of rank 0.
void broadcast(void* data, std::size_t bytes);
/// Element-wise, over all ranks. Sums of whole numbers below 2^53 are exact, others rounded.
void sum_over_ranks(std::span<double> numbers);
void max_over_ranks(std::span<double> numbers);

/// Number k goes to rank k, and becomes that of rank k for this one.
void swap_numbers(std::vector<std::uint32_t>& numbers);

/// Sums and maxima over all ranks in one message, overlapped with computation.
class Joint {
 public:
  static constexpr std::size_t most = 32;  ///< numbers in all
  Joint();
  ~Joint();
  Joint(const Joint&) = delete;
  Joint& operator=(const Joint&) = delete;
  void begin(std::span<const double> sums, std::span<const double> largest);
  /// The results over all ranks, in the order of `begin`.
  void finish(std::span<double> sums, std::span<double> largest);

 private:
  struct Message;
  std::unique_ptr<Message> message_;
};

/// A number of each rank, at rank 0; empty elsewhere.
std::vector<double> gather_numbers(double mine);
/// Gathers rows of this size [B] at rank 0, in the order of ranks; `all` is empty elsewhere.
void gather_rows(const RowBytes& mine, std::size_t row, RowBytes& all);

}  // namespace epafi
