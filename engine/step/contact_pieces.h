/// @file contact_pieces.h  The contacts of a step, in pieces: columns of all contacts that a model finds itself would
/// take 40 bytes a sphere for gaps, 350 for the data of a frame.
#pragma once
#include <algorithm>

#include "engine/step/pipeline.h"
#include "engine/threads/parallel.h"

namespace epafi {

class ContactPieces {
 public:
  /// model: has contacts of its own in addition; null: none.
  ContactPieces(const World& world, const ContactSet& contacts, const ContactModel* model = nullptr)
      : world_(world),
        contacts_(contacts),
        model_(model),
        known_((contacts.size() + sum_block - 1) / sum_block),
        size_(known_ + (model != nullptr ? model->own_parts() : 0)) {}
  std::size_t size() const { return size_; }
  bool is_own(std::size_t piece) const { return piece >= known_; }
  /// Number of contacts of a piece if all of them are known to touch.
  std::optional<std::size_t> all_touching(std::size_t piece) const {
    return is_own(piece) ? model_->own_count(piece - known_) : std::nullopt;
  }

  /// Calls f(contacts, begin, end) for a piece, with a, b, gap and, if known, force. Points of one pair need not be
  /// consecutive: those of clumps stand by their balls, and a pair may extend over two pieces. Thread-safe.
  template <class F>
  void read_gaps(std::size_t piece, const F& f) const {
    read_by(piece, f, [&](std::size_t part, ContactSet& room) { model_->append_gaps(world_, part, room); });
  }
  /// The same with feature, normal, arm and force.
  template <class F>
  void read(std::size_t piece, const F& f) const {
    read_by(piece, f, [&](std::size_t part, ContactSet& room) { model_->append_contacts(world_, part, {}, room); });
  }
  /// The wanted contacts with force, in canonical order.
  ContactSet wanted(const ContactModel::Wanted& is_wanted) const;

 private:
  template <class F, class Append>
  void read_by(std::size_t piece, const F& f, const Append& append) const {
    if (!is_own(piece)) {
      f(contacts_, piece * sum_block, std::min(contacts_.size(), (piece + 1) * sum_block));
      return;
    }
    thread_local ContactSet room;
    room.clear();
    room.with_curvature = true;
    append(piece - known_, room);
    f(room, std::size_t{0}, room.size());
  }

  const World& world_;
  const ContactSet& contacts_;
  const ContactModel* model_;
  std::size_t known_, size_;
};

}  // namespace epafi
