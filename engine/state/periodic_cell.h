/// @file periodic_cell.h  A cell that repeats along some axes: images of bodies, and its uniform deformation.
/// A contact may be with an image of B. The image is numbered along each axis from A's own cell along the unwrapped
/// paths, so that wrapping a body does not change the number; modulo 4 it is in the top byte of the contact's feature.
/// Images -1, 0, 1 suffice, because a body extends over at most one cell.
///
/// A deforming cell moves everything with the flow strain_rate * x. World::velocity is relative to it, and contacts add
/// the flow (as in Agnolin and Roux 2007).
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

/// The same pair seen from B: the code of Pair::image and its key in the next byte, both with the opposite sign.
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
  std::array<bool, 5> unused{};     ///< padding, so that all bytes of a checkpoint are defined
  Vec3 strain_rate = Vec3::Zero();  ///< of the cell's edges now, extension positive [1/s]; 0 along other axes
  Vec3 virial = Vec3::Zero();       ///< sum of force on A times branch A to B at the last evaluation, by axis [N m]

  Vec3 shift(std::uint32_t code) const {
    Vec3 s;
    for (int k = 0; k < 3; ++k) s[k] = image_step(code >> (2 * k)) * size[k];
    return s;
  }
  /// Index of the cell that contains x, along an axis.
  double cells_to(const Vec3& x, int axis) const {
    return repeats[static_cast<std::size_t>(axis)] ? std::floor((x[axis] - low[axis]) / size[axis]) : 0.0;
  }
  /// The point inside the cell, low <= x < low + size, of which x is an image.
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
