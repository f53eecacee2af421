#include "engine/threads/exact_sum.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace epafi {

namespace {
__extension__ using Wide = unsigned __int128;
constexpr int lowest_bit = -1074;  // of a double
constexpr std::uint64_t fraction_bits = 0xfffffffffffff;
constexpr std::uint64_t low_half = 0xffffffff;

/// w 2^base to the nearest double, ties to even; sticky: something below w is not 0.
double nearest_double(Wide w, int base, bool sticky) {
  int lead = 127;
  while (!(w >> lead & 1)) --lead;
  const int drop = std::max({lead - 52, lowest_bit - base, 0});
  auto m = static_cast<std::uint64_t>(w >> drop);
  if (drop > 0) {
    const Wide rest = w & ((Wide{1} << drop) - 1), half = Wide{1} << (drop - 1);
    if (rest > half || (rest == half && (sticky || (m & 1) != 0))) ++m;
  }
  return std::ldexp(static_cast<double>(m), base + drop);
}
}  // namespace

void ExactSum::add(double x) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  const auto exponent = static_cast<unsigned>(bits >> 52 & 0x7ff);
  std::uint64_t m = bits & fraction_bits;
  if (exponent == 0x7ff) {
    not_a_number_ = not_a_number_ || m != 0;
    plus_infinity_ = plus_infinity_ || (m == 0 && x > 0.0);
    minus_infinity_ = minus_infinity_ || (m == 0 && x < 0.0);
    return;
  }
  if (exponent != 0) m |= fraction_bits + 1;
  const unsigned shift = exponent == 0 ? 0 : exponent - 1;  // of its lowest bit above that of all doubles
  const Wide w = Wide{m} << shift % 32;                     // 84 bits at most: three limbs
  const std::int64_t sign = x < 0.0 ? -1 : 1;
  for (unsigned k = 0; k < 3; ++k)
    limb_[shift / 32 + k] += sign * static_cast<std::int64_t>(static_cast<std::uint64_t>(w >> 32 * k) & low_half);
  if (++pending_ >= most_pending) carry();
}

/// Each limb but the last one comes into [0, 2^32).
void ExactSum::carry() {
  std::int64_t over = 0;
  for (std::size_t k = 0; k + 1 < limbs; ++k) {
    const std::int64_t t = limb_[k] + over;
    over = t >> 32;
    limb_[k] = t - (over << 32);
  }
  limb_[limbs - 1] += over;
  pending_ = 1;
}

ExactSum& ExactSum::operator+=(const ExactSum& other) {
  ExactSum o = other;
  o.carry();
  carry();
  for (std::size_t k = 0; k < limbs; ++k) limb_[k] += o.limb_[k];
  pending_ = 2;
  plus_infinity_ = plus_infinity_ || o.plus_infinity_;
  minus_infinity_ = minus_infinity_ || o.minus_infinity_;
  not_a_number_ = not_a_number_ || o.not_a_number_;
  return *this;
}

double ExactSum::value() const {
  constexpr double infinite = std::numeric_limits<double>::infinity();
  if (not_a_number_ || (plus_infinity_ && minus_infinity_)) return std::numeric_limits<double>::quiet_NaN();
  if (plus_infinity_) return infinite;
  return minus_infinity_ ? -infinite : finite_value();
}

double ExactSum::finite_value() const {
  ExactSum n = *this;
  n.carry();
  const bool negative = n.is_negative();
  if (negative) {
    for (std::int64_t& limb : n.limb_) limb = -limb;
    n.carry();
  }
  std::size_t top = limbs - 1;
  while (top > 0 && n.limb_[top] == 0) --top;
  Wide w = 0;  // the four highest limbs; what is below decides ties alone
  for (std::size_t k = 0; k < 4; ++k)
    w = w << 32 | (top >= k ? static_cast<Wide>(static_cast<std::uint64_t>(n.limb_[top - k])) : Wide{0});
  if (w == 0) return 0.0;
  bool sticky = false;
  for (std::size_t k = 4; k <= top; ++k) sticky = sticky || n.limb_[top - k] != 0;
  const double v = nearest_double(w, 32 * (static_cast<int>(top) - 3) + lowest_bit, sticky);
  return negative ? -v : v;
}

}  // namespace epafi
