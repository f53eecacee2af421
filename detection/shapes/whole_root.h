/// @file whole_root.h  x^k and x^(1/k) for whole k, several numbers at a time; + - * / and sqrt only, so that no libm
/// decides a bit of a run. A root is 2^(log2(x)/k) by short series, right to 4e-7, and one step of Halley's method,
/// which cubes the error: within 4 ulp.
#pragma once
#include <bit>

#include "engine/lanes/lanes.h"

namespace epafi {

template <class V>
EPAFI_LANES V whole_power_of(V x, int k, V one) {
  V result = k & 1 ? x : one;
  while (k >>= 1) {
    x = x * x;
    if (k & 1) result = result * x;
  }
  return result;
}

namespace root_detail {

/// Within 4e-7 of x^(1/k) for every normal x > 0, k >= 3.
template <LaneVector V>
EPAFI_LANES V near_root(V x, double one_over_k) {
  using M = MaskOf<V>;
  constexpr long long half_root = 0x3fe6a09e667f3bcd, bias = 1024, mantissa = 52;  // half_root: bits of sqrt(1/2)
  constexpr double whole = 0x1p52, nearest = 0x1.8p52;  // added to a double their last bits count units
  const M bits = reinterpret_cast<M>(x);
  using Bits [[gnu::vector_size(sizeof(V))]] = unsigned long long;
  const M exponent = reinterpret_cast<M>(reinterpret_cast<Bits>(bits - half_root + (bias << mantissa)) >>
                                         mantissa);  // of x = f 2^e, f from sqrt(1/2) to sqrt(2)
  const V e = reinterpret_cast<V>(exponent | std::bit_cast<long long>(whole)) - (whole + bias);
  const V f = reinterpret_cast<V>(bits - ((exponent - bias) << mantissa));
  const V z = (f - 1.0) / (f + 1.0), zz = z * z;
  constexpr double two_over_ln2 = 2.8853900817779268, ln2 = 0.69314718055994531;
  const V log2 = e + two_over_ln2 * z * (1.0 + zz * (1.0 / 3 + zz * 0.2));
  const V t = log2 * one_over_k;
  const V shifted = t + nearest;
  const V r = ln2 * (t - (shifted - nearest)), rr = r * r;
  const V fraction = (1.0 + r) + rr * ((0.5 + r * (1.0 / 6)) + rr * ((1.0 / 24 + r * (1.0 / 120)) + rr * (1.0 / 720)));
  return reinterpret_cast<V>(reinterpret_cast<M>(fraction) + (reinterpret_cast<M>(shifted) << mantissa));
}

}  // namespace root_detail

/// x^(1/k) of each lane, k >= 1; 0 where x is 0 or below 2^-1000.
template <LaneVector V>
EPAFI_LANES V whole_roots(V x, int k) {
  if (k == 1) return x;
  if (k == 2) return sqrt(x);
  if (k == 4) return sqrt(sqrt(x));
  const double n = k;
  const V zero = x - x, one = zero + 1.0;
  const MaskOf<V> normal = x > 0x1p-1000;
  const V base = select(normal, x, one);
  const V y = root_detail::near_root(base, 1.0 / n);
  const V power = whole_power_of(y, k, one);
  return keep(normal, y + y * (2.0 * (base - power) / ((n + 1.0) * power + (n - 1.0) * base)));
}

/// The same for one number, for any x >= 0.
inline double whole_power(double x, int k) { return whole_power_of(x, k, 1.0); }
double whole_root(double x, int k);

}  // namespace epafi
