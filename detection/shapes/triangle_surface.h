/// @file triangle_surface.h  A surface made of triangles, and which triangles meet along which edge.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/state/types.h"

namespace epafi {

/// Vertices by index, counter-clockwise seen from outside. Side k runs from corner k to corner k + 1.
using Triangle = std::array<std::uint32_t, 3>;

struct TriangleSurface {
  std::vector<Vec3> vertices;  ///< [m]
  std::vector<Triangle> triangles;
};

/// One side of one triangle.
struct EdgeUse {
  std::uint32_t low, high;  ///< its two vertices
  std::uint32_t triangle, side;
  bool forward;  ///< runs from low to high
  auto edge() const { return std::pair(low, high); }
  auto operator<=>(const EdgeUse&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 sees the 0 of <=>
};

/// All sides, those of one edge side by side: by edge, then by triangle.
inline std::vector<EdgeUse> sorted_edge_uses(std::span<const Triangle> triangles) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto from = triangles[t][k], to = triangles[t][(k + 1) % 3];
      uses.push_back({std::min(from, to), std::max(from, to), t, k, from < to});
    }
  std::sort(uses.begin(), uses.end());
  return uses;
}

}  // namespace epafi
