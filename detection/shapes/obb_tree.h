/// @file obb_tree.h  Tree of oriented boxes over the triangles of a mesh (Gottschalk, Lin and Manocha 1996).
/// Costs more per node than boxes along the axes (15 axes against 3) and 150 against 56 bytes of it; pays where the
/// surface is thin and lies askew, or where long bodies lie askew to it. Figures: `perf_mesh`.
#pragma once
#include <span>
#include <vector>

#include "detection/shapes/oriented_box.h"
#include "detection/shapes/triangle_surface.h"

namespace epafi {

class ObbTree {
 public:
  ObbTree() = default;
  ObbTree(std::span<const Vec3> vertices, std::span<const Triangle> triangles);
  bool empty() const { return nodes_.empty(); }
  /// Appends triangles in ascending order, among them every one that meets the box.
  void query(const OrientedBox& box, std::vector<std::uint32_t>& out) const;

 private:
  static constexpr std::uint32_t leaf = 2;
  struct Node {
    OrientedBox box;
    std::uint32_t skip;          ///< node behind this one's part of the tree; nodes are in depth-first order
    std::uint32_t begin, count;  ///< triangles of a leaf in order_; count 0: inner node
  };
  void build(std::span<const Vec3> vertices, std::span<const Triangle> triangles, std::uint32_t begin,
             std::uint32_t end);

  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

}  // namespace epafi
