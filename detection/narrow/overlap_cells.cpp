#include "detection/narrow/overlap_cells.h"

#include <algorithm>

#include "detection/narrow/overlap_solid.h"

namespace epafi {
namespace {

/// A part of one face of the overlap.
using Polygon = std::vector<Vec3>;

struct Scratch {
  OverlapSolid overlap;
  ClippedSolid cell;
  Polygon part, next_part;
  Volume whole;  ///< of the overlap
  std::vector<Plane> near;
  std::vector<std::uint32_t> face;  ///< of each near plane
  std::vector<Volume> volume;       ///< of the cell of each near plane
};

Scratch& scratch() {
  static thread_local Scratch s;  // keeps its size; results do not depend on it
  return s;
}

/// Planes that can be the nearest somewhere in the overlap. phi is nowhere larger than the least over the planes of
/// their largest depth: a plane that is deeper than that everywhere has no cell.
void keep_near(const Layer& layer, Scratch& s) {
  double bound = infinity;
  s.near.clear(), s.face.clear();
  for (std::size_t k = 0; k < layer.faces.size(); ++k) bound = std::min(bound, std::max(0.0, -layer.low[k]));
  for (std::size_t k = 0; k < layer.faces.size(); ++k)
    if (-layer.high[k] < bound) s.near.push_back(layer.planes[k]), s.face.push_back(layer.faces[k]);
}

/// Above it plane j is nearer than plane i.
Plane bisector(const Scratch& s, std::size_t i, std::size_t j) {
  return {s.near[j].normal - s.near[i].normal, s.near[j].offset - s.near[i].offset};
}

/// A point of the overlap that lies on all near planes, to `rounding` [m]; the number of points where there is none.
std::size_t common_point(const Scratch& s, double rounding) {
  const ClippedSolid& solid = s.overlap.solid;
  std::size_t i = 0;
  while (i < solid.points() &&
         !std::ranges::all_of(s.near, [&](const Plane& p) { return std::abs(p.above(solid.point(i))) <= rounding; }))
    ++i;
  return i;
}

/// What is left of a convex polygon below the plane.
void clip(const Plane& plane, Polygon& polygon, Polygon& scratch) {
  scratch.clear();
  Vec3 last = polygon.back();
  double last_above = plane.above(last);
  for (const Vec3& x : polygon) {
    const double above = plane.above(x);
    if ((above > 0.0) != (last_above > 0.0)) scratch.push_back(last + last_above / (last_above - above) * (x - last));
    if (!(above > 0.0)) scratch.push_back(x);
    last = x, last_above = above;
  }
  polygon.swap(scratch);
}

/// The part of one face of the overlap where near plane i is the nearest.
void find_part(std::span<const std::uint32_t> corners, std::size_t i, Scratch& s) {
  s.part.clear();
  for (const std::uint32_t k : corners) s.part.push_back(s.overlap.solid.point(k));
  for (std::size_t j = 0; j < s.near.size() && s.part.size() > 2; ++j)
    if (j != i) clip(bisector(s, i, j), s.part, s.next_part);
}

/// Where the near planes meet in a point of the overlap, so do the planes between their cells: a cell is the cones from
/// there over its parts of the faces that do not have it. The last cell is what the others leave.
void cells_as_cones(std::size_t apex, Scratch& s) {
  const ClippedSolid& solid = s.overlap.solid;
  const auto cell = [&](std::size_t i) {
    Volume out{solid.point(apex)};
    for (std::size_t f = 0; f < solid.faces(); ++f) {
      if (std::ranges::find(solid.face(f), apex) != solid.face(f).end()) continue;
      find_part(solid.face(f), i, s);
      out.add_cone(s.part, [](const Vec3& x) { return x; });
    }
    return out;
  };
  Volume rest = s.whole.about(solid.point(apex));
  const std::size_t last = s.near.size() - 1;
  for (std::size_t i = 0; i < last; ++i) {
    s.volume[i] = cell(i);
    rest.volume -= s.volume[i].volume, rest.moment -= s.volume[i].moment;
  }
  constexpr double least_rest = 1e-3;  // of the whole; of less the difference would lose more than three digits
  s.volume[last] = rest.volume > least_rest * s.whole.volume ? rest : cell(last);
}

/// Any other cell is cut out of the overlap.
void cells_by_cutting(Scratch& s) {
  for (std::size_t i = 0; i < s.near.size(); ++i) {
    s.cell.assign(s.overlap.solid);
    bool left = true;
    for (std::size_t j = 0; j < s.near.size() && left; ++j)
      if (j != i) left = s.cell.clip(bisector(s, i, j));
    if (left) s.volume[i] = s.cell.volume();
  }
}

/// f(face, normal, volume, centroid, depth there) for the cells of one body's field. rounding: of heights [m].
template <class F>
void each_cell(const Layer& layer, double rounding, Scratch& s, const F& f) {
  keep_near(layer, s);
  s.volume.assign(s.near.size(), {});
  if (s.near.size() == 1) {
    s.volume[0] = s.whole;
  } else {
    const std::size_t apex = common_point(s, rounding);
    if (apex < s.overlap.solid.points())
      cells_as_cones(apex, s);
    else
      cells_by_cutting(s);
  }
  for (std::size_t i = 0; i < s.near.size(); ++i) {
    if (!(s.volume[i].volume > 0.0)) continue;
    const Vec3 centroid = s.volume[i].centroid();
    const double depth = -s.near[i].above(centroid);
    if (depth > 0.0) f(s.face[i], s.near[i].normal, s.volume[i].volume, centroid, depth);
  }
}

}  // namespace

void collide_volumes(const PolyhedronPair& pair, const SeparatingAxis& axis, double radius, const Mat3& to_world,
                     ContactSink& sink) {
  Scratch& s = scratch();
  if (!intersect(pair, axis, s.overlap)) return;
  s.whole = s.overlap.solid.volume();
  const double rounding = 4e-15 * (pair.a.radius + pair.b.radius);
  const auto emit = [&](const Layer& layer, double side, FeatureKind kind) {
    each_cell(layer, rounding, s,
              [&](std::uint32_t face, const Vec3& outward, double volume, const Vec3& centroid, double depth) {
                const double overlap = 2.0 * depth;
                const Feature feature = side > 0.0 ? make_feature(kind, face, 0) : make_feature(kind, 0, face);
                sink.add({-overlap, to_world * (side * outward), to_world * centroid, radius, feature,
                          0.5 * volume / overlap});
              });
  };
  emit(s.overlap.a, 1.0, FeatureKind::cell_a);
  emit(s.overlap.b, -1.0, FeatureKind::cell_b);
}

void collide_volume_with_plane(const PolyhedronView& a, const Vec3& up, double height, const Mat3& rotation,
                               double radius, ContactSink& sink) {
  ClippedSolid& below = scratch().cell;
  double low = infinity;
  for (const Vec3& x : a.vertices) low = std::min(low, up.dot(x));
  if (!(low + height < 0.0)) return;
  below.assign(a, Mat3::Identity(), Vec3::Zero());
  if (!below.clip({up, -height})) return;
  const Volume v = below.volume();
  if (!(v.volume > 0.0)) return;
  const Vec3 centroid = v.centroid();
  const double overlap = -2.0 * (height + up.dot(centroid));
  if (!(overlap > 0.0)) return;
  sink.add({-overlap, -(rotation * up), rotation * centroid, radius, make_feature(FeatureKind::cell_b, 0, 0),
            v.volume / overlap});
}

}  // namespace epafi
