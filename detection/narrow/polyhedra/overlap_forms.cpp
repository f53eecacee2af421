#include "detection/narrow/polyhedra/overlap_forms.h"

#include <algorithm>
#include <cmath>

#include "detection/narrow/polyhedra/overlap_faces.h"

namespace epafi {
namespace {

double thinnest(const PolyhedronView& a, const PolyhedronView& b) { return thinnest_cell * (a.radius + b.radius); }

/// A part of the overlap of which something is known without its corners.
struct Ball {
  Vec3 centre;
  double radius;
};

/// Every point of the overlap is deeper than 2 `depth` below all faces of the body but `own`. ball: contains the
/// overlap, in the body's axes; where it says yes, for five forms of six, corners() is not asked for.
template <class Corners>
bool is_clear(const PolyhedronView& view, const Ball& ball, const Corners& corners, double depth,
              std::span<const std::uint32_t> own) {
  const auto& all_below = hull_kernels().all_below;
  return all_below(view.face_lanes, {&ball.centre, 1}, -2.0 * depth - ball.radius, own) ||
         all_below(view.face_lanes, corners(), -2.0 * depth, own);
}

/// One part of a corner: sums over its tetrahedra.
struct Part {
  double volume = 0.0;
  double depth = 0.0;          ///< 4 volume times the depth of the centroid
  Vec3 moment = Vec3::Zero();  ///< 4 volume times the centroid from the vertex
};

/// A corner below a plane.
class Pyramid {
 public:
  /// up: normal of the plane, height: of the vertex above it, < 0. False where the plane does not cut all edges.
  bool assign(const PolyhedronView& view, std::uint32_t vertex, const Vec3& up, double height) {
    if (!cone_.assign(view, vertex)) return false;
    const auto rays = cone_.rays();
    const Vec3& apex = corners_[faces()] = view.vertices[vertex];
    double square = 0.0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
      const double rise = up.dot(rays[k].along);
      if (!(rise > 0.0)) return false;
      const double s = -height / rise;
      point_[k] = s * rays[k].along;
      depth_[k] = s * rays[k].depth;
      if (k < faces()) {
        corners_[k] = apex + point_[k];
        square = std::max(square, point_[k].squaredNorm());
      }
    }
    extent_ = std::sqrt(square);
    return true;
  }
  /// No other face of its body comes nearer to it than 2 `depth`.
  bool is_all_of(const PolyhedronView& view, double depth) const {
    return is_clear(
        view, {corners().back(), extent_}, [&] { return corners(); }, depth, faces_around());
  }
  void measure() {
    for (std::size_t k = 0; k < faces(); ++k) parts_[k] = {};
    for (const CornerCone::Tetrahedron& t : cone_.tetrahedra()) {
      const auto [p, q, r] = t.ray;
      const double volume = std::abs(point_[p].dot(point_[q].cross(point_[r]))) / 6.0;
      Part& part = parts_[t.part];
      part.volume += volume;
      part.depth += volume * (depth_[p] + depth_[q] + depth_[r]);
      part.moment += volume * (point_[p] + point_[q] + point_[r]);
    }
  }
  std::size_t faces() const { return cone_.faces().size(); }
  std::span<const std::uint32_t> faces_around() const { return cone_.faces(); }
  std::span<const Part> parts() const { return {parts_.data(), faces()}; }
  /// The vertex last.
  std::span<const Vec3> corners() const { return {corners_.data(), faces() + 1}; }
  double extent() const { return extent_; }  ///< of the farthest corner from the vertex [m]
  /// Of the point farthest below the faces around the vertex.
  double largest_depth() const {
    return *std::max_element(depth_.begin(), depth_.begin() + static_cast<std::ptrdiff_t>(cone_.rays().size()));
  }

