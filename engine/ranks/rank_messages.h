/// @file rank_messages.h  Messages between processes that solve a problem of process 0 together: the interface for
/// floors without MPI. All processes call all functions, except count and number, in the same order.
#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "engine/threads/order_free_sum.h"

namespace epafi {

class RankMessages {
 public:
  using Bytes = std::vector<std::byte>;
  /// Bytes for, or from, another process.
  struct Piece {
    int rank;
    std::span<std::byte> bytes;
  };

  virtual ~RankMessages() = default;
  virtual int count() const = 0;
  virtual int number() const = 0;
  /// Called by process 0: runs f, while all others run PartSetup::help.
  virtual void together(const std::function<void()>& f) = 0;
  /// Scatter: data of process 0 for each process; to: empty elsewhere.
  virtual void scatter(const std::vector<Bytes>& to, Bytes& mine) = 0;
  /// Gather: data of each process, at process 0 by rank; empty elsewhere.
  virtual std::vector<Bytes> gather(const Bytes& mine) = 0;
  /// Exchanges bytes between processes; both sides know the sizes.
  virtual void exchange(std::span<const Piece> out, std::span<const Piece> in) = 0;
  /// Over all processes.
  virtual void join(OrderFreeSum& sum) = 0;

  /// Number of contacts from which on processes share sweeps; below, messages take longer than they save.
  std::size_t least_contacts = 4000;
};

}  // namespace epafi
