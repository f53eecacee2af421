#include "ranks/shared_rows.h"

#include <mpi.h>

#include <atomic>
#include <thread>
#include <vector>

#include "ranks/communicator.h"

namespace epafi {

namespace {
constexpr std::size_t head = 4096;  // bytes before the rows, with the number of the last step that is written

using Step = std::atomic<unsigned long>;
static_assert(Step::is_always_lock_free, "processes share it");

bool on_one_machine() {
  MPI_Comm here = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  int size = 0;
  MPI_Comm_size(here, &size);
  MPI_Comm_free(&here);
  double elsewhere = size == rank_count() ? 0.0 : 1.0;
  max_over_ranks({&elsewhere, 1});
  return elsewhere == 0.0;
}
}  // namespace

struct SharedRows::Memory {
  MPI_Win window = MPI_WIN_NULL;
  std::vector<std::byte*> of_rank;

  /// False if some rank gets none.
  bool take(std::size_t bytes) {
    MPI_Errhandler usual{};
    MPI_Comm_get_errhandler(MPI_COMM_WORLD, &usual);
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    void* mine = nullptr;
    const auto size = static_cast<MPI_Aint>(bytes);
    double fails = MPI_Win_allocate_shared(size, 1, MPI_INFO_NULL, MPI_COMM_WORLD, &mine, &window) != MPI_SUCCESS;
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, usual);
    MPI_Errhandler_free(&usual);
    max_over_ranks({&fails, 1});
    if (fails != 0.0) return false;
    for (int rank = 0; rank < rank_count(); ++rank) {
      MPI_Aint there = 0;
      int unit = 0;
      void* at = nullptr;
      MPI_Win_shared_query(window, rank, &there, &unit, &at);
      of_rank.push_back(static_cast<std::byte*>(at));
    }
    step_of(rank_number()).store(0);
    MPI_Barrier(MPI_COMM_WORLD);
    return true;
  }
  Step& step_of(int rank) const { return *reinterpret_cast<Step*>(of_rank[static_cast<std::size_t>(rank)]); }
};

SharedRows& SharedRows::of_program() {
  static SharedRows rows;
  return rows;
}

bool SharedRows::reserve(std::size_t bytes) {
  auto most = static_cast<double>(bytes);
  max_over_ranks({&most, 1});
  const auto wanted = static_cast<std::size_t>(most);
  if (refused_ || (memory_ && wanted <= room_)) return !refused_;
  if (memory_) {
    MPI_Win_free(&memory_->window);
    delete memory_;
  }
  memory_ = new Memory;
  step_ = 0;
  room_ = (wanted + wanted / 2) / head * head + head;
  refused_ = !on_one_machine() || !memory_->take(head + 2 * room_);
  return !refused_;
}

std::byte* SharedRows::begin() {
  ++step_;
  return memory_->of_rank[static_cast<std::size_t>(rank_number())] + head + step_ % 2 * room_;
}

void SharedRows::tell() { memory_->step_of(rank_number()).store(step_, std::memory_order_release); }

const std::byte* SharedRows::wait(int rank) const {
  constexpr int patience = 2000;  // looks before others may have the processor
  for (int look = 0; memory_->step_of(rank).load(std::memory_order_acquire) < step_; ++look)
    if (look > patience) std::this_thread::yield();
  return memory_->of_rank[static_cast<std::size_t>(rank)] + head + step_ % 2 * room_;
}

}  // namespace epafi
