/// @file lane_choice.h  Choices and roots for formulas of laws, of lanes and of one number. Conditions are numbers, 1
/// or 0: of masks joined by | and & GCC 12 makes scalars for AVX-512.
#pragma once
#include "engine/lanes/lane_bits.h"

namespace epafi {

/// a < b ? yes : no
EPAFI_LANES double if_less(double a, double b, double yes, double no) { return a < b ? yes : no; }
template <LaneVector V>
EPAFI_LANES V if_less(V a, V b, V yes, V no) {
#if EPAFI_WIDE_BUILTINS
  if constexpr (sizeof(V) == 64)
    return __builtin_ia32_blendmpd_512_mask(no, yes, __builtin_ia32_cmppd512_mask(a, b, 1, -1, 4));
#endif
  return a < b ? yes : no;
}

/// a < b in some lane.
EPAFI_LANES bool any_less(double a, double b) { return a < b; }
template <LaneVector V>
EPAFI_LANES bool any_less(V a, V b) {
  return less_bits<sizeof(V) / sizeof(double)>(a, b) != 0;
}

/// x^(1/3), x >= 0, to 1e-15 for x = 0 and from 1e-60 to 1e20: from x^(21/64) by Newton's steps, which are exact to the
/// square of the error before.
template <class Real>
EPAFI_LANES Real cube_root(Real x) {
  const Real fourth = sqrt(sqrt(x)), sixteenth = sqrt(sqrt(fourth)), last = sqrt(sqrt(sixteenth));
  Real y = fourth * sixteenth * last;
  for (int k = 0; k < 6; ++k) y = (2.0 * y + x / max(y * y, Real{} + 1e-200)) * (1.0 / 3.0);
  return y;
}

}  // namespace epafi
