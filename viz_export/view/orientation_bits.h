/// @file orientation_bits.h  A unit quaternion in 32 bits: which component is largest (2 bits), and the other three as
/// steps of sqrt(2)/1022 (10 bits each). The angle is off by 0.28 degrees at most.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>

#include "engine/state/types.h"

namespace epafi {

struct OrientationBits {
  std::uint32_t largest = 0;           ///< 0..3: w x y z
  std::array<std::int32_t, 3> rest{};  ///< 0..1023, of the others in the order w x y z
};

inline OrientationBits orientation_bits(const Quat& q) {
  const std::array<double, 4> c{q.w(), q.x(), q.y(), q.z()};
  OrientationBits out;
  for (std::uint32_t k = 1; k < 4; ++k)
    if (std::abs(c[k]) > std::abs(c[out.largest])) out.largest = k;
  const double sign = c[out.largest] < 0 ? -1.0 : 1.0;
  std::size_t next = 0;
  for (std::uint32_t k = 0; k < 4; ++k) {
    if (k == out.largest) continue;
    out.rest[next++] = static_cast<std::int32_t>(std::lround((sign * c[k] * std::sqrt(2.0) + 1.0) * 511.0));
  }
  return out;
}

inline Quat orientation_of(const OrientationBits& bits) {
  std::array<double, 4> c{};
  double squares = 0;
  std::size_t next = 0;
  for (std::uint32_t k = 0; k < 4; ++k) {
    if (k == bits.largest) continue;
    c[k] = (bits.rest[next++] / 511.0 - 1.0) / std::sqrt(2.0);
    squares += c[k] * c[k];
  }
  c[bits.largest] = std::sqrt(std::max(0.0, 1.0 - squares));
  return Quat(c[0], c[1], c[2], c[3]).normalized();
}

}  // namespace epafi
