#include "detection/surfaces/surface_tree.h"

#include <numeric>

namespace epafi {
namespace {

constexpr std::uint32_t surface_leaf = 4;

double square_distance(const Aabb& box, const Vec3& x) {
  return (box.min - x).cwiseMax(x - box.max).cwiseMax(0.0).squaredNorm();
}

}  // namespace

SurfaceTree::SurfaceTree(std::span<const Vec3> positions, std::span<const Triangle> triangles)
    : triangles_(triangles.begin(), triangles.end()), order_(triangles.size()) {
  std::vector<Vec3> centres;
  for (const Triangle& t : triangles_) centres.push_back((positions[t[0]] + positions[t[1]] + positions[t[2]]) / 3.0);
  std::iota(order_.begin(), order_.end(), 0u);
  if (!triangles_.empty()) build(centres, 0, static_cast<std::uint32_t>(order_.size()));
  refit(positions);
}

void SurfaceTree::build(std::span<const Vec3> centres, std::uint32_t begin, std::uint32_t end) {
  const std::size_t self = nodes_.size();
  nodes_.push_back({{}, 0, begin, end - begin <= surface_leaf ? end - begin : 0});
  if (end - begin > surface_leaf) {
    Aabb box;
    for (std::uint32_t k = begin; k < end; ++k) box.include(centres[order_[k]]);
    Eigen::Index axis = 0;
    box.extent().maxCoeff(&axis);
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       return std::pair(centres[a][axis], a) < std::pair(centres[b][axis], b);
                     });
    build(centres, begin, middle);
    build(centres, middle, end);
  }
  nodes_[self].skip = static_cast<std::uint32_t>(nodes_.size());
}

void SurfaceTree::refit(std::span<const Vec3> positions) {
  for (std::size_t k = nodes_.size(); k-- > 0;) {  // children stand behind their parent
    Node& node = nodes_[k];
    node.box = {};
    for (std::uint32_t i = node.begin; i < node.begin + node.count; ++i)
      for (const std::uint32_t v : triangles_[order_[i]]) node.box.include(positions[v]);
    if (node.count > 0) continue;
    for (const std::size_t child : {k + 1, static_cast<std::size_t>(nodes_[k + 1].skip)}) {
      node.box.include(nodes_[child].box.min);
      node.box.include(nodes_[child].box.max);
    }
  }
}

NearestOnSurface SurfaceTree::nearest(std::span<const Vec3> positions, const Vec3& x, double limit) const {
  NearestOnSurface best;
  best.at.distance = limit;
  const auto too_far = [&](const Aabb& box) { return square_distance(box, x) > best.at.distance * best.at.distance; };
  std::uint32_t stack[64];
  int depth = 0;
  if (!nodes_.empty()) stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t k = stack[--depth];
    const Node& node = nodes_[k];
    if (too_far(node.box)) continue;
    if (node.count == 0) {  // the nearer child first
      std::uint32_t near = k + 1, far = nodes_[k + 1].skip;
      if (square_distance(nodes_[far].box, x) < square_distance(nodes_[near].box, x)) std::swap(near, far);
      stack[depth++] = far;
      stack[depth++] = near;
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.begin + node.count; ++i) {
      const std::uint32_t t = order_[i];
      const auto& v = triangles_[t];
      const NearestOnTriangle at = nearest_on_triangle(x, {positions[v[0]], positions[v[1]], positions[v[2]]});
      if (at.distance < best.at.distance || (at.distance == best.at.distance && t < best.triangle)) best = {t, at};
    }
  }
  return best;
}

}  // namespace epafi
