#include "detection/narrow/polyhedra/manifold.h"

#include <algorithm>
#include <cmath>

#include "engine/state/frame.h"

namespace epafi {
namespace {

constexpr double snap = 1e-6;  // of the size: closer vertices and edges are one, so that equal boxes do not flicker
constexpr double equal_gap = 1e-7;  // of the size: points as deep as each other; above what a body at rest trembles by

constexpr std::uint32_t none_near = ~std::uint32_t{0};

/// Corner of a polygon in the plane across the normal. source: vertex of its polygon from which the next edge starts.
struct Corner {
  double x, y;
  std::uint32_t source;  ///< of the edge that leaves this corner: index into A's (own = false) or B's polygon
  bool edge_of_a;
  std::uint32_t edge_a, edge_b;  ///< the edges that cross here, for a corner made by clipping
};

/// Corners of a polygon, in an array that keeps its size: no allocation once the largest face was seen.
class Corners {
 public:
  void clear() { count_ = 0; }
  void make_room(std::size_t n) {
    if (corners_.size() < n) corners_.resize(n);
  }
  /// There must be room.
  void add(const Corner& c) { corners_[count_++] = c; }
  std::size_t size() const { return count_; }
  const Corner& operator[](std::size_t k) const { return corners_[k]; }
  const Corner* begin() const { return corners_.data(); }
  const Corner* end() const { return corners_.data() + count_; }

