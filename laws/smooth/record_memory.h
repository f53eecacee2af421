/// @file record_memory.h  What is remembered of every contact: a record of as many numbers as a law asks for, carried
/// by contact key; the last step's beside this one's. A contact that begins has a record of zeros.
#pragma once
#include <algorithm>
#include <vector>

#include "engine/state/contacts.h"
#include "engine/state/state_visitor.h"

namespace epafi {

/// Numbers of a record by part, in this order.
struct RecordParts {
  std::size_t normal = 0, friction = 0, rolling = 0, push = 0;
};

class RecordMemory {
 public:
  explicit RecordMemory(RecordParts parts)
      : parts_(parts),
        size_(parts.normal + parts.friction + parts.rolling + parts.push),
        fresh_(std::max<std::size_t>(1, size_)) {}

  /// exchange(record): of a contact whose bodies A and B have changed places.
  template <class Exchange>
  void advance(const World& world, const ContactSet& contacts, const Exchange& exchange) {
    turned_.clear();
    keys_.match(
        world, contacts, previous_, [&](std::size_t k) { return std::all_of(row(now_, k), row(now_, k + 1), is_zero); },
        &turned_);
    old_.swap(now_);
    for (const std::uint32_t i : turned_) exchange(row(old_, previous_[i]));
    now_.resize(size_ * contacts.size());
  }
  /// Record of contact i in the last step; the initial one for a new contact.
  const double* before(std::size_t i) const {
    return previous_[i] == ContactMemory::none ? fresh_.data() : old_.data() + size_ * previous_[i];
  }
  double* now(std::size_t i) { return row(now_, i); }
  void forget(std::size_t i) { std::fill_n(now(i), size_, 0.0); }
  /// No time has passed: contacts that are not new go on with what they remembered.
  void keep() {
    for (std::size_t i = 0; i < previous_.size(); ++i)
      if (previous_[i] != ContactMemory::none) std::copy_n(before(i), size_, now(i));
  }
  void reorder(const Reordering& change) {
    const auto order = keys_.reorder(change);
    std::vector<double> sorted(size_ * order.size());
    for (std::size_t k = 0; k < order.size(); ++k) std::copy_n(row(now_, order[k]), size_, row(sorted, k));
    now_.swap(sorted);
  }
  /// By part, so that a law that remembers more or less than the one before goes on with what both do.
  void visit(StateVisitor& visitor) {
    keys_.visit(visitor, "smooth/contact");
    now_.resize(size_ * keys_.size());
    visit_part(visitor, "smooth/normal", 0, parts_.normal);
    visit_part(visitor, "smooth/friction", parts_.normal, parts_.friction);
    visit_part(visitor, "smooth/rolling", parts_.normal + parts_.friction, parts_.rolling);
    visit_part(visitor, "smooth/push", size_ - parts_.push, parts_.push);
  }

 private:
  void visit_part(StateVisitor& visitor, const char* name, std::size_t from, std::size_t numbers) {
    if (numbers == 0) return;
    std::vector<double> part;
    for (std::size_t k = 0; k < keys_.size(); ++k)
      part.insert(part.end(), row(now_, k) + from, row(now_, k) + from + numbers);
    visitor.records(RowsOf::contacts, name, numbers, part);
    for (std::size_t k = 0; k < keys_.size(); ++k)
      std::copy_n(row(part, 0) + numbers * k, numbers, row(now_, k) + from);
  }
  static bool is_zero(double x) { return x == 0.0 && !std::signbit(x); }
  double* row(std::vector<double>& records, std::size_t k) const { return records.data() + size_ * k; }

  RecordParts parts_;
  std::size_t size_;
  ContactMemory keys_;
  std::vector<std::uint32_t> previous_, turned_;
  std::vector<double> old_, now_, fresh_;
};

}  // namespace epafi
