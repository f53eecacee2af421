#include "detection/shapes/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace epafi {
namespace {

constexpr std::uint32_t mesh_leaf = 4;
constexpr double flat_angle = 1e-9;  // [rad] far below what a contact normal can feel, far above rounding

Aabb turned_box(const Aabb& box, const Mat3& turn, const Vec3& shift) {
  const Vec3 centre = turn * box.centre() + shift;
  const Vec3 half = turn.cwiseAbs() * (0.5 * box.extent());
  return {centre - half, centre + half};
}

}  // namespace

Aabb box_in_body_axes(const Aabb& world, const Pose& pose) {
  const Mat3 turn = pose.orientation.toRotationMatrix().transpose();
  return turned_box(world, turn, -(turn * pose.position));
}

TriangleMesh TriangleMesh::from_surface(TriangleSurface surface) {
  TriangleMesh mesh;
  mesh.vertices = std::move(surface.vertices);
  mesh.triangles = std::move(surface.triangles);
  const auto n = static_cast<std::uint32_t>(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vec3 normal = (b - a).cross(c - a).normalized();
    mesh.normals.push_back(normal);
    mesh.inward.push_back(
        {normal.cross(b - a).normalized(), normal.cross(c - b).normalized(), normal.cross(a - c).normalized()});
    Aabb box;
    for (const auto v : t) box.include(mesh.vertices[v]);
    mesh.boxes_.push_back(box);
    for (const auto v : t) mesh.radius_ = std::max(mesh.radius_, mesh.vertices[v].norm());
  }
  mesh.find_neighbours();
  mesh.find_flat_groups();
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0u);
  if (n > 0) mesh.build(order, 0, n);
  mesh.leaves_ = std::move(order);
  return mesh;
}

void TriangleMesh::find_neighbours() {
  neighbours.assign(triangles.size(), {none, none, none});
  edge_kinds.assign(triangles.size(), {EdgeKind::open, EdgeKind::open, EdgeKind::open});
  const auto uses = sorted_edge_uses(triangles);
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].edge() == uses[begin].edge()) ++end;
    if (end - begin != 2 || uses[begin].forward == uses[begin + 1].forward) continue;
    const EdgeUse &p = uses[begin], &q = uses[begin + 1];
    neighbours[p.triangle][p.side] = q.triangle;
    neighbours[q.triangle][q.side] = p.triangle;
    // the angle between the normals, signed by the direction of the edge as the first triangle runs along it
    const Vec3 edge =
        (vertices[triangles[p.triangle][(p.side + 1) % 3]] - vertices[triangles[p.triangle][p.side]]).normalized();
    const Vec3 &m = normals[p.triangle], &n = normals[q.triangle];
    const double sine = edge.dot(m.cross(n));
    const bool folded_back = m.dot(n) < 0.0 && std::abs(sine) <= flat_angle;  // a sharp blade: convex from either side
    const EdgeKind kind = folded_back          ? EdgeKind::convex
                          : sine > flat_angle  ? EdgeKind::convex
                          : sine < -flat_angle ? EdgeKind::concave
                                               : EdgeKind::flat;
    edge_kinds[p.triangle][p.side] = edge_kinds[q.triangle][q.side] = kind;
  }
}

void TriangleMesh::find_flat_groups() {
  flat_group.assign(triangles.size(), none);
  std::vector<std::uint32_t> open;
  for (std::uint32_t first = 0; first < triangles.size(); ++first) {
    if (flat_group[first] != none) continue;
    open.assign(1, first);
    flat_group[first] = first;
    while (!open.empty()) {
      const std::uint32_t t = open.back();
      open.pop_back();
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t next = neighbours[t][k];
        if (edge_kinds[t][k] != EdgeKind::flat || flat_group[next] != none) continue;
        // against the first triangle too: a fine curved surface must not become one plane step by step
        if (normals[first].cross(normals[next]).norm() > flat_angle) continue;
        flat_group[next] = first;
        open.push_back(next);
      }
    }
  }
}

std::uint32_t TriangleMesh::build(std::vector<std::uint32_t>& order, std::uint32_t begin, std::uint32_t end) {
  const auto self = static_cast<std::uint32_t>(nodes_.size());
  Aabb box, centres;
  for (std::uint32_t k = begin; k < end; ++k) box.include(boxes_[order[k]]), centres.include(boxes_[order[k]].centre());
  nodes_.push_back({box, 0, begin, end - begin <= mesh_leaf ? end - begin : 0});
  if (end - begin > mesh_leaf) {
    Eigen::Index axis = 0;
    centres.extent().maxCoeff(&axis);
    const std::uint32_t middle = begin + (end - begin) / 2;
    std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                       const double x = boxes_[a].centre()[axis], y = boxes_[b].centre()[axis];
                       return x < y || (x == y && a < b);  // no ties: the tree is the same everywhere
                     });
    build(order, begin, middle);
    build(order, middle, end);
  }
  return nodes_[self].skip = static_cast<std::uint32_t>(nodes_.size());
}

void TriangleMesh::query(const Aabb& box, std::vector<std::uint32_t>& out) const {
  const auto first = static_cast<std::ptrdiff_t>(out.size());
  for (std::uint32_t k = 0; k < nodes_.size();) {
    const Node& node = nodes_[k];
    if (!node.box.overlaps(box)) {
      k = node.skip;
      continue;
    }
    for (std::uint32_t i = node.begin; i < node.begin + node.count; ++i)
      if (boxes_[leaves_[i]].overlaps(box)) out.push_back(leaves_[i]);
    ++k;
  }
  std::sort(out.begin() + first, out.end());
}

Aabb TriangleMesh::bounding_box(const Pose& pose) const {
  if (nodes_.empty()) return {pose.position, pose.position};
  return turned_box(nodes_.front().box, pose.orientation.toRotationMatrix(), pose.position);
}

}  // namespace epafi
