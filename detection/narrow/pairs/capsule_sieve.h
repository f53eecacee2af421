/// @file capsule_sieve.h  Pairs of capsules of a run, two, four or eight at a time. A list of elongated bodies contains
/// many separated pairs (five of six for 2000 settled capsules). Contacts of crossing axes are computed here with the
/// bits of the closed form; only nearly parallel axes need the closed form itself.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "detection/shapes/capsule.h"
#include "engine/state/contacts.h"

namespace epafi {

/// A pair that touches, or may.
struct NearCapsules {
  std::uint32_t pair;  ///< its index in the run
  bool is_found;       ///< `point` is its contact; else call collide_closed
  ContactPoint point;
};

/// Results in the order of `pairs`. reach(pair): largest gap of a contact [m], as for collide_closed. The result is
/// valid until the next call on the same thread.
template <class Reach>
std::span<const NearCapsules> near_capsules(const World& world, std::span<const Capsule> shapes,
                                            std::span<const Pair> pairs, const Reach& reach);

/// The same for a run that is not too long; reach: by pair.
class CapsuleSieve {
 public:
  static constexpr std::size_t room = 256;
  void take(const World& world, std::span<const Capsule> shapes, std::span<const Pair> pairs,
            std::span<const double> reach, std::uint32_t first);
  std::vector<NearCapsules> near;
};

template <class Reach>
std::span<const NearCapsules> near_capsules(const World& world, std::span<const Capsule> shapes,
                                            std::span<const Pair> pairs, const Reach& reach) {
  static thread_local CapsuleSieve sieve;
  static thread_local std::vector<double> reaches;
  sieve.near.clear();
  for (std::size_t first = 0; first < pairs.size(); first += CapsuleSieve::room) {
    const auto some = pairs.subspan(first, std::min(CapsuleSieve::room, pairs.size() - first));
    reaches.clear();
    for (const Pair& p : some) reaches.push_back(reach(p));
    sieve.take(world, shapes, some, reaches, static_cast<std::uint32_t>(first));
  }
  return sieve.near;
}

}  // namespace epafi
