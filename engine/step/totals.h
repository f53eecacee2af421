/// @file totals.h  Sums over all bodies or all overlaps. They do not depend on the order, so sums of processes add up
/// to the bits of one process.
#pragma once
#include <algorithm>
#include <array>
#include <vector>

#include "engine/step/contact_pieces.h"
#include "engine/threads/order_free_sum.h"

namespace epafi {

/// Sums over free bodies; with several processes over those of this one.
struct BodyTotals {
  OrderFreeSum kinetic, potential;       ///< [J]
  OrderFreeSum mass;                     ///< [kg]
  std::array<OrderFreeSum, 3> momentum;  ///< m v [N s]
  OrderFreeSum momenta;                  ///< m |v| [N s]
  double farthest = 0.0;                 ///< from the origin [m]

  BodyTotals& operator+=(const BodyTotals& other);
};
BodyTotals body_totals(const World& world);

/// Sums over overlapping pairs; the overlap of a pair is that of its deepest point. Contacts that a model finds itself
/// (of spheres and balls of clumps) count individually.
struct OverlapTotals {
  double max = 0.0;           ///< [m]
  double max_relative = 0.0;  ///< to the smaller body's bounding radius
  OrderFreeSum sum;           ///< [m]
  std::size_t pairs = 0;

  OverlapTotals& operator+=(const OverlapTotals& other) {
    max = std::max(max, other.max);
    max_relative = std::max(max_relative, other.max_relative);
    sum += other.sum;
    pairs += other.pairs;
    return *this;
  }
};

/// radius(shape): bounding radius [m]; counts(a, b): contacts of these bodies are among those that are summed.
template <class Radius, class Counts>
OverlapTotals overlap_totals(const World& world, const ContactPieces& contacts, const Radius& radius,
                             const Counts& counts) {
  std::vector<OverlapTotals>& parts = block_results<OverlapTotals>(contacts.size(), OverlapTotals{});
  const auto sum_up = [&](std::size_t piece, const ContactSet& c, std::size_t begin, std::size_t end) {
    const auto same = [&](std::size_t k, std::size_t l) {
      return !contacts.is_own(piece) && c.a[k] == c.a[l] && c.b[k] == c.b[l];
    };
    thread_local std::vector<double> found;
    found.clear();
    OverlapTotals& part = parts[piece];
    for (std::size_t first = begin; first < end; ++first) {
      if (first > 0 && same(first - 1, first)) continue;  // the first contact of a pair stands for it
      double deepest = -c.gap[first];
      for (std::size_t k = first + 1; k < c.size() && same(first, k); ++k) deepest = std::max(deepest, -c.gap[k]);
      if (!(deepest > 0.0) || !counts(c.a[first], c.b[first])) continue;
      found.push_back(deepest);
      const double smaller = std::min(radius(world.shape[c.a[first]]), radius(world.shape[c.b[first]]));
      part.max = std::max(part.max, deepest);
      part.max_relative = std::max(part.max_relative, deepest / smaller);
    }
    part.sum.add(found);
    part.pairs += found.size();
  };
  parallel_for(
      contacts.size(),
      [&](std::size_t piece) {
        contacts.read_gaps(
            piece, [&](const ContactSet& c, std::size_t begin, std::size_t end) { sum_up(piece, c, begin, end); });
      },
      1);
  OverlapTotals all;
  for (const OverlapTotals& part : parts) all += part;
  return all;
}

}  // namespace epafi
