/// @file rank_messages.h  What processes tell each other while they solve a problem of process 0 together, as the
/// floors see it that know nothing of messages. All functions but count and number are called by all in the same order.
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
  /// By process 0: f, while all others do what they have been given for it (PartSetup::help).
  virtual void together(const std::function<void()>& f) = 0;
  /// What process 0 has for each of them; to: empty elsewhere.
  virtual void scatter(const std::vector<Bytes>& to, Bytes& mine) = 0;
  /// What each has, at process 0 by rank; empty elsewhere.
  virtual std::vector<Bytes> gather(const Bytes& mine) = 0;
  /// Bytes to others and from others, who know of each other how many.
  virtual void exchange(std::span<const Piece> out, std::span<const Piece> in) = 0;
  /// Over all processes.
  virtual void join(OrderFreeSum& sum) = 0;

  /// Contacts from which on sweeps are shared out: below, messages take longer than they save.
  std::size_t least_contacts = 4000;
};

}  // namespace epafi
