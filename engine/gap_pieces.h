/// @file gap_pieces.h  Bodies and gaps of the contacts of a step, a piece at a time: columns of all that a contact
/// model finds itself took 40 bytes a sphere.
#pragma once
#include <algorithm>

#include "engine/parallel.h"
#include "engine/pipeline.h"

namespace epafi {

class GapPieces {
 public:
  /// model: whose own contacts come on top; null: there are none.
  GapPieces(const World& world, const ContactSet& contacts, const ContactModel* model = nullptr)
      : world_(world),
        contacts_(contacts),
        model_(model),
        known_((contacts.size() + sum_block - 1) / sum_block),
        size_(known_ + (model != nullptr ? model->gap_parts() : 0)) {}
  std::size_t size() const { return size_; }
  /// f(contacts, begin, end): those of a piece with a, b, gap and, where it is known, force. Points of one pair stand
  /// behind each other in `contacts`, which a piece may divide. Several threads may read.
  template <class F>
  void read(std::size_t piece, const F& f) const {
    if (piece < known_) {
      f(contacts_, piece * sum_block, std::min(contacts_.size(), (piece + 1) * sum_block));
      return;
    }
    thread_local ContactSet room;
    room.clear();
    model_->append_gaps(world_, piece - known_, room);
    f(room, std::size_t{0}, room.size());
  }

 private:
  const World& world_;
  const ContactSet& contacts_;
  const ContactModel* model_;
  std::size_t known_, size_;
};

}  // namespace epafi
