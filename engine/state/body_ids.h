/// @file body_ids.h  Some bodies by id, in an order of their own. Consecutive ones are kept as their first and how
/// many: a million spheres of one name take 16 bytes.
#pragma once
#include <algorithm>
#include <vector>

#include "engine/state/types.h"

namespace epafi {

class BodyIds {
 public:
  void add(BodyId first, std::size_t count = 1) {
    const auto id = static_cast<std::uint32_t>(first);
    if (ranges_.empty() || ranges_.back().first + (size_ - ranges_.back().begin) != id) ranges_.push_back({size_, id});
    size_ += count;
  }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  BodyId operator[](std::size_t k) const {
    const auto range = std::prev(std::ranges::upper_bound(ranges_, k, {}, &Range::begin));
    return static_cast<BodyId>(range->first + (k - range->begin));
  }
  bool contains(BodyId body) const {
    const auto id = static_cast<std::uint32_t>(body);
    for (std::size_t r = 0; r < ranges_.size(); ++r) {
      const std::size_t end = r + 1 < ranges_.size() ? ranges_[r + 1].begin : size_;
      if (id - ranges_[r].first < end - ranges_[r].begin) return true;
    }
    return false;
  }

 private:
  struct Range {
    std::size_t begin;    ///< among all
    std::uint32_t first;  ///< id
  };
  std::vector<Range> ranges_;
  std::size_t size_ = 0;
};

}  // namespace epafi
