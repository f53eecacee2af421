/// @file random.h  Counter-based random numbers: a pure function of (seed, stream, draw), the same on every machine and
/// thread count.
#pragma once
#include "engine/state/hash.h"

namespace epafi {

class Random {
 public:
  /// One stream per body or purpose: its draws do not depend on what other streams drew.
  constexpr Random(std::uint64_t seed, std::uint64_t stream) : key_(mix_bits(mix_bits(seed) ^ mix_bits(~stream))) {}
  constexpr std::uint64_t bits() { return mix_bits(key_ ^ mix_bits(draw_++)); }
  /// Uniform in [0, 1), 53 bits.
  constexpr double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }
  constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }

 private:
  std::uint64_t key_;
  std::uint64_t draw_ = 0;
};

}  // namespace epafi