 private:
  std::vector<Corner> corners_;
  std::size_t count_ = 0;
};

/// Results do not depend on what they held.
struct Buffers {
  Corners a, b, first, second;  ///< first, second: B's face cut by ever more edges, in turns
  std::vector<double> side;     ///< of the edge at hand, by corner
  std::vector<PatchPoint> points;
};

/// tangents: of the plane, in the body's own axes; at: where its centre lies in the plane.
void project_face(const PolyhedronView& p, std::uint32_t face, const Vec3& tangent1, const Vec3& tangent2,
                  const Eigen::Vector2d& at, bool reversed, Corners& out) {
  const std::uint32_t begin = p.face_begin[face], end = p.face_begin[face + 1];
  out.clear();
  out.make_room(end - begin);
  for (std::uint32_t k = begin; k < end; ++k) {
    // A face opposed to the normal runs clockwise in the plane: reverse it.
    const Vec3& v = p.vertices[p.face_vertices[reversed ? begin + end - 1 - k : k]];
    out.add({tangent1.dot(v) + at.x(), tangent2.dot(v) + at.y(), k - begin, false, 0, 0});
  }
}

/// Clips B's face by all edges of A's, both counter-clockwise (Sutherland, Hodgman 1974). Most edges cut nothing and
/// copy nothing.
const Corners& clip(Buffers& buf, double tolerance) {
  const Corners* left = &buf.b;
  const auto n = static_cast<std::uint32_t>(buf.a.size());
  for (std::uint32_t k = 0; k < n && left->size() > 0; ++k) {
    const Corner &p = buf.a[k], &q = buf.a[k + 1 < n ? k + 1 : 0];
    const double ex = q.x - p.x, ey = q.y - p.y;
    const std::size_t count = left->size();
    if (buf.side.size() < count) buf.side.resize(count);
    double least = 0.0;
    for (std::size_t i = 0; i < count; ++i) {  // distance times the edge's length, > 0 inside
      const Corner& c = (*left)[i];
      const double side = ex * (c.y - p.y) - ey * (c.x - p.x);
      buf.side[i] = side;
      least = side >= least ? least : side;
    }
    if (least >= 0.0) continue;  // no root for most edges
    const double outside = -tolerance * std::sqrt(ex * ex + ey * ey);
    if (!(outside < 0.0) || least >= outside) continue;
    Corners& next = left == &buf.first ? buf.second : buf.first;
    next.clear();
    next.make_room(2 * count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t j = i + 1 < count ? i + 1 : 0;
      const Corner &from = (*left)[i], &to = (*left)[j];
      const double d0 = buf.side[i], d1 = buf.side[j];
      const bool in0 = d0 >= outside, in1 = d1 >= outside;
      if (in0) next.add(from);
      if (in0 == in1) continue;
      const double t = std::clamp(d0 / (d0 - d1), 0.0, 1.0);
      Corner cross{
          from.x + t * (to.x - from.x), from.y + t * (to.y - from.y), from.source, from.edge_of_a, k, from.source};
      if (in0) {  // leaving: the polygon goes on along A's edge
        cross.source = k;
        cross.edge_of_a = true;
      }
      next.add(cross);
    }
    left = &next;
  }
  return *left;
}

/// Best aligned face around a vertex: the one whose normal is closest to `direction` (the body's own axes).
std::uint32_t facing_face(const PolyhedronView& p, std::uint32_t vertex, const Vec3& direction) {
  std::uint32_t best = p.fans[p.fan_begin[vertex]];
  double cosine = -2.0;
  for (std::uint32_t k = p.fan_begin[vertex]; k < p.fan_begin[vertex + 1]; ++k) {
    const double c = p.face_normals[p.fans[k]].dot(direction);
    if (c > cosine) {
      cosine = c;
      best = p.fans[k];
    }
  }
  return best;
}

struct FacingFaces {
  std::uint32_t a, b;
};

FacingFaces facing_faces(const PolyhedronPair& pair, const SeparatingAxis& axis) {
  using Kind = SeparatingAxis::Kind;
  const Vec3 into_b = -(pair.rotation.transpose() * axis.normal);
  if (axis.kind == Kind::edges) {  // only faces that hold the edge
    const HullEdge &ea = pair.a.edges[axis.feature_a], &eb = pair.b.edges[axis.feature_b];
    const auto better = [](const PolyhedronView& p, const HullEdge& e, const Vec3& n) {
      return p.face_normals[e.left].dot(n) >= p.face_normals[e.right].dot(n) ? e.left : e.right;
    };
    return {better(pair.a, ea, axis.normal), better(pair.b, eb, into_b)};
  }
  if (axis.kind == Kind::face_a) return {axis.feature_a, facing_face(pair.b, axis.feature_b, into_b)};
  if (axis.kind == Kind::face_b) return {facing_face(pair.a, axis.feature_a, axis.normal), axis.feature_b};
  return {facing_face(pair.a, pair.support_a(axis.normal), axis.normal),
          facing_face(pair.b, pair.support_b(axis.normal), into_b)};
}

/// Name of a clipped corner by what lies there, the same whichever body was clipped.
Feature name_corner(const Corner& c, const Buffers& buf, const PolyhedronPair& pair, const FacingFaces& f,
                    double tolerance) {
  const double close = 4.0 * tolerance * tolerance;
  const auto first_near = [&](const Corners& polygon) {
    std::uint32_t first = none_near;
    for (std::uint32_t k = static_cast<std::uint32_t>(polygon.size()); k-- > 0;) {  // without a branch to guess
      const double dx = polygon[k].x - c.x, dy = polygon[k].y - c.y;
      first = dx * dx + dy * dy <= close ? k : first;
    }
    return first;
  };
  const std::uint32_t begin_a = pair.a.face_begin[f.a], end_b = pair.b.face_begin[f.b + 1];
  const auto vertex_a = [&](std::uint32_t k) { return pair.a.face_vertices[begin_a + k]; };
  const auto vertex_b = [&](std::uint32_t k) { return pair.b.face_vertices[end_b - 1 - k]; };
  const std::uint32_t at_a = first_near(buf.a);
  if (at_a != none_near) return make_feature(FeatureKind::vertex_a, vertex_a(at_a), 0);
  const std::uint32_t at_b = first_near(buf.b);
  if (at_b != none_near) return make_feature(FeatureKind::vertex_b, 0, vertex_b(at_b));
  return make_feature(FeatureKind::edges, vertex_a(c.edge_a), vertex_b(c.edge_b));
}

void single_point(const PolyhedronPair& pair, const PolyhedronDistance& d, double sweep_a, double sweep_b, Patch& out) {
  using Kind = SeparatingAxis::Kind;
  Feature feature = make_feature(FeatureKind::single, 0, 0);
  if (d.axis.kind == Kind::face_a) feature = make_feature(FeatureKind::vertex_b, 0, pair.support_b(d.axis.normal));
  if (d.axis.kind == Kind::face_b) feature = make_feature(FeatureKind::vertex_a, pair.support_a(d.axis.normal), 0);
  const Vec3 middle = 0.5 * (d.witness_a + d.witness_b) + 0.5 * (sweep_a - sweep_b) * d.axis.normal;
  out.point[0] = {middle, d.axis.gap - sweep_a - sweep_b, feature};
  out.count = 1;
  out.alone = true;
}

bool is_over(const Corners& face, double x, double y, double tolerance) {
  for (std::size_t k = 0; k < face.size(); ++k) {
    const Corner &p = face[k], &q = face[k + 1 < face.size() ? k + 1 : 0];
    const double ex = q.x - p.x, ey = q.y - p.y;
    if (ex * (y - p.y) - ey * (x - p.x) < -tolerance * std::sqrt(ex * ex + ey * ey)) return false;
  }
  return true;
}

bool looks_along(const PolyhedronView& p, std::uint32_t vertex, const Vec3& direction) {
  for (std::uint32_t k = p.fan_begin[vertex]; k < p.fan_begin[vertex + 1]; ++k)
    if (p.face_normals[p.fans[k]].dot(direction) > facing_cosine) return true;
  return false;
}

/// If a face of one body gives the normal: corners of the other over it that are not on the clipped face. Otherwise a
/// deep corner would be lost when the clipped face changes.
void add_other_corners(const PolyhedronPair& pair, const SeparatingAxis& axis, const FacingFaces& f, double reach,
                       double sweep_a, double sweep_b, double tolerance, Buffers& buf) {
  if (axis.kind != SeparatingAxis::Kind::face_a && axis.kind != SeparatingAxis::Kind::face_b) return;
  const bool of_b = axis.kind == SeparatingAxis::Kind::face_a;
  const PolyhedronView& body = of_b ? pair.b : pair.a;
  const std::uint32_t own = of_b ? f.b : f.a;
  const Vec3& n = axis.normal;
  const Vec3 towards = of_b ? Vec3(-(pair.rotation.transpose() * n)) : n;  // the face, body's own axes
  const double centre = of_b ? n.dot(pair.offset) - pair.a.face_offsets[f.a]
                             : -pair.b.face_offsets[f.b] + n.dot(pair.offset);  // above the face
  const ContactFrame frame = contact_frame(n);
  const auto face_begin = body.face_vertices.begin() + body.face_begin[own];
  const auto face_end = body.face_vertices.begin() + body.face_begin[own + 1];
  for (std::uint32_t v = 0; v < body.vertices.size(); ++v) {
    const double gap = centre - towards.dot(body.vertices[v]) - sweep_a - sweep_b;
    if (!(gap < reach) || std::find(face_begin, face_end, v) != face_end || !looks_along(body, v, towards)) continue;
    const Vec3 x = of_b ? pair.vertex_b(v) : body.vertices[v];
    if (!is_over(of_b ? buf.a : buf.b, frame.tangent1.dot(x), frame.tangent2.dot(x), tolerance)) continue;
    const double to_middle = of_b ? -sweep_b - 0.5 * gap : sweep_a + 0.5 * gap;
    const Feature name = of_b ? make_feature(FeatureKind::vertex_b, 0, v) : make_feature(FeatureKind::vertex_a, v, 0);
    buf.points.push_back({x + to_middle * n, gap, name});
  }
}

/// Lowers all points equally until the deepest is at `gap`. If only the deepest were lowered, the moment would jump
/// when a small tilt makes another one the deepest.
void lower_to(double gap, Patch& out) {
  double least = infinity;
  for (int k = 0; k < out.count; ++k) least = std::min(least, out.point[static_cast<std::size_t>(k)].gap);
  for (int k = 0; k < out.count && gap < least; ++k) out.point[static_cast<std::size_t>(k)].gap += gap - least;
}

}  // namespace

bool are_corners_of_one(std::span<const PatchPoint> points) {
  const FeatureKind kind = points.empty() ? FeatureKind::edges : feature_kind(points.front().feature);
  const auto is_alike = [kind](const PatchPoint& p) { return feature_kind(p.feature) == kind; };
  return kind != FeatureKind::edges && std::ranges::all_of(points, is_alike);
}

void keep_four(std::span<const PatchPoint> points, const Vec3& normal, double size, Patch& out) {
  out.count = 0;
  if (points.empty()) return;
  const auto take = [&](std::size_t i) { out.point[static_cast<std::size_t>(out.count++)] = points[i]; };
  const auto lowest = [](const auto& p, const auto& q) { return p.gap < q.gap; };
  if (points.size() <= 4) {
    for (std::size_t i = 0; i < points.size(); ++i) take(i);
    return;
  }
  constexpr std::size_t none = ~std::size_t{0};
  // Of the values within `tie` of the highest: the lowest feature. None where even the highest is not above `least`.
  const auto best_by = [&](const auto& value, double tie, double least) {
    double high = -infinity;
    for (const PatchPoint& p : points) high = std::max(high, value(p));
    std::size_t best = none;
    for (std::size_t i = 0; i < points.size() && high > least; ++i)
      if (value(points[i]) >= high - tie && (best == none || points[i].feature < points[best].feature)) best = i;
    return best;
  };
  const std::size_t first = best_by([](const PatchPoint& p) { return -p.gap; }, equal_gap * size, -infinity);
  if (first == none) return;  // positions that are no numbers
  const Vec3 p0 = points[first].position;
  const double far = snap * size * size;  // of squared distances and areas
  const std::size_t second = best_by([&](const PatchPoint& p) { return (p.position - p0).squaredNorm(); }, far, 0.0);
  const Vec3 across = second == none ? Vec3(Vec3::Zero()) : normal.cross(points[second].position - p0);
  const std::size_t left = best_by([&](const PatchPoint& p) { return across.dot(p.position - p0); }, far, far);
  const std::size_t right = best_by([&](const PatchPoint& p) { return -across.dot(p.position - p0); }, far, far);
  for (const std::size_t i : {first, second, left, right})
    if (i != none) take(i);
  const auto kept = std::min_element(out.point.begin(), out.point.begin() + out.count, lowest);
  kept->gap = std::min(kept->gap, std::min_element(points.begin(), points.end(), lowest)->gap);
}

void keep_corners(std::span<const PatchPoint> points, const Vec3& normal, double size, bool springs, Patch& out) {
  if (!springs || points.size() > Patch::most) return keep_four(points, normal, size, out);
  std::ranges::copy(points, out.point.begin());
  out.count = static_cast<int>(points.size());
}

void keep_with_nearest(std::vector<PatchPoint>& points, const NearestPoint& nearest, double size, bool springs,
                       Patch& out) {
  double least = infinity;
  for (const PatchPoint& p : points) least = std::min(least, p.gap);
  // At a tilt that still loads four corners the rim between two of them is less than a tenth deeper: 1 - cos 22.5 deg
  // of the half-width. With that rim point, a slightly tilted body would alternate between both patches.
  const bool on_corner = least <= nearest.gap + std::max(equal_gap * size, -0.1 * nearest.gap);
  if (!on_corner) points.push_back({nearest.position, nearest.gap, make_feature(FeatureKind::single, 0, 0)});
  keep_corners(points, nearest.normal, size, springs && are_corners_of_one(points), out);
  if (!on_corner) return;
  lower_to(nearest.gap, out);  // the corners stand for the rim between them
}

Patch contact_patch(const PolyhedronPair& pair, const PolyhedronDistance& d, double reach, double sweep_a,
                    double sweep_b) {
  Patch out;
  const double sweeps = sweep_a + sweep_b;
  if (!(d.axis.gap - sweeps < reach)) return out;
  static thread_local Buffers buf;
  const Vec3& n = d.axis.normal;
  const FacingFaces f = facing_faces(pair, d.axis);
  out.face_a = f.a;
  out.face_b = f.b;
  const Vec3 &na = pair.a.face_normals[f.a], nb = pair.rotation * pair.b.face_normals[f.b];
  const double cosine_a = na.dot(n), cosine_b = nb.dot(n);
  buf.points.clear();
  const double size = std::min(pair.a.radius, pair.b.radius), tolerance = snap * size;
  if (cosine_a > facing_cosine && cosine_b < -facing_cosine) {
    const ContactFrame frame = contact_frame(n);
    const Vec3 &t1 = frame.tangent1, &t2 = frame.tangent2;
    project_face(pair.a, f.a, t1, t2, {0.0, 0.0}, false, buf.a);
    project_face(pair.b, f.b, pair.rotation.transpose() * t1, pair.rotation.transpose() * t2,
                 {t1.dot(pair.offset), t2.dot(pair.offset)}, true, buf.b);
    const double offset_b = pair.b.face_offsets[f.b] + nb.dot(pair.offset);
    for (const Corner& c : clip(buf, tolerance)) {
      const Vec3 x = c.x * frame.tangent1 + c.y * frame.tangent2;
      const double on_a = (pair.a.face_offsets[f.a] - na.dot(x)) / cosine_a, on_b = (offset_b - nb.dot(x)) / cosine_b;
      if (!(on_b - on_a - sweeps < reach)) continue;
      const Feature name = name_corner(c, buf, pair, f, tolerance);
      const auto same = [&](const PatchPoint& p) { return p.feature == name; };
      if (std::any_of(buf.points.begin(), buf.points.end(), same)) continue;  // corners within the snap distance
      buf.points.push_back({x + 0.5 * (on_a + sweep_a + on_b - sweep_b) * n, on_b - on_a - sweeps, name});
    }
    add_other_corners(pair, d.axis, f, reach, sweep_a, sweep_b, tolerance, buf);
  }
  keep_corners(buf.points, n, size, !(reach > 0.0) && are_corners_of_one(buf.points), out);
  // The patch must hold the pair's deepest point; where it does not (tip, crossed edges), that point alone is the
  // contact.
  double deepest = infinity;
  for (int k = 0; k < out.count; ++k) deepest = std::min(deepest, out.point[static_cast<std::size_t>(k)].gap);
  if (!(std::abs(deepest - (d.axis.gap - sweeps)) <= 1e-5 * size)) single_point(pair, d, sweep_a, sweep_b, out);
  return out;
}

}  // namespace epafi