 private:
  CornerCone cone_;
  std::array<Vec3, CornerCone::most_rays> point_;  ///< where the rays pass through the plane, from the vertex
  std::array<double, CornerCone::most_rays> depth_;
  std::array<Vec3, CornerCone::most_faces + 1> corners_;
  std::array<Part, CornerCone::most_faces> parts_;
  double extent_ = 0.0;
};

struct FormScratch {
  Pyramid pyramid;
  std::vector<Vec3> corners;  ///< in the other body's axes
};
FormScratch& form_scratch() {
  static thread_local FormScratch s;  // results do not depend on it
  return s;
}

/// From the axes of the one with the vertex, the tip, to the other's.
struct Placing {
  Mat3 turn;
  Vec3 offset;
  Vec3 operator()(const Vec3& x) const { return turn * x + offset; }
};

bool corner_in_face(const PolyhedronView& tip, std::uint32_t vertex, const PolyhedronView& other, std::uint32_t face,
                    const Placing& place, bool tip_is_a, std::vector<OverlapCell>& out) {
  Pyramid& pyramid = form_scratch().pyramid;
  std::vector<Vec3>& corners = form_scratch().corners;
  const double least = thinnest(tip, other);
  const Vec3 &v = tip.vertices[vertex], &n = other.face_normals[face], up = place.turn.transpose() * n;
  const double height = n.dot(place(v)) - other.face_offsets[face];
  if (!(-height > least) || !pyramid.assign(tip, vertex, up, height)) return false;
  const auto in_other = [&]() -> std::span<const Vec3> {
    corners.clear();
    for (const Vec3& x : pyramid.corners()) corners.push_back(place(x));
    return corners;
  };
  if (!is_clear(other, {place(v), pyramid.extent()}, in_other, -height, {&face, 1})) return false;
  if (!pyramid.is_all_of(tip, pyramid.largest_depth())) return false;
  pyramid.measure();
  const auto in_a = [&](const Vec3& x) -> Vec3 { return tip_is_a ? v + x : place(v + x); };
  Part whole;
  bool thick = true;
  for (std::size_t k = 0; k < pyramid.faces(); ++k) {
    const Part& p = pyramid.parts()[k];
    const double scale = 0.25 / p.volume, depth = scale * p.depth;
    out.push_back({tip_is_a, pyramid.faces_around()[k], p.volume, depth, in_a(scale * p.moment)});
    whole.volume += p.volume;
    whole.moment += p.moment;
    thick = thick && depth > least;
  }
  const Vec3 centroid = 0.25 / whole.volume * whole.moment;
  const double depth = -(height + up.dot(centroid));
  out.push_back({!tip_is_a, face, whole.volume, depth, in_a(centroid)});
  return thick && depth > least;
}

/// An edge of one body between two faces of the other, as from + s along, A's axes.
struct CrossingEdge {
  Vec3 from, along;
  std::uint32_t left, right;                   ///< its own faces
  Vec3 left_normal, right_normal;              ///< of these
  double at_left = 0.0, at_right = 0.0;        ///< s on the other edge's left and right face
  double below_left = 0.0, below_right = 0.0;  ///< depth there below the face that it is not on [m]

  /// apart: from a point of the other edge to `from`. False where the edge does not run through the other's wedge.
  bool cross(const CrossingEdge& other, const Vec3& apart) {
    const double left_slope = other.left_normal.dot(along), right_slope = other.right_normal.dot(along);
    at_left = -other.left_normal.dot(apart) / left_slope;
    at_right = -other.right_normal.dot(apart) / right_slope;
    below_left = left_slope * (at_left - at_right);
    below_right = right_slope * (at_right - at_left);
    return below_left > 0.0 && below_right > 0.0;
  }
  Vec3 at(double s) const { return from + s * along; }
  Vec3 left_end() const { return at(at_left); }
  Vec3 right_end() const { return at(at_right); }
};

/// The field of the body whose edge is `own`: between its faces is a plane through that edge and a point of the other.
void add_halves(const CrossingEdge& own, const CrossingEdge& other, double volume, bool of_a,
                std::vector<OverlapCell>& out) {
  const double share = other.below_right / (other.below_left + other.below_right);  // of the left face
  const Vec3 own_ends = own.left_end() + own.right_end();
  const Vec3 middle = other.at(other.at_left + share * (other.at_right - other.at_left));
  const double depth = 0.25 * share * other.below_left;  // the same below both faces
  out.push_back({of_a, own.left, share * volume, depth, 0.25 * (own_ends + other.left_end() + middle)});
  out.push_back({of_a, own.right, (1.0 - share) * volume, depth, 0.25 * (own_ends + middle + other.right_end())});
}

bool between_edges(const PolyhedronPair& pair, std::uint32_t edge_a, std::uint32_t edge_b,
                   std::vector<OverlapCell>& out) {
  const HullEdge &ea = pair.a.edges[edge_a], &eb = pair.b.edges[edge_b];
  const auto& of_a = pair.a.vertices;
  CrossingEdge a{of_a[ea.from], of_a[ea.to] - of_a[ea.from],  ea.left,
                 ea.right,      pair.a.face_normals[ea.left], pair.a.face_normals[ea.right]};
  CrossingEdge b{pair.vertex_b(eb.from),
                 pair.rotation * (pair.b.vertices[eb.to] - pair.b.vertices[eb.from]),
                 eb.left,
                 eb.right,
                 pair.rotation * pair.b.face_normals[eb.left],
                 pair.rotation * pair.b.face_normals[eb.right]};
  const Vec3 apart = a.from - b.from;
  if (!a.cross(b, apart) || !b.cross(a, -apart)) return false;
  const double volume =
      std::abs((a.at_right - a.at_left) * (b.at_right - b.at_left) * a.along.cross(b.along).dot(apart)) / 6.0;
  add_halves(a, b, volume, true, out);
  add_halves(b, a, volume, false, out);
  const double least = thinnest(pair.a, pair.b);
  if (!(out[0].depth > least && out[2].depth > least)) return false;
  const double depth_a = std::min(b.below_left, b.below_right), depth_b = std::min(a.below_left, a.below_right);
  std::array<Vec3, 4> corners{a.left_end(), a.right_end(), b.left_end(), b.right_end()};
  Ball ball{0.25 * (corners[0] + corners[1] + corners[2] + corners[3]), 0.0};
  for (const Vec3& x : corners) ball.radius = std::max(ball.radius, (x - ball.centre).squaredNorm());
  ball.radius = std::sqrt(ball.radius);
  const std::array<std::uint32_t, 2> own_a{ea.left, ea.right}, own_b{eb.left, eb.right};
  const auto in_a = [&]() -> std::span<const Vec3> { return corners; };
  if (!is_clear(pair.a, ball, in_a, depth_a, own_a)) return false;
  const auto to_b = [&](const Vec3& x) -> Vec3 { return pair.rotation.transpose() * (x - pair.offset); };
  const auto in_b = [&]() -> std::span<const Vec3> {
    for (Vec3& x : corners) x = to_b(x);
    return corners;
  };
  return is_clear(pair.b, {to_b(ball.centre), ball.radius}, in_b, depth_b, own_b);
}

}  // namespace

