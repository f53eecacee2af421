/// @file lanes.h  Four numbers at a time, in GCC's and Clang's vector types: the compiler lays them on SSE2, AVX2 or
/// AVX-512 registers as the function's target allows. Each lane sees + - * / and sqrt in the order written (no
/// contraction), so every target gives the same bits.
#pragma once
#include <cmath>
#include <cstdint>

namespace epafi {

inline constexpr int lane_count = 4;
using Lanes = double __attribute__((vector_size(8 * lane_count)));
using LaneMask = long long __attribute__((vector_size(8 * lane_count)));

#define EPAFI_LANES [[gnu::always_inline]] inline

EPAFI_LANES Lanes lanes(double x) { return Lanes{x, x, x, x}; }
EPAFI_LANES Lanes sqrt(Lanes x) { return Lanes{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])}; }
EPAFI_LANES Lanes select(LaneMask mask, Lanes yes, Lanes no) { return mask ? yes : no; }
EPAFI_LANES Lanes max(Lanes a, Lanes b) { return a < b ? b : a; }
/// Where the mask is set, else 0: the bits of an unset lane are cleared whatever they were.
EPAFI_LANES Lanes keep(LaneMask mask, Lanes x) { return reinterpret_cast<Lanes>(reinterpret_cast<LaneMask>(x) & mask); }
EPAFI_LANES bool any(LaneMask mask) { return (mask[0] | mask[1] | mask[2] | mask[3]) != 0; }

/// The same for one number, so that a formula serves both.
EPAFI_LANES double sqrt(double x) { return std::sqrt(x); }
EPAFI_LANES double max(double a, double b) { return a < b ? b : a; }

/// Rows become columns.
EPAFI_LANES void transpose(Lanes& a, Lanes& b, Lanes& c, Lanes& d) {
  const Lanes p = __builtin_shufflevector(a, b, 0, 4, 2, 6), q = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Lanes r = __builtin_shufflevector(c, d, 0, 4, 2, 6), s = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(p, r, 0, 1, 4, 5), c = __builtin_shufflevector(p, r, 2, 3, 6, 7);
  b = __builtin_shufflevector(q, s, 0, 1, 4, 5), d = __builtin_shufflevector(q, s, 2, 3, 6, 7);
}

/// Vectors of four contacts.
struct Lanes3 {
  Lanes x, y, z;
  EPAFI_LANES Lanes dot(const Lanes3& o) const { return x * o.x + y * o.y + z * o.z; }
  EPAFI_LANES Lanes3 cross(const Lanes3& o) const { return {y * o.z - z * o.y, z * o.x - x * o.z, x * o.y - y * o.x}; }
};
EPAFI_LANES Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
EPAFI_LANES Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
EPAFI_LANES Lanes3 operator*(const Lanes& s, const Lanes3& a) { return {s * a.x, s * a.y, s * a.z}; }
EPAFI_LANES Lanes3 operator*(double s, const Lanes3& a) { return {s * a.x, s * a.y, s * a.z}; }
EPAFI_LANES Lanes3 operator-(const Lanes3& a) { return {-a.x, -a.y, -a.z}; }

}  // namespace epafi
