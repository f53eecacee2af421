/// @file lane_bits.h  Comparisons of lanes as bits of a number, and the places of the bits that are set.
#pragma once
#include <array>
#include <cstdint>
#include <cstring>

#include "engine/lanes/lanes.h"
#include "engine/lanes/targets.h"  // declares the builtins of all targets

/// Behind the parameters of a lambda that works on lanes: a function of its own keeps the baseline
/// (engine/lanes/targets.h).
#define EPAFI_INLINED __attribute__((always_inline))

/// 1 where GCC has the builtins of AVX-512. GCC checks the target of a builtin where it is inlined.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(EPAFI_ONE_TARGET)
#define EPAFI_WIDE_BUILTINS 1
#else
#define EPAFI_WIDE_BUILTINS 0
#endif

namespace epafi {

/// One bit for each of n lanes of a mask.
template <int n, class Mask>
EPAFI_LANES unsigned lane_bits(Mask mask) {
  unsigned bits = 0;
  for (int l = 0; l < n; ++l) bits |= static_cast<unsigned>(mask[l] & 1) << l;
  return bits;
}

/// One bit for each lane where a < b.
template <int n>
EPAFI_LANES unsigned less_bits(typename LanesOf<n>::Real a, typename LanesOf<n>::Real b) {
#if EPAFI_WIDE_BUILTINS  // a mask of lanes would be taken apart one by one
  if constexpr (n == 2)
    return static_cast<unsigned>(__builtin_ia32_movmskpd(reinterpret_cast<LanesOf<2>::Real>(a < b)));
  if constexpr (n == 4) return static_cast<unsigned>(__builtin_ia32_movmskpd256(reinterpret_cast<Lanes>(a < b)));
  if constexpr (n == 8) return static_cast<std::uint8_t>(__builtin_ia32_cmppd512_mask(a, b, 1, -1, 4));
#else
  return lane_bits<n>(a < b);
#endif
}

template <int n>
struct FloatsOf {
  typedef float Real __attribute__((vector_size(4 * n)));
};
/// The same of n floats: 4, 8 or 16.
template <int n>
EPAFI_LANES unsigned less_float_bits(typename FloatsOf<n>::Real a, typename FloatsOf<n>::Real b) {
#if EPAFI_WIDE_BUILTINS
  if constexpr (n == 4)
    return static_cast<unsigned>(__builtin_ia32_movmskps(reinterpret_cast<FloatsOf<4>::Real>(a < b)));
  if constexpr (n == 8)
    return static_cast<unsigned>(__builtin_ia32_movmskps256(reinterpret_cast<FloatsOf<8>::Real>(a < b)));
  if constexpr (n == 16) return static_cast<std::uint16_t>(__builtin_ia32_cmpps512_mask(a, b, 1, -1, 4));
#else
  return lane_bits<n>(a < b);
#endif
}

/// Places of the set bits of eight, and how many they are.
struct BitPlaces {
  std::array<std::array<std::uint8_t, 8>, 256> at{};
  std::array<std::uint8_t, 256> count{};
};
inline constexpr BitPlaces bit_places = [] {
  BitPlaces out;
  for (unsigned bits = 0; bits < 256; ++bits)
    for (std::uint8_t l = 0; l < 8; ++l)
      if (bits >> l & 1u) out.at[bits][out.count[bits]++] = l;
  return out;
}();
#if EPAFI_WIDE_BUILTINS
/// The eight of `at` as the lower half of a register: a conversion of eight bytes alone goes number by number.
EPAFI_LANES auto place_bytes(unsigned bits) {
  using Bytes = char __attribute__((vector_size(16)));
  long long eight;
  std::memcpy(&eight, bit_places.at[bits].data(), sizeof eight);
  return reinterpret_cast<Bytes>(LanesOf<2>::Mask{eight, 0});
}
#endif
/// Writes from[l] of the bits l of n that are set, one behind the other, and returns how many; n are read and written.
template <int n>
EPAFI_LANES unsigned write_chosen(unsigned bits, const std::uint32_t* from, std::uint32_t* to) {
  if constexpr (n == 16) {
    const unsigned first = write_chosen<8>(bits & 0xffu, from, to);
    return first + write_chosen<8>(bits >> 8, from + 8, to + first);
  }
#if EPAFI_WIDE_BUILTINS
  if constexpr (n == 8) {
    using Eight = int __attribute__((vector_size(32)));
    Eight all;
    std::memcpy(&all, from, sizeof all);
    const Eight chosen = __builtin_shuffle(all, __builtin_ia32_pmovzxbd256(place_bytes(bits)));
    std::memcpy(to, &chosen, sizeof chosen);
    return static_cast<unsigned>(__builtin_popcount(bits));  // one instruction there
  }
#endif
  for (unsigned l = 0; l < n; ++l) to[l] = from[bit_places.at[bits][l]];
  return bit_places.count[bits];
}

}  // namespace epafi
