/// @file lanes.h  Several numbers at a time, in GCC's and Clang's vector types: two, four or eight, as many as fill a
/// register of the function's target (SSE2, AVX2, AVX-512); `Lanes`, four, on whatever there is. Each lane sees
/// + - * / and sqrt in the order written (no contraction), so every width and target gives the same bits.
#pragma once
#include <cmath>
#include <concepts>
#include <cstdint>

namespace epafi {

template <int n>
struct LanesOf {
  typedef double Real __attribute__((vector_size(8 * n)));  // NOLINT: GCC takes the attribute of a template here only
  typedef long long Mask __attribute__((vector_size(8 * n)));
};

inline constexpr int lane_count = 4;
using Lanes = LanesOf<lane_count>::Real;
using LaneMask = LanesOf<lane_count>::Mask;

template <class V>
concept LaneVector = std::same_as<V, LanesOf<2>::Real> || std::same_as<V, Lanes> || std::same_as<V, LanesOf<8>::Real>;
template <LaneVector V>
using MaskOf = typename LanesOf<sizeof(V) / sizeof(double)>::Mask;

#define EPAFI_LANES [[gnu::always_inline]] inline

EPAFI_LANES Lanes lanes(double x) { return Lanes{x, x, x, x}; }
template <LaneVector V>
EPAFI_LANES V sqrt(V x) {
  if constexpr (sizeof(V) == 16) return V{std::sqrt(x[0]), std::sqrt(x[1])};
  if constexpr (sizeof(V) == 32) return V{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
  if constexpr (sizeof(V) == 64)
    return V{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3]),
             std::sqrt(x[4]), std::sqrt(x[5]), std::sqrt(x[6]), std::sqrt(x[7])};
}
template <LaneVector V>
EPAFI_LANES V select(MaskOf<V> mask, V yes, V no) {
  return mask ? yes : no;
}
template <LaneVector V>
EPAFI_LANES V max(V a, V b) {
  return a < b ? b : a;
}
template <LaneVector V>
EPAFI_LANES V min(V a, V b) {
  return b < a ? b : a;
}
/// x where the mask is set, else 0, also for NaN.
template <LaneVector V>
EPAFI_LANES V keep(MaskOf<V> mask, V x) {
  return reinterpret_cast<V>(reinterpret_cast<MaskOf<V>>(x) & mask);
}
EPAFI_LANES bool any(LaneMask mask) { return (mask[0] | mask[1] | mask[2] | mask[3]) != 0; }

/// The same for one number, so that a formula serves both.
EPAFI_LANES double select(bool mask, double yes, double no) { return mask ? yes : no; }
EPAFI_LANES double sqrt(double x) { return std::sqrt(x); }
EPAFI_LANES double max(double a, double b) { return a < b ? b : a; }
EPAFI_LANES double min(double a, double b) { return b < a ? b : a; }

/// Rows become columns.
EPAFI_LANES void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  const Lanes p = __builtin_shufflevector(a, b, 0, 4, 2, 6), q = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Lanes r = __builtin_shufflevector(c, d, 0, 4, 2, 6), s = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(p, r, 0, 1, 4, 5);
  c = __builtin_shufflevector(p, r, 2, 3, 6, 7);
  b = __builtin_shufflevector(q, s, 0, 1, 4, 5);
  d = __builtin_shufflevector(q, s, 2, 3, 6, 7);
}

/// Vectors of as many contacts as V has lanes.
template <LaneVector V>
struct VectorsOf {
  V x, y, z;
  EPAFI_LANES V dot(const VectorsOf& o) const { return x * o.x + y * o.y + z * o.z; }
  EPAFI_LANES VectorsOf cross(const VectorsOf& o) const {
    return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x};
  }
};
template <LaneVector V>
EPAFI_LANES VectorsOf<V> operator+(const VectorsOf<V>& a, const VectorsOf<V>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <LaneVector V>
EPAFI_LANES VectorsOf<V> operator-(const VectorsOf<V>& a, const VectorsOf<V>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <LaneVector V>
EPAFI_LANES VectorsOf<V> operator*(const V& s, const VectorsOf<V>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <LaneVector V>
EPAFI_LANES VectorsOf<V> operator*(double s, const VectorsOf<V>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <LaneVector V>
EPAFI_LANES VectorsOf<V> operator-(const VectorsOf<V>& a) {
  return {-a.x, -a.y, -a.z};
}
using Lanes3 = VectorsOf<Lanes>;

}  // namespace epafi
