#include "ranks/communicator.h"

#include <mpi.h>
#include <zoltan.h>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>

#include "engine/units/error.h"

namespace epafi {

void begin_ranks(int& argc, char**& argv) {
  int level = 0;
#if defined(__unix__)  // OpenMPI polls without a break: on busy cores it keeps the rank that it waits for from running
  setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);
#endif
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  if (level < MPI_THREAD_FUNNELED) {
    std::fputs("epafi: this MPI library cannot be used by programs with threads\n", stderr);
    abort_ranks(3);
  }
  float version = 0.0f;
  Zoltan_Initialize(argc, argv, &version);
#if defined(__GLIBC__)  // images of the state come and go: page faults are half of the time of a move
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
#endif
}

void end_ranks() { MPI_Finalize(); }

void abort_ranks(int code) {
  MPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);
}

int rank_count() {
  int size = 1;
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  return size;
}

int rank_number() {
  int number = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &number);
  return number;
}

void broadcast(void* data, std::size_t bytes) {
  constexpr std::size_t most = std::size_t{1} << 30;  // MPI counts in int
  auto* at = static_cast<char*>(data);
  for (std::size_t done = 0; done < bytes;) {
    const std::size_t piece = std::min(most, bytes - done);
    MPI_Bcast(at + done, static_cast<int>(piece), MPI_BYTE, 0, MPI_COMM_WORLD);
    done += piece;
  }
}

void sum_over_ranks(std::span<double> numbers) {
  MPI_Allreduce(MPI_IN_PLACE, numbers.data(), static_cast<int>(numbers.size()), MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
}

void max_over_ranks(std::span<double> numbers) {
  MPI_Allreduce(MPI_IN_PLACE, numbers.data(), static_cast<int>(numbers.size()), MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
}

void swap_numbers(std::vector<std::uint32_t>& numbers) {
  std::vector<std::uint32_t> theirs(numbers.size());
  MPI_Alltoall(numbers.data(), 1, MPI_UINT32_T, theirs.data(), 1, MPI_UINT32_T, MPI_COMM_WORLD);
  numbers.swap(theirs);
}

struct Joint::Message {
  struct Numbers {
    double sums = 0.0;  ///< so many come first
    double value[most] = {};
  };
  /// MPI reduction of `more` into `some`: sums first, then maxima.
  static void join(void* more, void* some, int* count, MPI_Datatype* /*type*/) {
    const auto* from = static_cast<const Numbers*>(more);
    auto* to = static_cast<Numbers*>(some);
    for (int i = 0; i < *count; ++i)
      for (std::size_t k = 0; k < most; ++k) {
        double& x = to[i].value[k];
        const double y = from[i].value[k];
        x = static_cast<double>(k) < to[i].sums ? x + y : std::max(x, y);
      }
  }

  Numbers mine, all;
  MPI_Request request = MPI_REQUEST_NULL;
  MPI_Datatype type = MPI_DATATYPE_NULL;
  MPI_Op operation = MPI_OP_NULL;
};

Joint::Joint() : message_(std::make_unique<Message>()) {
  MPI_Type_contiguous(static_cast<int>(sizeof(Message::Numbers) / sizeof(double)), MPI_DOUBLE, &message_->type);
  MPI_Type_commit(&message_->type);
  MPI_Op_create(Message::join, 1, &message_->operation);
}

Joint::~Joint() {
  int ended = 0;
  MPI_Finalized(&ended);
  if (ended != 0) return;
  MPI_Op_free(&message_->operation);
  MPI_Type_free(&message_->type);
}

void Joint::begin(std::span<const double> sums, std::span<const double> largest) {
  EPAFI_REQUIRE(sums.size() + largest.size() <= most, "room for the numbers of all ranks");
  Message::Numbers& mine = message_->mine;
  mine.sums = static_cast<double>(sums.size());
  std::ranges::copy(largest, std::ranges::copy(sums, mine.value).out);
  MPI_Iallreduce(&mine, &message_->all, 1, message_->type, message_->operation, MPI_COMM_WORLD, &message_->request);
}

void Joint::finish(std::span<double> sums, std::span<double> largest) {
  MPI_Wait(&message_->request, MPI_STATUS_IGNORE);
  const double* from = message_->all.value;
  std::copy_n(from, sums.size(), sums.begin());
  std::copy_n(from + sums.size(), largest.size(), largest.begin());
}

std::vector<double> gather_numbers(double mine) {
  std::vector<double> all(rank_number() == 0 ? static_cast<std::size_t>(rank_count()) : 0);
  MPI_Gather(&mine, 1, MPI_DOUBLE, all.data(), 1, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  return all;
}

void gather_rows(const RowBytes& mine, std::size_t row, RowBytes& all) {
  const int count = static_cast<int>(mine.size() / row);
  const bool is_first = rank_number() == 0;
  std::vector<int> counts(is_first ? static_cast<std::size_t>(rank_count()) : 0), first(counts.size() + 1, 0);
  MPI_Gather(&count, 1, MPI_INT, counts.data(), 1, MPI_INT, 0, MPI_COMM_WORLD);
  std::inclusive_scan(counts.begin(), counts.end(), first.begin() + 1);
  all.resize(row * static_cast<std::size_t>(first.back()));
  MPI_Datatype type = MPI_DATATYPE_NULL;  // counts are of rows: of bytes they would end at 2 GB
  MPI_Type_contiguous(static_cast<int>(row), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  MPI_Gatherv(mine.data(), count, type, all.data(), counts.data(), first.data(), type, 0, MPI_COMM_WORLD);
  MPI_Type_free(&type);
}

}  // namespace epafi
