#include "ranks/plan.h"

#include <mpi.h>

#include <algorithm>
#include <cstring>
#include <numeric>

#include "engine/units/error.h"
#include "ranks/communicator.h"

namespace epafi {

namespace {
constexpr int tag_of_rows = 12;

}  // namespace

struct Plan::Messages {
  std::vector<std::size_t> order;  ///< of the rows, by rank
  bool in_order = true;            ///< that is the order in which they are
  std::vector<Share> out, in;
  RowBytes packed;  ///< until they have gone
  std::vector<MPI_Request> requests;
};

std::vector<Plan::Share> Plan::shares_of(const std::vector<int>& counts) {
  std::vector<Share> shares;
  std::size_t at = 0;
  for (std::size_t rank = 0; rank < counts.size(); ++rank) {
    const std::size_t end = at + static_cast<std::size_t>(counts[rank]);
    if (end > at) shares.push_back({static_cast<int>(rank), at, end});
    at = end;
  }
  return shares;
}

Plan::Plan() : messages_(std::make_unique<Messages>()) {}
Plan::Plan(Plan&&) noexcept = default;
Plan& Plan::operator=(Plan&&) noexcept = default;
Plan::~Plan() = default;

Plan::Plan(const std::vector<int>& to) : Plan() {
  Messages& m = *messages_;
  m.order.resize(to.size());
  std::iota(m.order.begin(), m.order.end(), std::size_t{0});
  m.in_order = std::ranges::is_sorted(to);
  if (!m.in_order) std::ranges::stable_sort(m.order, {}, [&](std::size_t k) { return to[k]; });
  std::vector<int> sent(static_cast<std::size_t>(rank_count()), 0), received(sent.size());
  for (const int rank : to) ++sent[static_cast<std::size_t>(rank)];
  MPI_Alltoall(sent.data(), 1, MPI_INT, received.data(), 1, MPI_INT, MPI_COMM_WORLD);
  m.out = shares_of(sent);
  m.in = shares_of(received);
}

std::size_t Plan::sent() const { return messages_->order.size(); }
std::size_t Plan::received() const {
  const std::vector<Share>& in = messages_->in;
  return in.empty() ? 0 : in.back().end;
}

std::span<const Plan::Share> Plan::to_ranks() const { return messages_->out; }
std::span<const Plan::Share> Plan::from_ranks() const { return messages_->in; }

void Plan::begin(const RowBytes& rows, std::size_t row, RowBytes& arrived) {
  EPAFI_REQUIRE(rows.size() == sent() * row, "a row for each place of the plan");
  Messages& m = *messages_;
  arrived.resize(received() * row);
  MPI_Datatype type = MPI_DATATYPE_NULL;  // counts are of rows: of bytes they would end at 2 GB
  MPI_Type_contiguous(static_cast<int>(row), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  m.requests.clear();
  const auto post = [&](const Share& share, auto* bytes, const auto& call) {
    call(bytes + share.begin * row, static_cast<int>(share.end - share.begin), type, share.rank, tag_of_rows,
         MPI_COMM_WORLD, &m.requests.emplace_back());
  };
  const int own = rank_number();
  for (const Share& share : m.in)
    if (share.rank != own) post(share, arrived.data(), MPI_Irecv);
  m.packed.resize(m.in_order ? 0 : rows.size());
  for (std::size_t k = 0; k < m.packed.size() / row; ++k)
    std::memcpy(m.packed.data() + k * row, rows.data() + m.order[k] * row, row);
  const std::byte* const from = m.in_order ? rows.data() : m.packed.data();
  for (const Share& share : m.out) {
    if (share.rank != own) {
      post(share, from, MPI_Isend);
      continue;
    }
    const auto mine = std::ranges::find(m.in, own, &Share::rank);
    std::memcpy(arrived.data() + mine->begin * row, from + share.begin * row, (share.end - share.begin) * row);
  }
  MPI_Type_free(&type);
}

void Plan::finish() {
  Messages& m = *messages_;
  MPI_Waitall(static_cast<int>(m.requests.size()), m.requests.data(), MPI_STATUSES_IGNORE);
}

}  // namespace epafi
