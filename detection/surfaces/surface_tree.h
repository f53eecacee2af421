/// @file surface_tree.h  Tree of boxes over the triangles of a surface whose nodes move: built once, refitted after
/// every motion. The order of the tree stays that of the first positions; results do not depend on it.
#pragma once
#include <limits>
#include <span>
#include <vector>

#include "detection/aabb.h"
#include "detection/narrow/mesh/point_triangle.h"
#include "detection/shapes/triangle_surface.h"

namespace epafi {

/// The nearest point of a surface. Of equally near triangles the one of lowest index.
struct NearestOnSurface {
  static constexpr std::uint32_t none = 0xffffffffu;
  std::uint32_t triangle = none;
  NearestOnTriangle at;
};

class SurfaceTree {
 public:
  SurfaceTree() = default;
  SurfaceTree(std::span<const Vec3> positions, std::span<const Triangle> triangles);
  /// The same triangles with their nodes elsewhere.
  void refit(std::span<const Vec3> positions);
  /// Within `limit` [m] of x; triangle = none where there is nothing.
  NearestOnSurface nearest(std::span<const Vec3> positions, const Vec3& x,
                           double limit = std::numeric_limits<double>::infinity()) const;
  std::span<const Triangle> triangles() const { return triangles_; }

 private:
  struct Node {
    Aabb box;
    std::uint32_t skip;  ///< node behind this one's part of the tree; nodes are in depth-first order
    std::uint32_t begin,
        count;  ///< triangles of a leaf; count 0: inner node, its children are the next node and that one's skip
  };
  void build(std::span<const Vec3> centres, std::uint32_t begin, std::uint32_t end);

  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace epafi
