#include "ranks/communicator.h"

#include <mpi.h>
#include <zoltan.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace epafi {

void begin_ranks(int& argc, char**& argv) {
  int level = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &level);
  if (level < MPI_THREAD_FUNNELED) {
    std::fputs("epafi: this MPI library cannot be used by programs with threads\n", stderr);
    abort_ranks(3);
  }
  float version = 0.0f;
  Zoltan_Initialize(argc, argv, &version);
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

std::vector<double> gather_numbers(double mine) {
  std::vector<double> all(rank_number() == 0 ? static_cast<std::size_t>(rank_count()) : 0);
  MPI_Gather(&mine, 1, MPI_DOUBLE, all.data(), 1, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  return all;
}

}  // namespace epafi
