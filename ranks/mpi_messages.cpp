#include "ranks/mpi_messages.h"

#include <mpi.h>

#include <algorithm>
#include <type_traits>

#include "ranks/communicator.h"
#include "ranks/orders.h"

namespace epafi {

namespace {
constexpr int tag_of_border = 13, tag_of_piece = 14;
constexpr std::size_t most = std::size_t{1} << 30;  // bytes of a message: MPI counts in int

void send(const RankMessages::Bytes& bytes, int rank) {
  const std::uint64_t size = bytes.size();
  MPI_Send(&size, sizeof size, MPI_BYTE, rank, tag_of_piece, MPI_COMM_WORLD);
  for (std::size_t done = 0; done < size; done += most)
    MPI_Send(bytes.data() + done, static_cast<int>(std::min<std::size_t>(most, size - done)), MPI_BYTE, rank,
             tag_of_piece, MPI_COMM_WORLD);
}

RankMessages::Bytes receive(int rank) {
  std::uint64_t size = 0;
  MPI_Recv(&size, sizeof size, MPI_BYTE, rank, tag_of_piece, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  RankMessages::Bytes bytes(size);
  for (std::size_t done = 0; done < size; done += most)
    MPI_Recv(bytes.data() + done, static_cast<int>(std::min<std::size_t>(most, size - done)), MPI_BYTE, rank,
             tag_of_piece, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return bytes;
}
}  // namespace

int MpiMessages::count() const { return rank_count(); }
int MpiMessages::number() const { return rank_number(); }

void MpiMessages::together(const std::function<void()>& f) {
  const Busy busy(busy_);
  tell({.task = Task::help});
  f();
}

void MpiMessages::scatter(const std::vector<Bytes>& to, Bytes& mine) {
  if (rank_number() != 0) {
    mine = receive(0);
    return;
  }
  for (int rank = 1; rank < rank_count(); ++rank) send(to[static_cast<std::size_t>(rank)], rank);
  mine = to[0];
}

std::vector<RankMessages::Bytes> MpiMessages::gather(const Bytes& mine) {
  if (rank_number() != 0) {
    send(mine, 0);
    return {};
  }
  std::vector<Bytes> all{mine};
  for (int rank = 1; rank < rank_count(); ++rank) all.push_back(receive(rank));
  return all;
}

void MpiMessages::exchange(std::span<const Piece> out, std::span<const Piece> in) {
  std::vector<MPI_Request> requests;
  requests.reserve(out.size() + in.size());
  const auto begin = [&](const Piece& piece, const auto& call) {
    requests.emplace_back();
    call(piece.bytes.data(), static_cast<int>(piece.bytes.size()), MPI_BYTE, piece.rank, tag_of_border, MPI_COMM_WORLD,
         &requests.back());
  };
  for (const Piece& piece : in) begin(piece, MPI_Irecv);
  for (const Piece& piece : out) begin(piece, MPI_Isend);
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

void MpiMessages::join(OrderFreeSum& sum) {
  static_assert(std::is_trivially_copyable_v<OrderFreeSum>);
  std::vector<OrderFreeSum> all(static_cast<std::size_t>(rank_count()));
  MPI_Allgather(&sum, sizeof sum, MPI_BYTE, all.data(), sizeof sum, MPI_BYTE, MPI_COMM_WORLD);
  sum = OrderFreeSum();
  for (const OrderFreeSum& part : all) sum += part;
}

}  // namespace epafi
