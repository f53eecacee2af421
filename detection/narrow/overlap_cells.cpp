#include "detection/narrow/overlap_cells.h"

#include <algorithm>


namespace epafi {
namespace {

struct Scratch {
  ClippedSolid overlap, cell;
  std::vector<Plane> planes, near;
  std::vector<std::uint32_t> face;  ///< of each near plane
};

Scratch& scratch() {
  static thread_local Scratch s;  // keeps its size; results do not depend on it
  return s;
}

/// The overlap in A's axes. The face that separates best cuts first: what is left of B is then small.
bool intersect(const PolyhedronPair& pair, ClippedSolid& overlap) {
  overlap.assign(pair.b, pair.rotation, pair.offset);
  std::uint32_t first = 0;
  double best = -infinity;
  for (std::uint32_t f = 0; f < pair.a.face_normals.size(); ++f) {
    double low = infinity;
    for (const Vec3& x : overlap.points) low = std::min(low, pair.a.face_normals[f].dot(x));
    low -= pair.a.face_offsets[f];
    if (low > best) best = low, first = f;
  }
  if (best >= 0.0 || !overlap.clip({pair.a.face_normals[first], pair.a.face_offsets[first]})) return false;
  for (std::uint32_t f = 0; f < pair.a.face_normals.size(); ++f)
    if (f != first && !overlap.clip({pair.a.face_normals[f], pair.a.face_offsets[f]})) return false;
  return true;
}

/// Planes that can be the nearest somewhere in the overlap. phi is nowhere larger than the least over the planes of
/// their largest depth: a plane that is deeper than that everywhere has no cell.
void keep_near(Scratch& s) {
  double bound = infinity;
  std::vector<Plane>& near = s.near;
  near.clear(), s.face.clear();
  for (const Plane& p : s.planes) {
    double deepest = 0.0;
    for (const Vec3& x : s.overlap.points) deepest = std::max(deepest, -p.above(x));
    bound = std::min(bound, deepest);
  }
  for (std::uint32_t f = 0; f < s.planes.size(); ++f) {
    double least = infinity;
    for (const Vec3& x : s.overlap.points) least = std::min(least, -s.planes[f].above(x));
    if (least < bound) near.push_back(s.planes[f]), s.face.push_back(f);
  }
}

/// f(face, volume, depth at the centroid) for the cells of one body's field.
template <class F>
void each_cell(Scratch& s, const F& f) {
  keep_near(s);
  for (std::size_t i = 0; i < s.near.size(); ++i) {
    ClippedSolid& cell = s.cell;
    cell.assign(s.overlap);
    bool left = true;
    for (std::size_t j = 0; j < s.near.size() && left; ++j)
      if (j != i) left = cell.clip({s.near[j].normal - s.near[i].normal, s.near[j].offset - s.near[i].offset});
    if (!left) continue;
    const Volume v = cell.volume();
    const double depth = v.volume > 0.0 ? -s.near[i].above(v.centroid) : 0.0;
    if (depth > 0.0) f(s.face[i], s.near[i].normal, v, depth);
  }
}

}  // namespace

void collide_volumes(const PolyhedronPair& pair, const RoundedPair& rounded, const PairQuery& q, ContactSink& sink) {
  Scratch& s = scratch();
  if (!intersect(pair, s.overlap)) return;
  const Mat3 to_world = q.a.orientation.toRotationMatrix();
  const double radius = q.curvature ? effective_radius(rounded.radius_a, rounded.radius_b) : 0.0;
  const auto emit = [&](double side, FeatureKind kind) {
    each_cell(s, [&](std::uint32_t face, const Vec3& outward, const Volume& v, double depth) {
      const double overlap = 2.0 * depth;
      const Feature feature = side > 0.0 ? make_feature(kind, face, 0) : make_feature(kind, 0, face);
      sink.add({-overlap, to_world * (side * outward), to_world * v.centroid, radius, feature, 0.5 * v.volume / overlap});
    });
  };
  s.planes.clear();
  for (std::size_t f = 0; f < pair.a.face_normals.size(); ++f) s.planes.push_back({pair.a.face_normals[f], pair.a.face_offsets[f]});
  emit(1.0, FeatureKind::cell_a);
  s.planes.clear();
  for (std::size_t f = 0; f < pair.b.face_normals.size(); ++f) {
    const Vec3 n = pair.rotation * pair.b.face_normals[f];
    s.planes.push_back({n, pair.b.face_offsets[f] + n.dot(pair.offset)});
  }
  emit(-1.0, FeatureKind::cell_b);
}

void collide_volume_with_plane(const PolyhedronView& a, const Vec3& up, double height, const Mat3& rotation,
                               double radius, ContactSink& sink) {
  ClippedSolid& below = scratch().overlap;
  double low = infinity;
  for (const Vec3& x : a.vertices) low = std::min(low, up.dot(x));
  if (!(low + height < 0.0)) return;
  below.assign(a, Mat3::Identity(), Vec3::Zero());
  if (!below.clip({up, -height})) return;
  const Volume v = below.volume();
  const double overlap = v.volume > 0.0 ? -2.0 * (height + up.dot(v.centroid)) : 0.0;
  if (!(overlap > 0.0)) return;
  sink.add({-overlap, -(rotation * up), rotation * v.centroid, radius, make_feature(FeatureKind::cell_b, 0, 0),
            v.volume / overlap});
}

}  // namespace epafi
