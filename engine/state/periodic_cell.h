/// @file periodic_cell.h  A cell that repeats along some axes: images of bodies, and its uniform deformation.
/// A contact may be with an image of B. Its number along each axis is counted from A's own cell along the unwrapped
/// paths, so it does not change when a body is put back into the cell; modulo 4 it stands in the top byte of the
/// contact's feature. A body must not reach further than one cell from where it is: images -1, 0, 1 are enough.
///
/// A deforming cell carries everything along with the flow strain_rate * x; World::velocity is what a body moves beside
/// it, and contacts see the flow in addition (as Agnolin and Roux 2007 do).
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/state/plain.h"
#include "engine/state/types.h"

namespace epafi {

/// Cells passed along x, y, z.
using Wraps = Eigen::Vector3i;

/// Images along three axes, each modulo 4, in six bits.
constexpr std::uint32_t image_code(int x, int y, int z) {
  return (static_cast<std::uint32_t>(x) & 3u) | (static_cast<std::uint32_t>(y) & 3u) << 2 |
         (static_cast<std::uint32_t>(z) & 3u) << 4;
}
inline std::uint32_t image_code(const Wraps& w) { return image_code(w.x(), w.y(), w.z()); }
/// -1, 0 or 1 of two bits.
constexpr int image_step(std::uint32_t bits) { return (bits & 3u) == 3u ? -1 : static_cast<int>(bits & 3u); }

/// The same pair seen from B: the code of Pair::image, its key in the next byte; both turn their sign.
constexpr std::uint32_t opposite_image(std::uint32_t image) {
  const auto turned = [](std::uint32_t code) {
    const auto bits = [code](int k) { return -static_cast<int>(code >> (2 * k) & 3u); };
    return image_code(bits(0), bits(1), bits(2));
  };
  return turned(image) | turned(image >> 8) << 8;
}

struct PeriodicCell {
  Vec3 low = Vec3::Zero(), size = Vec3::Ones();  ///< [m]; used along periodic axes only
  std::array<bool, 3> repeats{};
  std::array<bool, 5> unused{};     ///< up to the next number: what a checkpoint writes is all defined
  Vec3 strain_rate = Vec3::Zero();  ///< of the cell's edges now, extension positive [1/s]; 0 along other axes
  Vec3 virial = Vec3::Zero();       ///< sum of force on A times branch A to B at the last evaluation, by axis [N m]

  Vec3 shift(std::uint32_t code) const {
    Vec3 s;
    for (int k = 0; k < 3; ++k) s[k] = image_step(code >> (2 * k)) * size[k];
    return s;
  }
  /// Cells from the cell itself to the one that x is in, along an axis.
  double cells_to(const Vec3& x, int axis) const {
    return repeats[static_cast<std::size_t>(axis)] ? std::floor((x[axis] - low[axis]) / size[axis]) : 0.0;
  }
  /// The place inside the cell, low <= x < low + size, that x is an image of.
  Vec3 inside(Vec3 x) const {
    for (int k = 0; k < 3; ++k) {
      if (!repeats[static_cast<std::size_t>(k)]) continue;
      x[k] -= cells_to(x, k) * size[k];
      if (!(x[k] < low[k] + size[k])) x[k] = low[k];  // rounded up to the far face
    }
    return x;
  }
  double volume() const { return size.prod(); }
  /// Normal stress of the contacts along the axes, compression positive [Pa]; the cell repeats along all three.
  Vec3 stress() const { return -virial / volume(); }
};
template <>
inline constexpr bool is_plain<PeriodicCell> = true;  // numbers and Eigen's vectors only

}  // namespace epafi
