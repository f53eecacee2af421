/// @file contact_order.h  Columns of remembered contacts after bodies were sorted or removed.
#pragma once
#include <algorithm>
#include <tuple>
#include <type_traits>
#include <vector>

#include "engine/state/contacts.h"

namespace epafi {

/// Puts element order[k] of each column into place k; empty columns stay empty.
template <class... Column>
void permute(const std::vector<std::uint32_t>& order, Column&... columns) {
  const auto one = [&](auto& column) {
    if (column.empty()) return;
    std::remove_reference_t<decltype(column)> sorted;
    sorted.reserve(order.size());
    for (const std::uint32_t k : order) sorted.push_back(column[k]);
    column.swap(sorted);
  };
  (one(columns), ...);
}

/// Gives the bodies their new slots, and returns the contacts of which both bodies are left, by (a, b, feature).
template <class Slots, class Features>
[[nodiscard]] std::vector<std::uint32_t> order_after(const Reordering& change, Slots& a, Slots& b,
                                                     const Features& feature) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t k = 0; k < a.size(); ++k) {
    a[k] = change.new_slot[a[k]];
    b[k] = change.new_slot[b[k]];
    if (a[k] != no_slot && b[k] != no_slot) order.push_back(k);
  }
  const auto key = [&](std::uint32_t k) { return std::tuple(a[k], b[k], feature[k]); };
  std::sort(order.begin(), order.end(), [&](std::uint32_t p, std::uint32_t q) { return key(p) < key(q); });
  return order;
}

}  // namespace epafi
