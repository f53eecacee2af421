/// @file mpi_messages.h  Messages of processes that solve a problem of rank 0 together.
#pragma once
#include "engine/ranks/rank_messages.h"

namespace epafi {

class MpiMessages final : public RankMessages {
 public:
  /// busy: true within something that all ranks do together.
  explicit MpiMessages(bool& busy) : busy_(busy) {}
  int count() const override;
  int number() const override;
  void together(const std::function<void()>& f) override;
  void scatter(const std::vector<Bytes>& to, Bytes& mine) override;
  std::vector<Bytes> gather(const Bytes& mine) override;
  void exchange(std::span<const Piece> out, std::span<const Piece> in) override;
  void join(OrderFreeSum& sum) override;

 private:
  bool& busy_;
};

}  // namespace epafi
