/// @file hash.h  A 64-bit hash of bits: for comparing states, not for security. Mixing step of SplitMix64 (Steele et
/// al. 2014).
#pragma once
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>

namespace epafi {

constexpr std::uint64_t mix_bits(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

class Hash {
 public:
  void add(std::uint64_t bits) { state_ = mix_bits(state_ ^ bits); }
  /// Adds doubles bit by bit; -0 and +0 differ, which is meant.
  void add(const double* values, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) add(std::bit_cast<std::uint64_t>(values[i]));
  }
  void add(std::string_view text) {
    for (char c : text) add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
    add(text.size());
  }
  std::uint64_t value() const { return state_; }
  std::string hex() const {
    std::string out(16, '0');
    for (int i = 0; i < 16; ++i) out[static_cast<std::size_t>(15 - i)] = "0123456789abcdef"[(state_ >> (4 * i)) & 15];
    return out;
  }

 private:
  std::uint64_t state_ = 0x45504146492d3031ULL;
};

}  // namespace epafi