bool find_cells(const PolyhedronPair& pair, const OverlapForm& form, std::vector<OverlapCell>& out) {
  const auto& [a, b, rotation, offset] = pair;
  const auto exist = [&](std::size_t in_a, std::size_t in_b) { return form.a < in_a && form.b < in_b; };
  out.clear();
  switch (form.kind) {
    case OverlapForm::Kind::none:
      return false;
    case OverlapForm::Kind::edges:
      return exist(a.edges.size(), b.edges.size()) && between_edges(pair, form.a, form.b, out);
    case OverlapForm::Kind::face_vertex:
      return exist(a.face_normals.size(), b.vertices.size()) &&
             corner_in_face(b, form.b, a, form.a, {rotation, offset}, false, out);
    case OverlapForm::Kind::vertex_face:
      return exist(a.vertices.size(), b.face_normals.size()) &&
             corner_in_face(a, form.a, b, form.b, {rotation.transpose(), -(rotation.transpose() * offset)}, true, out);
    case OverlapForm::Kind::faces:
      return find_cells(pair, form.near, out);
  }
  return false;
}

OverlapForm form_of(const SeparatingAxis& axis) {
  using Axis = SeparatingAxis::Kind;
  using Kind = OverlapForm::Kind;
  const Kind kind = axis.kind == Axis::edges    ? Kind::edges
                    : axis.kind == Axis::face_a ? Kind::face_vertex
                    : axis.kind == Axis::face_b ? Kind::vertex_face
                                                : Kind::none;
  return {kind, axis.feature_a, axis.feature_b, {}};
}

namespace {

/// The edge between two faces, the number of edges where there is none.
std::uint32_t edge_between(const PolyhedronView& p, std::uint32_t f, std::uint32_t g) {
  const auto found = std::ranges::find_if(
      p.edges, [&](const HullEdge& e) { return (e.left == f && e.right == g) || (e.left == g && e.right == f); });
  return static_cast<std::uint32_t>(found - p.edges.begin());
}

/// The vertex around which there are these faces and no others (sorted), the number of vertices where there is none.
std::uint32_t vertex_among(const PolyhedronView& p, std::span<const std::uint32_t> faces) {
  std::uint32_t v = 0;
  const auto has_face = [&](std::uint32_t f) { return std::ranges::binary_search(faces, f); };
  const auto matches = [&] {
    const auto fan = p.fans.subspan(p.fan_begin[v], p.fan_begin[v + 1] - p.fan_begin[v]);
    return fan.size() == faces.size() && std::ranges::all_of(fan, has_face);
  };
  while (v < p.vertices.size() && !matches()) ++v;
  return v;
}

}  // namespace

OverlapForm form_of(const PolyhedronPair& pair, std::span<const std::uint32_t> of_a,
                    std::span<const std::uint32_t> of_b) {
  using Kind = OverlapForm::Kind;
  const PolyhedronView &a = pair.a, &b = pair.b;
  if (of_a.size() == 2 && of_b.size() == 2) {
    const std::uint32_t on_a = edge_between(a, of_a[0], of_a[1]), on_b = edge_between(b, of_b[0], of_b[1]);
    if (on_a < a.edges.size() && on_b < b.edges.size()) return {Kind::edges, on_a, on_b, {}};
  } else if (of_a.size() == 1) {
    const std::uint32_t v = vertex_among(b, of_b);
    if (v < b.vertices.size()) return {Kind::face_vertex, of_a[0], v, {}};
  } else if (of_b.size() == 1) {
    const std::uint32_t v = vertex_among(a, of_a);
    if (v < a.vertices.size()) return {Kind::vertex_face, v, of_b[0], {}};
  }
  return {};
}

Volume corner_below(const PolyhedronView& view, std::uint32_t vertex, const Vec3& up, double height) {
  Pyramid& pyramid = form_scratch().pyramid;
  Volume out{view.vertices[vertex]};
  if (!pyramid.assign(view, vertex, up, height)) return out;
  if (!pyramid.is_all_of(view, 0.0)) return out;
  pyramid.measure();
  for (const Part& p : pyramid.parts()) {
    out.volume += p.volume;
    out.moment += 0.25 * p.moment;
  }
  return out;
}

}  // namespace epafi
