#include "detection/shapes/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace epafi {
namespace {

constexpr std::uint32_t mesh_leaf = 4;
constexpr double flat_angle = 1e-9;  // [rad] far above rounding
constexpr double half_turn = 3.14159265358979323846;
/// Cosine of the bend of a smooth edge, 18 degrees. Beyond a sharper concave edge a ball that overlaps by less than a
/// twentieth of its radius meets the next face in its inside, where a contact of its own begins without overlap.
constexpr double cosine_of_smooth = 0.95;
constexpr double cosine_of_a_degree = 0.99984769515639123916;
constexpr double straight = 1e-6;  // [rad] of an outline

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

TriangleMesh TriangleMesh::from_surface(TriangleSurface surface, double precision) {
  JoinedSurface joined = join_surface(std::move(surface), precision);
  TriangleMesh mesh;
  mesh.vertices = std::move(joined.surface.vertices);
  mesh.triangles = std::move(joined.surface.triangles);
  mesh.normals = std::move(joined.normals);
  mesh.face = std::move(joined.face);
  mesh.joined = joined.report;
  const auto n = static_cast<std::uint32_t>(mesh.triangles.size());
  for (std::uint32_t t = 0; t < n; ++t) {
    const auto corner = mesh.corners(t);
    const Vec3& normal = mesh.normals[t];
    std::array<Vec3, 3> inward;
    Aabb box;
    for (std::size_t k = 0; k < 3; ++k) {
      inward[k] = normal.cross(corner[(k + 1) % 3] - corner[k]).normalized();
      box.include(corner[k]);
      mesh.radius_ = std::max(mesh.radius_, corner[k].norm());
    }
    mesh.inward.push_back(inward);
    mesh.boxes_.push_back(box);
  }
  mesh.find_neighbours();
  mesh.around.assign(n, {none, 0, 0, 0});
  mesh.find_notches();
  mesh.find_connected();
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
    edge_kinds[p.triangle][p.side] = edge_kinds[q.triangle][q.side] = kind_of(p, q);
  }
}

void TriangleMesh::find_notches() {
  struct Wedge {
    std::uint32_t face, vertex, triangle, side;
    double angle;
    bool at_rim;
  };
  std::vector<Wedge> wedges;
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto corner = corners(t);
      const Vec3 u = corner[(k + 1) % 3] - corner[k], v = corner[(k + 2) % 3] - corner[k];
      wedges.push_back({face[t], triangles[t][k], t, k, std::atan2(u.cross(v).norm(), u.dot(v)),
                        edge_kinds[t][k] != EdgeKind::flat || edge_kinds[t][(k + 2) % 3] != EdgeKind::flat});
    }
  const auto key = [](const Wedge& w) { return std::tuple(w.face, w.vertex, w.triangle); };
  std::sort(wedges.begin(), wedges.end(), [&](const Wedge& a, const Wedge& b) { return key(a) < key(b); });
  for (std::size_t begin = 0, end = 0; begin < wedges.size(); begin = end) {
    double angle = 0.0;
    bool at_rim = false;
    const auto is_same = [&](const Wedge& w) {
      return w.face == wedges[begin].face && w.vertex == wedges[begin].vertex;
    };
    for (; end < wedges.size() && is_same(wedges[end]); ++end) {
      angle += wedges[end].angle;
      at_rim = at_rim || wedges[end].at_rim;
    }
    if (!at_rim || !(angle > half_turn + straight)) continue;
    for (std::size_t k = begin; k < end; ++k)
      around[wedges[k].triangle].notches |= static_cast<std::uint8_t>(1u << wedges[k].side);
  }
}

template <class Joins, class F>
void TriangleMesh::each_connected(const Joins& joins, const F& f) const {
  std::vector<std::uint32_t> part;
  std::vector<bool> seen(triangles.size());
  for (std::uint32_t first = 0; first < triangles.size(); ++first) {
    if (seen[first]) continue;
    part.assign(1, first);
    seen[first] = true;
    for (std::size_t i = 0; i < part.size(); ++i)
      for (const std::uint32_t next : neighbours[part[i]]) {
        if (next == none || seen[next] || !joins(part[i], next)) continue;
        seen[next] = true;
        part.push_back(next);
      }
    f(std::as_const(part));
  }
}

void TriangleMesh::find_connected() {
  const auto has_rim = [this](std::uint32_t t) { return std::ranges::count(neighbours[t], none) > 0; };
  const auto mark_closed = [&](const std::vector<std::uint32_t>& part) {
    const std::uint32_t closed = std::ranges::any_of(part, has_rim) ? none : part.front();
    for (const std::uint32_t t : part) around[t].closed = closed;
  };
  each_connected([](std::uint32_t, std::uint32_t) { return true; }, mark_closed);
  const auto mark = [&](std::uint32_t Around::*mark_of, double least_cosine) {
    const auto joins = [&](std::uint32_t t, std::uint32_t next) {
      return face[t] == face[next] || normals[t].dot(normals[next]) > least_cosine;
    };
    each_connected(joins, [&](const std::vector<std::uint32_t>& part) {
      for (const std::uint32_t t : part) around[t].*mark_of = part.front();
    });
  };
  mark(&Around::smooth, cosine_of_smooth);
  mark(&Around::gentle, cosine_of_a_degree);
}

EdgeKind TriangleMesh::kind_of(const EdgeUse& p, const EdgeUse& q) const {
  if (face[p.triangle] == face[q.triangle]) return EdgeKind::flat;
  // the angle between the normals, signed by the direction of the edge as the first triangle runs along it
  const auto corner = corners(p.triangle);
  const Vec3 edge = (corner[(p.side + 1) % 3] - corner[p.side]).normalized();
  const Vec3 &m = normals[p.triangle], &n = normals[q.triangle];
  const double sine = edge.dot(m.cross(n));
  const bool folded_back = m.dot(n) < 0.0 && std::abs(sine) <= flat_angle;  // a sharp blade: convex from either side
  return folded_back || sine > 0.0 ? EdgeKind::convex : EdgeKind::concave;
}

std::uint32_t TriangleMesh::build(std::vector<std::uint32_t>& order, std::uint32_t begin, std::uint32_t end) {
  const auto self = static_cast<std::uint32_t>(nodes_.size());
  Aabb box, centres;
  for (std::uint32_t k = begin; k < end; ++k) {
    box.include(boxes_[order[k]]);
    centres.include(boxes_[order[k]].centre());
  }
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
