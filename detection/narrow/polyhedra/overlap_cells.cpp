#include "detection/narrow/polyhedra/overlap_cells.h"

#include <algorithm>

#include "detection/narrow/polyhedra/overlap_faces.h"
#include "detection/narrow/polyhedra/overlap_forms.h"
#include "detection/narrow/polyhedra/overlap_solid.h"

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
  std::vector<OverlapCell> cells;   ///< of both fields
  std::vector<std::uint32_t> bounds_a, bounds_b;
  std::vector<Vec3> points;
};

Scratch& scratch() {
  static thread_local Scratch s;  // keeps its size; results do not depend on it
  return s;
}

/// Planes that can be the nearest somewhere in the overlap. phi is nowhere larger than the least over the planes of
/// their largest depth: a plane that is deeper than that everywhere has no cell.
void keep_near(const Layer& layer, Scratch& s) {
  double bound = infinity;
  s.near.clear();
  s.face.clear();
  for (std::size_t k = 0; k < layer.faces.size(); ++k) bound = std::min(bound, std::max(0.0, -layer.low[k]));
  for (std::size_t k = 0; k < layer.faces.size(); ++k)
    if (-layer.high[k] < bound) {
      s.near.push_back(layer.planes[k]);
      s.face.push_back(layer.faces[k]);
    }
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
    last = x;
    last_above = above;
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

/// What cells leave of the overlap for the last one.
class Rest {
 public:
  explicit Rest(const Volume& whole) : whole_(whole), left_(whole) {}
  void take(const Volume& cell) {
    const Volume there = cell.about(left_.origin);
    left_.volume -= there.volume;
    left_.moment -= there.moment;
  }
  bool is_sure() const { return left_.volume > least_rest * whole_.volume; }
  const Volume& left() const { return left_; }

 private:
  Volume whole_, left_;
};

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
  Rest rest(s.whole.about(solid.point(apex)));
  const std::size_t last = s.near.size() - 1;
  for (std::size_t i = 0; i < last; ++i) rest.take(s.volume[i] = cell(i));
  s.volume[last] = rest.is_sure() ? rest.left() : cell(last);
}

/// The near plane that is the nearest at x.
std::size_t nearest_at(const Vec3& x, const Scratch& s) {
  const auto higher = [&](const Plane& p, const Plane& q) { return p.above(x) < q.above(x); };
  return static_cast<std::size_t>(std::ranges::max_element(s.near, higher) - s.near.begin());
}

/// Any other cell is cut out of the overlap, but for the one that has its centroid, mostly by far the largest: most of
/// a smaller one goes with the first cut, the one against it, and it is what the others leave.
void cells_by_cutting(Scratch& s) {
  const std::size_t large = nearest_at(s.whole.centroid(), s);
  const auto cell = [&](std::size_t i) -> Volume {
    s.cell.assign(s.overlap.solid);
    if (i != large && !s.cell.clip(bisector(s, i, large))) return {};
    for (std::size_t j = 0; j < s.near.size(); ++j)
      if (j != i && j != large && !s.cell.clip(bisector(s, i, j))) return {};
    return s.cell.volume();
  };
  Rest rest(s.whole.about(s.overlap.solid.point(0)));
  for (std::size_t i = 0; i < s.near.size(); ++i)
    if (i != large) rest.take(s.volume[i] = cell(i));
  s.volume[large] = rest.is_sure() ? rest.left() : cell(large);
}

/// The cells of one body's field. rounding: of heights [m].
void find_cells(const Layer& layer, bool of_a, double rounding, Scratch& s) {
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
    if (depth > 0.0) s.cells.push_back({of_a, s.face[i], s.volume[i].volume, depth, centroid});
  }
}

/// Faces that bound the overlap: no others come nearer to one that has a form than twice this slack [m].
void find_bounds(const Layer& layer, double slack, std::vector<std::uint32_t>& out) {
  out.clear();
  for (std::size_t k = 0; k < layer.faces.size(); ++k)
    if (layer.high[k] > -slack) out.push_back(layer.faces[k]);
}

