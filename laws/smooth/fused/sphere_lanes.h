/// @file sphere_lanes.h  What the loop over contacts of spheres does with lanes of 2, 4 or 8 contacts: rows of bodies
/// into columns and back, the lanes whose contact touches moved to the front, sums that do not depend on the width.
#pragma once
#include <array>
#include <cstring>

#include "engine/lane_bits.h"

namespace epafi {

/// Four numbers of a body as two registers of SSE2.
struct HalfRows {
  LanesOf<2>::Real xy, zw;
  EPAFI_LANES HalfRows operator+(const HalfRows& o) const { return {xy + o.xy, zw + o.zw}; }
  EPAFI_LANES HalfRows operator-(const HalfRows& o) const { return {xy - o.xy, zw - o.zw}; }
  EPAFI_LANES HalfRows operator*(const HalfRows& o) const { return {xy * o.xy, zw * o.zw}; }
  EPAFI_LANES HalfRows operator-() const { return {-xy, -zw}; }
};
template <int n>
using RowOf = std::conditional_t<n == 2, HalfRows, Lanes>;

template <int n>
EPAFI_LANES RowOf<n> row(const Lanes& x) {
  if constexpr (n == 2) {
    const auto* half = reinterpret_cast<const LanesOf<2>::Real*>(&x);
    return {half[0], half[1]};
  } else {
    return x;
  }
}
template <int n>
EPAFI_LANES void store(Lanes& to, const RowOf<n>& x) {
  if constexpr (n == 2) {
    auto* half = reinterpret_cast<LanesOf<2>::Real*>(&to);
    half[0] = x.xy, half[1] = x.zw;
  } else {
    to = x;
  }
}

EPAFI_LANES Lanes flip_fourth(Lanes x) {
  constexpr LaneMask sign{0, 0, 0, static_cast<long long>(1ull << 63)};
  return reinterpret_cast<Lanes>(reinterpret_cast<LaneMask>(x) ^ sign);
}
EPAFI_LANES HalfRows flip_fourth(HalfRows x) {
  constexpr LanesOf<2>::Mask sign{0, static_cast<long long>(1ull << 63)};
  return {x.xy, reinterpret_cast<LanesOf<2>::Real>(reinterpret_cast<LanesOf<2>::Mask>(x.zw) ^ sign)};
}
EPAFI_LANES Lanes turn_three(Lanes x) {
  constexpr auto sign = static_cast<long long>(1ull << 63);
  return reinterpret_cast<Lanes>(reinterpret_cast<LaneMask>(x) ^ LaneMask{sign, sign, sign, 0});
}
EPAFI_LANES HalfRows turn_three(HalfRows x) {
  constexpr LanesOf<2>::Mask sign{static_cast<long long>(1ull << 63), 0};
  return {-x.xy, reinterpret_cast<LanesOf<2>::Real>(reinterpret_cast<LanesOf<2>::Mask>(x.zw) ^ sign)};
}
/// b - a, in the fourth b + a. A product with 1 or -1 is exact: fused with the sum it has the bits of the two alone.
template <int n>
EPAFI_LANES RowOf<n> apart(const Lanes& a, const Lanes& b) {
#if EPAFI_WIDE_BUILTINS
  if constexpr (n > 2) return __builtin_ia32_vfmaddpd256(Lanes{-1.0, -1.0, -1.0, 1.0}, a, b);
#endif
  return row<n>(b) - flip_fourth(row<n>(a));
}

/// The same number four times.
template <int n>
EPAFI_LANES RowOf<n> splat(double x) {
  if constexpr (n == 2)
    return {LanesOf<2>::Real{x, x}, LanesOf<2>::Real{x, x}};
  else
    return lanes(x);
}
EPAFI_LANES Lanes without_fourth(Lanes x) { return __builtin_shufflevector(x, Lanes{}, 0, 1, 2, 4); }
EPAFI_LANES HalfRows without_fourth(HalfRows x) {
  return {x.xy, __builtin_shufflevector(x.zw, LanesOf<2>::Real{}, 0, 2)};
}
/// x y z of the one, the fourth number of the other.
EPAFI_LANES Lanes with_fourth(Lanes x, Lanes of) { return __builtin_shufflevector(x, of, 0, 1, 2, 7); }
EPAFI_LANES HalfRows with_fourth(HalfRows x, HalfRows of) { return {x.xy, __builtin_shufflevector(x.zw, of.zw, 0, 3)}; }
EPAFI_LANES Lanes least(Lanes a, Lanes b) { return min(a, b); }
EPAFI_LANES HalfRows least(HalfRows a, HalfRows b) { return {min(a.xy, b.xy), min(a.zw, b.zw)}; }
EPAFI_LANES Lanes most(Lanes a, Lanes b) { return max(a, b); }
EPAFI_LANES HalfRows most(HalfRows a, HalfRows b) { return {max(a.xy, b.xy), max(a.zw, b.zw)}; }
EPAFI_LANES bool is_zero(Lanes x) { return (x[0] + x[1]) + (x[2] + x[3]) == 0.0; }
EPAFI_LANES bool is_zero(HalfRows x) { return (x.xy[0] + x.xy[1]) + (x.zw[0] + x.zw[1]) == 0.0; }
/// Three numbers of a column; the fourth is 0.
template <int n>
EPAFI_LANES RowOf<n> load(const double* from) {
  if constexpr (n == 2) {
    HalfRows out{{}, {from[2], 0.0}};
    std::memcpy(&out.xy, from, sizeof out.xy);
    return out;
  } else {
    return Lanes{from[0], from[1], from[2], 0.0};
  }
}
template <int n>
EPAFI_LANES void write(double* to, const RowOf<n>& x) {
  LanesOf<2>::Real low;
  if constexpr (n == 2)
    low = x.xy, to[2] = x.zw[0];
  else
    low = __builtin_shufflevector(x, x, 0, 1), to[2] = x[2];
  std::memcpy(to, &low, sizeof low);
}

/// One behind the other. GCC 12 makes three instructions of the shuffle alone.
EPAFI_LANES LanesOf<8>::Real join(Lanes a, Lanes b) {
#if EPAFI_WIDE_BUILTINS
  return __builtin_ia32_insertf64x4_mask(__builtin_ia32_pd512_256pd(a), b, 1, LanesOf<8>::Real{}, -1);
#else
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
#endif
}

/// Of n rows f(lane): their numbers as columns.
template <class F>
EPAFI_LANES void read_columns(const F& f, LanesOf<2>::Real& x, LanesOf<2>::Real& y, LanesOf<2>::Real& z,
                              LanesOf<2>::Real& w) {
  const HalfRows a = f(0), b = f(1);
  x = __builtin_shufflevector(a.xy, b.xy, 0, 2), y = __builtin_shufflevector(a.xy, b.xy, 1, 3);
  z = __builtin_shufflevector(a.zw, b.zw, 0, 2), w = __builtin_shufflevector(a.zw, b.zw, 1, 3);
}
template <class F>
EPAFI_LANES void read_columns(const F& f, Lanes& x, Lanes& y, Lanes& z, Lanes& w) {
  x = f(0), y = f(1), z = f(2), w = f(3);
  transpose(x, y, z, w);
}
template <class F>
EPAFI_LANES void read_columns(const F& f, LanesOf<8>::Real& x, LanesOf<8>::Real& y, LanesOf<8>::Real& z,
                              LanesOf<8>::Real& w) {
  using Eight = LanesOf<8>::Real;
  const auto two = [&](int i, int j) EPAFI_INLINED {
    const Lanes a = f(i), b = f(j);
    return join(a, b);
  };
  const Eight ac = two(0, 2), bd = two(1, 3), eg = two(4, 6), fh = two(5, 7);
  const Eight p = __builtin_shufflevector(ac, bd, 0, 8, 2, 10, 4, 12, 6, 14);
  const Eight q = __builtin_shufflevector(ac, bd, 1, 9, 3, 11, 5, 13, 7, 15);
  const Eight r = __builtin_shufflevector(eg, fh, 0, 8, 2, 10, 4, 12, 6, 14);
  const Eight s = __builtin_shufflevector(eg, fh, 1, 9, 3, 11, 5, 13, 7, 15);
  x = __builtin_shufflevector(p, r, 0, 1, 4, 5, 8, 9, 12, 13);
  z = __builtin_shufflevector(p, r, 2, 3, 6, 7, 10, 11, 14, 15);
  y = __builtin_shufflevector(q, s, 0, 1, 4, 5, 8, 9, 12, 13);
  w = __builtin_shufflevector(q, s, 2, 3, 6, 7, 10, 11, 14, 15);
}

/// The other way: rows[lane].
EPAFI_LANES void write_rows(LanesOf<2>::Real x, LanesOf<2>::Real y, LanesOf<2>::Real z, LanesOf<2>::Real w,
                            HalfRows* rows) {
  rows[0] = {__builtin_shufflevector(x, y, 0, 2), __builtin_shufflevector(z, w, 0, 2)};
  rows[1] = {__builtin_shufflevector(x, y, 1, 3), __builtin_shufflevector(z, w, 1, 3)};
}
EPAFI_LANES void write_rows(Lanes x, Lanes y, Lanes z, Lanes w, Lanes* rows) {
  transpose(x, y, z, w);
  rows[0] = x, rows[1] = y, rows[2] = z, rows[3] = w;
}
EPAFI_LANES void write_rows(LanesOf<8>::Real x, LanesOf<8>::Real y, LanesOf<8>::Real z, LanesOf<8>::Real w,
                            Lanes* rows) {
  using Eight = LanesOf<8>::Real;
  const Eight p = __builtin_shufflevector(x, y, 0, 8, 2, 10, 4, 12, 6, 14);
  const Eight q = __builtin_shufflevector(x, y, 1, 9, 3, 11, 5, 13, 7, 15);
  const Eight r = __builtin_shufflevector(z, w, 0, 8, 2, 10, 4, 12, 6, 14);
  const Eight s = __builtin_shufflevector(z, w, 1, 9, 3, 11, 5, 13, 7, 15);
  const auto split = [](Eight two, Lanes& a, Lanes& b) EPAFI_INLINED {
    a = __builtin_shufflevector(two, two, 0, 1, 2, 3), b = __builtin_shufflevector(two, two, 4, 5, 6, 7);
  };
  split(__builtin_shufflevector(p, r, 0, 1, 8, 9, 4, 5, 12, 13), rows[0], rows[4]);
  split(__builtin_shufflevector(q, s, 0, 1, 8, 9, 4, 5, 12, 13), rows[1], rows[5]);
  split(__builtin_shufflevector(p, r, 2, 3, 10, 11, 6, 7, 14, 15), rows[2], rows[6]);
  split(__builtin_shufflevector(q, s, 2, 3, 10, 11, 6, 7, 14, 15), rows[3], rows[7]);
}

/// Rows of two.
EPAFI_LANES void write_twos(LanesOf<2>::Real x, LanesOf<2>::Real y, LanesOf<2>::Real* rows) {
  rows[0] = __builtin_shufflevector(x, y, 0, 2), rows[1] = __builtin_shufflevector(x, y, 1, 3);
}
EPAFI_LANES void write_twos(Lanes x, Lanes y, LanesOf<2>::Real* rows) {
  const Lanes even = __builtin_shufflevector(x, y, 0, 4, 2, 6), odd = __builtin_shufflevector(x, y, 1, 5, 3, 7);
  rows[0] = __builtin_shufflevector(even, even, 0, 1), rows[1] = __builtin_shufflevector(odd, odd, 0, 1);
  rows[2] = __builtin_shufflevector(even, even, 2, 3), rows[3] = __builtin_shufflevector(odd, odd, 2, 3);
}

/// Rows of two vectors side by side, 0 0 behind them.
EPAFI_LANES void write_sixes(const VectorsOf<LanesOf<8>::Real>& a, const VectorsOf<LanesOf<8>::Real>& b,
                             LanesOf<8>::Real* rows) {
  using Eight = LanesOf<8>::Real;
  const auto fours = [](Eight x, Eight y, Eight z, Eight w, Eight* of) EPAFI_INLINED {  // lanes 0 4, 1 5, 2 6, 3 7
    const Eight p = __builtin_shufflevector(x, y, 0, 8, 2, 10, 4, 12, 6, 14);
    const Eight q = __builtin_shufflevector(x, y, 1, 9, 3, 11, 5, 13, 7, 15);
    const Eight r = __builtin_shufflevector(z, w, 0, 8, 2, 10, 4, 12, 6, 14);
    const Eight s = __builtin_shufflevector(z, w, 1, 9, 3, 11, 5, 13, 7, 15);
    of[0] = __builtin_shufflevector(p, r, 0, 1, 8, 9, 4, 5, 12, 13);
    of[1] = __builtin_shufflevector(q, s, 0, 1, 8, 9, 4, 5, 12, 13);
    of[2] = __builtin_shufflevector(p, r, 2, 3, 10, 11, 6, 7, 14, 15);
    of[3] = __builtin_shufflevector(q, s, 2, 3, 10, 11, 6, 7, 14, 15);
  };
  Eight first[4], second[4];
  fours(a.x, a.y, a.z, b.x, first), fours(b.y, b.z, Eight{}, Eight{}, second);
  for (int l = 0; l < 4; ++l) {
    rows[l] = __builtin_shufflevector(first[l], second[l], 0, 1, 2, 3, 8, 9, 10, 11);
    rows[l + 4] = __builtin_shufflevector(first[l], second[l], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

/// max(x, low) and min(x, high); NaN stays. Of those with a constant GCC 12 makes a comparison and a choice, four
/// micro-operations for one: 2 % of the step of a bed by SSE2 and by AVX2.
template <int n>
EPAFI_LANES typename LanesOf<n>::Real at_least(typename LanesOf<n>::Real x, double low) {
  const auto bound = typename LanesOf<n>::Real{} + low;
#if EPAFI_WIDE_BUILTINS
  if constexpr (n == 2) return __builtin_ia32_maxpd(bound, x);
  if constexpr (n == 4) return __builtin_ia32_maxpd256(bound, x);
  if constexpr (n == 8) return __builtin_ia32_maxpd512_mask(bound, x, bound, -1, 4);
#else
  return max(x, bound);
#endif
}
template <int n>
EPAFI_LANES typename LanesOf<n>::Real at_most(typename LanesOf<n>::Real x, double high) {
  const auto bound = typename LanesOf<n>::Real{} + high;
#if EPAFI_WIDE_BUILTINS
  if constexpr (n == 2) return __builtin_ia32_minpd(bound, x);
  if constexpr (n == 4) return __builtin_ia32_minpd256(bound, x);
  if constexpr (n == 8) return __builtin_ia32_minpd512_mask(bound, x, bound, -1, 4);
#else
  return min(x, bound);
#endif
}

/// Writes `first` plus each of them for n lanes.
template <int n>
EPAFI_LANES void write_places(unsigned bits, std::uint32_t first, std::uint32_t* to) {
#if EPAFI_WIDE_BUILTINS
  if constexpr (n == 8) {
    using Eight = int __attribute__((vector_size(32)));
    const Eight places = __builtin_ia32_pmovzxbd256(place_bytes(bits)) + static_cast<int>(first);
    std::memcpy(to, &places, sizeof places);
    return;
  }
#endif
  if constexpr (n == 2)
    to[0] = first, to[bits & 1u] = first + 1;
  else
    for (std::uint32_t l = 0; l < n; ++l) to[l] = first + bit_places.at[bits][l];
}
/// The same for four lanes, each of two halves.
inline constexpr auto half_places = [] {
  std::array<std::array<std::int32_t, 8>, 16> out{};
  for (unsigned bits = 0; bits < 16; ++bits)
    for (unsigned l = 0; l < 4; ++l)
      out[bits][2 * l] = 2 * bit_places.at[bits][l], out[bits][2 * l + 1] = 2 * bit_places.at[bits][l] + 1;
  return out;
}();

/// The lanes named by `bits`, and where they lie for the shuffle of n: found once for all columns.
template <int n>
struct ChosenLanes {
  using Places = std::int32_t __attribute__((vector_size(32)));
  unsigned bits;
  std::conditional_t<n == 8, LanesOf<8>::Mask, Places> from{};

  EPAFI_LANES explicit ChosenLanes(unsigned lanes) : bits(lanes) {
    if constexpr (n == 4) std::memcpy(&from, half_places[bits].data(), sizeof from);
    if constexpr (n == 8) {
#if EPAFI_WIDE_BUILTINS
      from = __builtin_ia32_pmovzxbq512_mask(place_bytes(bits), LanesOf<8>::Mask{}, -1);
#else
      using Bytes = std::uint8_t __attribute__((vector_size(8)));
      Bytes places;
      std::memcpy(&places, bit_places.at[bits].data(), sizeof places);
      from = __builtin_convertvector(places, LanesOf<8>::Mask);
#endif
    }
  }
};

/// Writes the chosen lanes one behind the other; those behind them may be written too.
template <int n>
EPAFI_LANES void compress(typename LanesOf<n>::Real x, const ChosenLanes<n>& chosen, void* to) {
  if constexpr (n == 2) {  // the second lane comes to where the first one is not wanted: no branch
    auto* numbers = static_cast<char*>(to);
    const double first = x[0], second = x[1];
    std::memcpy(numbers, &first, sizeof first);
    std::memcpy(numbers + (chosen.bits & 1u) * sizeof second, &second, sizeof second);
    return;
  }
#if defined(__clang__)
  if constexpr (n > 2) {
    const auto all = x;
    for (int l = 0; l < n; ++l) x[l] = all[bit_places.at[chosen.bits][static_cast<std::size_t>(l)]];
  }
#else
  if constexpr (n == 4) {
    using Halves = float __attribute__((vector_size(32)));
    x = reinterpret_cast<Lanes>(__builtin_shuffle(reinterpret_cast<Halves>(x), chosen.from));
  }
  if constexpr (n == 8) x = __builtin_shuffle(x, chosen.from);
#endif
  std::memcpy(to, &x, sizeof x);
}

/// Sums by the place of a contact among all, modulo eight: the same bits for every width.
template <int n>
struct LaneSum {
  static constexpr std::size_t parts = 8 / n;
  typename LanesOf<n>::Real part[parts]{};
  /// x(g): of group g of n; groups: a multiple of `parts`.
  template <class F>
  EPAFI_LANES void add(std::size_t groups, const F& x) {
    typename LanesOf<n>::Real sum[parts];  // in registers
    for (std::size_t p = 0; p < parts; ++p) sum[p] = part[p];
    for (std::size_t g = 0; g < groups; g += parts)
      for (std::size_t p = 0; p < parts; ++p) sum[p] += x(g + p);
    for (std::size_t p = 0; p < parts; ++p) part[p] = sum[p];
  }
  EPAFI_LANES double total() const {
    double s[8];
    std::memcpy(s, part, sizeof s);
    return ((s[0] + s[1]) + (s[2] + s[3])) + ((s[4] + s[5]) + (s[6] + s[7]));
  }
};

}  // namespace epafi
