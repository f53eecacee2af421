/// @file islands.h  The parts of a problem that do not influence each other: contacts joined by bodies that can move
/// (or by blocks of W). Ordered by their first contact, which is that of the smallest body; contacts keep their order.
#pragma once
#include "laws/nonsmooth/cone_problem.h"

namespace epafi {

class Islands {
 public:
  void find(const ConeProblem& problem);
  std::size_t size() const { return begin_.size() - 1; }
  std::size_t contact_count() const { return order_.size(); }
  /// Contacts of island k, ascending.
  std::span<const std::uint32_t> contacts(std::size_t k) const {
    return {order_.data() + begin_[k], begin_[k + 1] - begin_[k]};
  }
  /// Island k as a problem of its own. Its residuals are relative to its share of the whole, so that the whole meets a
  /// tolerance that all islands meet.
  void extract(const ConeProblem& problem, std::size_t k, ConeProblem& out) const;

 private:
  std::uint32_t root(std::uint32_t i);

  double norm_ = 0.0;  ///< of q of the whole problem: once, not for every island
  std::vector<std::uint32_t> parent_, first_;
  std::vector<std::uint32_t> island_;  ///< of each contact
  std::vector<std::size_t> begin_{0};
  std::vector<std::uint32_t> order_;
  std::vector<std::uint32_t> place_;       ///< of each contact in its island
  std::vector<std::uint32_t> body_place_;  ///< of each body in its island
};

}  // namespace epafi
