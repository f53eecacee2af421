#include "detection/narrow/pairs/flat_patch.h"

#include <cmath>

#include "detection/narrow/pairs/side_clip.h"

namespace epafi {
namespace {

/// Unit normal of a flat end, on the side of `up`.
Vec3 end_normal(const FlatSide& end, const Vec3& up) {
  const Vec3 m = (end.corner[1] - end.corner[0]).cross(end.corner[2] - end.corner[0]).normalized();
  return m.dot(up) < 0.0 ? Vec3(-m) : m;
}

/// The corners of an end counter-clockwise about `normal`.
FlatSide ordered(FlatSide end, const Vec3& normal) {
  const auto& x = end.corner;
  if ((x[1] - x[0]).cross(x[2] - x[1]).dot(normal) < 0.0)
    std::reverse(end.corner.begin(), end.corner.begin() + end.count);
  return end;
}

/// Ends of the part of segment B that lies along segment A; none where they cross.
void clip_to_segment(const FlatSide& a, double tolerance, std::vector<SidePoint>& side) {
  const Vec3 along = (a.corner[1] - a.corner[0]).normalized(), other = (side[1].x - side[0].x).normalized();
  if (along.cross(other).squaredNorm() >= facing_sine * facing_sine) return side.clear();
  const double length = (a.corner[1] - a.corner[0]).norm(), from = (side[0].x - a.corner[0]).dot(along),
               to = (side[1].x - a.corner[0]).dot(along);
  if (std::max(from, to) < -tolerance || std::min(from, to) > length + tolerance) return side.clear();
  const Vec3 start = side[0].x, way = side[1].x - side[0].x;
  for (SidePoint& p : side) {
    const double t = (p.x - a.corner[0]).dot(along), end = std::clamp(t, 0.0, length);
    if (std::abs(end - t) <= tolerance) continue;
    p.x = start + (end - from) / (to - from) * way;
    p.cut = end > 0.0 ? 2 : 1;
  }
}

}  // namespace

Patch flat_patch(const FlatPair& pair, const NearestPoint& nearest, double reach) {
  static thread_local std::vector<SidePoint> side;  // keep their size
  static thread_local std::vector<PatchPoint> points;
  side.clear();
  points.clear();
  const Vec3& n = nearest.normal;
  // the end with more corners is the reference, the other side's points are on it
  const bool table_is_b = pair.b.count > pair.a.count;
  const FlatSide &table = table_is_b ? pair.b : pair.a, &laid = table_is_b ? pair.a : pair.b;
  const Vec3 up = table_is_b ? Vec3(-n) : n;  // away from the table's body
  const double sweep = table_is_b ? pair.sweep_a : pair.sweep_b, tolerance = side_snap * pair.size;
  if (table.count > 0)
    for (int k = 0; k < laid.count; ++k)
      side.push_back({laid.corner[static_cast<std::size_t>(k)], static_cast<std::uint32_t>(k), 0});
  Vec3 m = up;  // normal of the table
  if (table.count == 2 && !side.empty()) {
    clip_to_segment(table, tolerance, side);
    const Vec3 along = (table.corner[1] - table.corner[0]).normalized();
    m = (up - up.dot(along) * along).normalized();  // its line, widened across the common normal
  } else if (!side.empty()) {
    m = end_normal(table, up);
    const FlatSide end = ordered(table, m);
    clip_side([&](std::uint32_t k) -> const Vec3& { return end.corner[k]; }, static_cast<std::uint32_t>(end.count), m,
              tolerance, side);
  }
  for (const SidePoint& s : side) {
    // never below the nearest: along a normal other than the end's, a point beside it may appear deeper
    const double gap = std::max(nearest.gap, m.dot(s.x - table.corner[0]) / m.dot(up) - pair.sweep_a - pair.sweep_b);
    if (!(gap < reach)) continue;
    const FeatureKind kind = s.cut != 0   ? FeatureKind::edges
                             : table_is_b ? FeatureKind::vertex_a
                                          : FeatureKind::vertex_b;
    points.push_back({s.x - (sweep + 0.5 * gap) * up, gap, make_feature(kind, s.cut, s.corner)});
  }
  Patch out;
  keep_with_nearest(points, nearest, pair.size, false, out);
  return out;
}

}  // namespace epafi
