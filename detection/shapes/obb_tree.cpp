#include "detection/shapes/obb_tree.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

namespace epafi {
namespace {

/// Sides along the principal directions of the triangles' area, the longest first: of the whole area, not of the
/// vertices, which may stand denser on one side.
OrientedBox box_of(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                   std::span<const std::uint32_t> members) {
  double area = 0.0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  const Vec3& origin = vertices[triangles[members[0]][0]];
  for (const std::uint32_t t : members) {
    const Vec3 a = vertices[triangles[t][0]] - origin, b = vertices[triangles[t][1]] - origin,
               c = vertices[triangles[t][2]] - origin;
    const double weight = (b - a).cross(c - a).norm();
    const Vec3 sum = a + b + c;
    area += weight;
    first += weight / 3.0 * sum;
    second += weight / 12.0 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  const Vec3 mean = first / area;
  const Eigen::SelfAdjointEigenSolver<Mat3> principal(second / area - mean * mean.transpose());
  OrientedBox box;
  box.axes.col(0) = principal.eigenvectors().col(2);
  box.axes.col(1) = principal.eigenvectors().col(1);
  box.axes.col(2) = box.axes.col(0).cross(box.axes.col(1));
  Aabb extent;
  for (const std::uint32_t t : members)
    for (const std::uint32_t v : triangles[t]) extent.include(Vec3(box.axes.transpose() * (vertices[v] - origin)));
  box.centre = origin + box.axes * extent.centre();
  // Rounding of coordinates up to the size must not leave a vertex outside.
  box.half = 0.5 * extent.extent() + Vec3::Constant(1e-14 * (extent.extent().maxCoeff() + origin.norm()));
  return box;
}

}  // namespace

ObbTree::ObbTree(std::span<const Vec3> vertices, std::span<const Triangle> triangles) : order_(triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  if (!order_.empty()) build(vertices, triangles, 0, static_cast<std::uint32_t>(order_.size()));
}

void ObbTree::build(std::span<const Vec3> vertices, std::span<const Triangle> triangles, std::uint32_t begin,
                    std::uint32_t end) {
  const std::size_t self = nodes_.size();
  const auto members = std::span(order_).subspan(begin, end - begin);
  nodes_.push_back({box_of(vertices, triangles, members), 0, begin, end - begin <= leaf ? end - begin : 0});
  if (end - begin > leaf) {
    const Vec3 along = nodes_[self].box.axes.col(0);
    const auto place = [&](std::uint32_t t) {
      return along.dot(vertices[triangles[t][0]] + vertices[triangles[t][1]] + vertices[triangles[t][2]]);
    };
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       const double x = place(a), y = place(b);
                       return x < y || (x == y && a < b);
                     });
    build(vertices, triangles, begin, middle);
    build(vertices, triangles, middle, end);
  }
  nodes_[self].skip = static_cast<std::uint32_t>(nodes_.size());
}

void ObbTree::query(const OrientedBox& box, std::vector<std::uint32_t>& out) const {
  const auto first = static_cast<std::ptrdiff_t>(out.size());
  for (std::uint32_t k = 0; k < nodes_.size();) {
    const Node& node = nodes_[k];
    if (!overlap(node.box, box)) {
      k = node.skip;
      continue;
    }
    out.insert(out.end(), order_.begin() + node.begin, order_.begin() + node.begin + node.count);
    ++k;
  }
  std::sort(out.begin() + first, out.end());
}

}  // namespace epafi