/// Any overlap: cut from the bodies, then into cells. An overlap with a closed form uses it even if the axis did not
/// show it, so that the bits do not depend on memory.
OverlapForm cut_cells(const PolyhedronPair& pair, const SeparatingAxis& axis, Scratch& s) {
  s.cells.clear();
  if (!intersect(pair, axis, s.overlap)) return {};
  const double size = pair.a.radius + pair.b.radius;
  find_bounds(s.overlap.a, thinnest_cell * size, s.bounds_a);
  find_bounds(s.overlap.b, thinnest_cell * size, s.bounds_b);
  OverlapForm form = form_of(pair, s.bounds_a, s.bounds_b);
  if (find_cells(pair, form, s.cells)) return form;
  s.points.clear();
  for (std::size_t i = 0; i < s.overlap.solid.points(); ++i) s.points.push_back(s.overlap.solid.point(i));
  form = {OverlapForm::Kind::faces, 0, 0, near_faces(pair, s.points)};
  if (find_cells(pair, form, s.cells)) return form;
  s.cells.clear();
  s.whole = s.overlap.solid.volume();
  find_cells(s.overlap.a, true, 4e-15 * size, s);
  find_cells(s.overlap.b, false, 4e-15 * size, s);
  return {};
}

void add_cells(const PolyhedronPair& pair, const std::vector<OverlapCell>& cells, const CellPlacing& placing,
               ContactSink& sink) {
  for (const OverlapCell& c : cells) {
    const double overlap = 2.0 * c.depth;
    const Vec3 normal = c.of_a ? pair.a.face_normals[c.face] : Vec3(-(pair.rotation * pair.b.face_normals[c.face]));
    const Feature feature =
        c.of_a ? make_feature(FeatureKind::cell_a, c.face, 0) : make_feature(FeatureKind::cell_b, 0, c.face);
    sink.add({-overlap, placing.to_world * normal, placing.to_world * c.centroid, placing.radius, feature,
              0.5 * c.volume / overlap});
  }
}

}  // namespace

OverlapForm collide_volumes(const PolyhedronPair& pair, const SeparatingAxis& axis, const CellPlacing& placing,
                            ContactSink& sink) {
  Scratch& s = scratch();
  OverlapForm form = form_of(axis);
  if (!find_cells(pair, form, s.cells)) form = cut_cells(pair, axis, s);
  add_cells(pair, s.cells, placing, sink);
  return form;
}

bool collide_form(const PolyhedronPair& pair, const OverlapForm& form, const CellPlacing& placing, ContactSink& sink) {
  Scratch& s = scratch();
  if (!find_cells(pair, form, s.cells)) return false;
  add_cells(pair, s.cells, placing, sink);
  return true;
}

void collide_volume_with_plane(const PolyhedronView& a, const Vec3& up, double height, const Mat3& rotation,
                               double radius, ContactSink& sink) {
  const std::uint32_t lowest = ConvexHull::support_vertex(a, -up);
  const double low = height + up.dot(a.vertices[lowest]);
  if (!(low < 0.0)) return;
  Volume v = corner_below(a, lowest, up, low);
  if (!(v.volume > 0.0)) {
    ClippedSolid& below = scratch().cell;
    below.assign(a, Mat3::Identity(), Vec3::Zero());
    if (!below.clip({up, -height})) return;
    v = below.volume();
  }
  if (!(v.volume > 0.0)) return;
  const Vec3 centroid = v.centroid();
  const double overlap = -2.0 * (height + up.dot(centroid));
  if (!(overlap > 0.0)) return;
  sink.add({-overlap, -(rotation * up), rotation * centroid, radius, make_feature(FeatureKind::cell_b, 0, 0),
            v.volume / overlap});
}

}  // namespace epafi
