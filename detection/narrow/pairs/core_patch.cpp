#include "detection/narrow/pairs/core_patch.h"

#include <cmath>

#include "detection/narrow/pairs/flat_patch.h"
#include "detection/narrow/pairs/side_clip.h"

namespace epafi {
namespace {

constexpr std::size_t round_end = 8;  // corners of a cylinder's end

/// The points of a round end follow the lowest one, against `m`, so that their springs have a potential. Upright to
/// within rounding they are fixed in the body.
void turn_round_end(const Vec3& m, std::vector<SidePoint>& side) {
  constexpr double upright = 1e-6;
  const Vec3 centre = 0.5 * (side[0].x + side[4].x), arm = side[0].x - centre, across = side[2].x - centre;
  const double radius = arm.norm();
  const Vec3 axis = arm.cross(across).normalized(), down = m.dot(axis) * axis - m;
  const double tilt = down.norm();
  if (!(tilt > upright)) return;
  const Vec3 first = radius / tilt * down, second = axis.cross(first);
  for (std::size_t k = 0; k < side.size(); ++k) {
    const double c = arm.dot(side[k].x - centre) / (radius * radius),
                 s = across.dot(side[k].x - centre) / (radius * radius);
    side[k].x = centre + c * first + s * second;
  }
}

/// A round end that is completely over the face has four points, since a selection from eight would change with the
/// touching ones.
void keep_quarters(std::vector<SidePoint>& side) {
  const auto is_cut = [](const SidePoint& s) { return s.cut != 0; };
  if (side.size() != round_end || std::ranges::any_of(side, is_cut)) return;
  std::erase_if(side, [](const SidePoint& s) { return s.corner % 2 == 1; });
}

/// The edge at the polyhedron's outermost corner along n that is the most nearly square to n; none where all slope
/// away.
FlatSide edge_along(const PolyhedronView& p, const Vec3& n) {
  FlatSide edge;
  const std::uint32_t v = ConvexHull::support_vertex(p, n);
  double least = facing_sine;
  for (std::uint32_t k = p.neighbour_begin[v]; k < p.neighbour_begin[v + 1]; ++k) {
    const std::uint32_t w = p.neighbours[k];
    const Vec3 way = p.vertices[w] - p.vertices[v];
    const double sine = std::abs(way.dot(n)) / way.norm();
    if (!(sine < least)) continue;
    least = sine;
    edge.corner[0] = p.vertices[std::min(v, w)];
    edge.corner[1] = p.vertices[std::max(v, w)];
    edge.count = 2;
  }
  return edge;
}

/// A corner of the core, or one of the polyhedron's face that the cut side has there, or where edges of both cross.
Feature name_point(const PolyhedronView& p, std::uint32_t face, const SidePoint& s, double tolerance) {
  if (s.cut == 0) return make_feature(FeatureKind::vertex_b, 0, s.corner);
  for (std::uint32_t k = p.face_begin[face]; k < p.face_begin[face + 1]; ++k) {
    const std::uint32_t v = p.face_vertices[k];
    if (p.face_normals[face].cross(s.x - p.vertices[v]).squaredNorm() <= 4.0 * tolerance * tolerance)
      return make_feature(FeatureKind::vertex_a, v, 0);
  }
  return make_feature(FeatureKind::edges, s.cut, s.corner);
}

/// A straight side along an edge of the polyhedron, or an end across one.
Patch on_edge(const CoreAndPolyhedron& pair, const NearestPoint& nearest, double reach, double sweep_polyhedron,
              double sweep_core) {
  FlatPair sides{edge_along(pair.polyhedron, nearest.normal), {}, pair.size, sweep_polyhedron, sweep_core};
  if (sides.a.count > 0) sides.b = leaning_side(pair.shape, pair.facing, -(pair.rotation.transpose() * nearest.normal));
  for (int k = 0; k < sides.b.count; ++k) {
    Vec3& x = sides.b.corner[static_cast<std::size_t>(k)];
    x = pair.rotation * x + pair.offset;
  }
  return flat_patch(sides, nearest, reach);
}

}  // namespace

FlatSide leaning_side(const void* shape, FlatSide (*facing)(const void* shape, const Vec3& d), const Vec3& d) {
  FlatSide side = facing(shape, d);
  if (side.count == 0) side = facing(shape, d.cwiseProduct(Vec3(0.1, 0.1, 1.0)));
  if (side.count == 0) side = facing(shape, d.cwiseProduct(Vec3(1.0, 1.0, 0.1)));
  return side;
}

std::uint32_t face_along(const PolyhedronView& p, const Vec3& n) {
  const std::uint32_t v = ConvexHull::support_vertex(p, n);
  std::uint32_t best = p.fans[p.fan_begin[v]];
  for (std::uint32_t k = p.fan_begin[v] + 1; k < p.fan_begin[v + 1]; ++k)
    if (p.face_normals[p.fans[k]].dot(n) > p.face_normals[best].dot(n)) best = p.fans[k];
  return best;
}

Patch core_patch(const CoreAndPolyhedron& pair, const NearestPoint& nearest, double reach, double sweep_polyhedron,
                 double sweep_core) {
  static thread_local std::vector<SidePoint> side;  // keep their size
  static thread_local std::vector<PatchPoint> points;
  side.clear();
  points.clear();
  const PolyhedronView& p = pair.polyhedron;
  const Vec3& n = nearest.normal;
  const std::uint32_t face = face_along(p, n);
  const Vec3& m = p.face_normals[face];
  if (!(m.cross(n).squaredNorm() < facing_sine * facing_sine))
    return on_edge(pair, nearest, reach, sweep_polyhedron, sweep_core);
  const FlatSide flat = leaning_side(pair.shape, pair.facing, -(pair.rotation.transpose() * n));
  for (int k = 0; k < flat.count; ++k)
    side.push_back(
        {pair.rotation * flat.corner[static_cast<std::size_t>(k)] + pair.offset, static_cast<std::uint32_t>(k), 0});
  if (side.size() == round_end) turn_round_end(m, side);
  const std::uint32_t begin = p.face_begin[face];
  clip_side([&](std::uint32_t k) -> const Vec3& { return p.vertices[p.face_vertices[begin + k]]; },
            p.face_begin[face + 1] - begin, m, side_snap * pair.size, side);
  keep_quarters(side);
  for (const SidePoint& s : side) {
    // never below the nearest: along a normal other than the face's, a point beside the face may appear deeper
    const double gap =
        std::max(nearest.gap, (m.dot(s.x) - p.face_offsets[face]) / m.dot(n) - sweep_polyhedron - sweep_core);
    if (!(gap < reach)) continue;
    points.push_back({s.x - (sweep_core + 0.5 * gap) * n, gap, name_point(p, face, s, side_snap * pair.size)});
  }
  Patch out;
  keep_with_nearest(points, nearest, pair.size, !(reach > 0.0), out);
  return out;
}

}  // namespace epafi
