/// @file record_memory.h  What is remembered of every contact: a record of as many numbers as a law asks for, carried
/// by contact key; the last step's beside this one's. A contact that begins has a record of zeros.
#pragma once
#include <algorithm>
#include <vector>

#include "engine/state/contacts.h"
#include "engine/state/state_visitor.h"

namespace epafi {

class RecordMemory {
 public:
  /// size: numbers of a record, at least 1.
  explicit RecordMemory(std::size_t size) : size_(size), fresh_(size) {}

  /// exchange(record): of a contact whose bodies A and B have changed places.
  template <class Exchange>
  void advance(const ContactSet& contacts, const Exchange& exchange) {
    turned_.clear();
    keys_.match(
        contacts, previous_, [&](std::size_t k) { return std::all_of(row(now_, k), row(now_, k + 1), is_zero); },
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
  void visit(StateVisitor& visitor) {
    keys_.visit(visitor, "smooth/contact");
    visitor.records(RowsOf::contacts, "smooth/record", size_, now_);
  }

 private:
  static bool is_zero(double x) { return x == 0.0 && !std::signbit(x); }
  double* row(std::vector<double>& records, std::size_t k) const { return records.data() + size_ * k; }

  std::size_t size_;
  ContactMemory keys_;
  std::vector<std::uint32_t> previous_, turned_;
  std::vector<double> old_, now_, fresh_;
};

}  // namespace epafi
