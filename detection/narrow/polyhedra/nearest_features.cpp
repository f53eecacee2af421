#include "detection/narrow/polyhedra/nearest_features.h"

#include <cmath>
#include <vector>

#include "detection/narrow/polyhedra/axis_search.h"

namespace epafi {
namespace {

using NearestKind = NearestFeatures::Kind;

constexpr double room = 1e-10;  // of the size: what a condition must hold by
constexpr double clear =
    1e-5;  // of the size: a difference of points closer than this has lost too many digits for `room`
constexpr double apart = 1e-12;  // of the size: of faces and crossed edges, whose normals need no difference of points

double size_of(const PolyhedronPair& pair) { return std::min(pair.a.radius, pair.b.radius); }

/// d (the body's own axes) points strictly out of the body at the vertex.
bool in_cone(const PolyhedronView& p, std::uint32_t v, const Vec3& d) {
  const double height = d.dot(p.vertices[v]) - room * p.radius;
  for (std::uint32_t k = p.neighbour_begin[v]; k < p.neighbour_begin[v + 1]; ++k)
    if (!(d.dot(p.vertices[p.neighbours[k]]) < height)) return false;
  return true;
}

/// d (unit, the body's own axes, across the edge) lies strictly between the normals of the edge's faces.
bool in_cone(const PolyhedronView& p, const HullEdge& edge, const Vec3& d) {
  const Vec3 e = p.vertices[edge.to] - p.vertices[edge.from];
  const double needed = -room * e.norm();
  return d.dot(p.face_normals[edge.left].cross(e)) < needed && d.dot(e.cross(p.face_normals[edge.right])) < needed;
}

bool inside(double parameter) { return parameter > room && parameter < 1.0 - room; }

/// x (the face's own axes) lies strictly over the face.
bool over_face(const PolyhedronView& p, std::uint32_t f, const Vec3& x) {
  const std::uint32_t begin = p.face_begin[f], last = p.face_begin[f + 1] - 1;
  for (std::uint32_t k = begin, previous = last; k <= last; previous = k++) {
    const Vec3& from = p.vertices[p.face_vertices[previous]];
    const Vec3 e = p.vertices[p.face_vertices[k]] - from;
    if (!(p.face_normals[f].dot(e.cross(x - from)) > room * p.radius * e.cwiseAbs().sum())) return false;
  }
  return true;
}

bool on_face_a(const PolyhedronPair& pair, const NearestFeatures& at, PolyhedronDistance& out) {
  const Vec3& n = pair.a.face_normals[at.a];
  const Vec3 x = pair.vertex_b(at.b);
  const double gap = n.dot(x) - pair.a.face_offsets[at.a];
  if (!(gap > apart * size_of(pair)) || !in_cone(pair.b, at.b, -(pair.rotation.transpose() * n))) return false;
  if (!over_face(pair.a, at.a, x)) return false;
  out.axis = {SeparatingAxis::Kind::face_a, gap, n, at.a, at.b};
  out.witness_b = x;
  out.witness_a = x - gap * n;
  return true;
}

bool on_face_b(const PolyhedronPair& pair, const NearestFeatures& at, PolyhedronDistance& out) {
  const Vec3& m = pair.b.face_normals[at.b];
  const Vec3 x = pair.rotation.transpose() * (pair.a.vertices[at.a] - pair.offset);
  const double gap = m.dot(x) - pair.b.face_offsets[at.b];
  const Vec3 n = -(pair.rotation * m);
  if (!(gap > apart * size_of(pair)) || !in_cone(pair.a, at.a, n) || !over_face(pair.b, at.b, x)) return false;
  out.axis = {SeparatingAxis::Kind::face_b, gap, n, at.a, at.b};
  out.witness_a = pair.a.vertices[at.a];
  out.witness_b = out.witness_a + gap * n;
  return true;
}

bool on_edges(const PolyhedronPair& pair, const NearestFeatures& at, PolyhedronDistance& out) {
  const HullEdge &ea = pair.a.edges[at.a], &eb = pair.b.edges[at.b];
  const Vec3 p = pair.a.vertices[ea.from], u = pair.a.vertices[ea.to] - p;
  const Vec3 q = pair.vertex_b(eb.from), v = pair.rotation * (pair.b.vertices[eb.to] - pair.b.vertices[eb.from]);
  Vec3 n = u.cross(v);
  const double square = n.squaredNorm();
  if (!(square > 1e-8 * u.squaredNorm() * v.squaredNorm())) return false;  // nearly parallel: 1e-4 rad
  const Vec3 between = q - p;
  n /= n.dot(between) < 0.0 ? -std::sqrt(square) : std::sqrt(square);
  const double gap = n.dot(between);
  if (!(gap > apart * size_of(pair))) return false;
  const Vec3 across_v = v.cross(n), across_u = u.cross(n);
  const double s = between.dot(across_v) / u.dot(across_v), t = -between.dot(across_u) / v.dot(across_u);
  if (!inside(s) || !inside(t)) return false;
  if (!in_cone(pair.a, ea, n) || !in_cone(pair.b, eb, -(pair.rotation.transpose() * n))) return false;
  out.axis = {SeparatingAxis::Kind::edges, gap, n, at.a, at.b};
  out.witness_a = p + s * u;
  out.witness_b = out.witness_a + gap * n;
  return true;
}

/// The part of w across the edge direction e, and where along the edge its foot is. False at an end or too close.
bool across_edge(const Vec3& w, const Vec3& e, double needed, Vec3& n, double& gap, double& along) {
  const double square = e.squaredNorm();
  along = w.dot(e) / square;
  if (!inside(along)) return false;
  n = w - along * e;
  n -= e * (n.dot(e) / square);  // what rounding left along the edge
  gap = n.norm();
  if (!(gap > needed)) return false;
  n /= gap;
  return true;
}

bool on_edge_and_vertex(const PolyhedronPair& pair, const NearestFeatures& at, PolyhedronDistance& out) {
  const bool edge_of_b = at.kind == NearestKind::vertex_edge;
  const HullEdge& edge = edge_of_b ? pair.b.edges[at.b] : pair.a.edges[at.a];
  const Vec3 from = edge_of_b ? pair.vertex_b(edge.from) : pair.a.vertices[edge.from];
  const Vec3 e = edge_of_b ? Vec3(pair.rotation * (pair.b.vertices[edge.to] - pair.b.vertices[edge.from]))
                           : Vec3(pair.a.vertices[edge.to] - from);
  const Vec3 x = edge_of_b ? pair.a.vertices[at.a] : pair.vertex_b(at.b);
  Vec3 n;
  double gap = 0.0, along = 0.0;
  if (!across_edge(x - from, e, clear * size_of(pair), n, gap, along)) return false;
  if (edge_of_b) n = -n;  // from A to B
  const Vec3 back = -(pair.rotation.transpose() * n);
  if (edge_of_b ? !in_cone(pair.a, at.a, n) || !in_cone(pair.b, edge, back)
                : !in_cone(pair.a, edge, n) || !in_cone(pair.b, at.b, back))
    return false;
  const Vec3 foot = from + along * e;
  out.axis = {SeparatingAxis::Kind::points, gap, n, 0, 0};
  out.witness_a = edge_of_b ? x : foot;
  out.witness_b = edge_of_b ? foot : x;
  return true;
}

bool on_vertices(const PolyhedronPair& pair, const NearestFeatures& at, PolyhedronDistance& out) {
  const Vec3 x = pair.a.vertices[at.a], y = pair.vertex_b(at.b);
  Vec3 n = y - x;
  const double gap = n.norm();
  if (!(gap > clear * size_of(pair))) return false;
  n /= gap;
  if (!in_cone(pair.a, at.a, n) || !in_cone(pair.b, at.b, -(pair.rotation.transpose() * n))) return false;
  out.axis = {SeparatingAxis::Kind::points, gap, n, 0, 0};
  out.witness_a = x;
  out.witness_b = y;
  return true;
}

/// The distinct vertices of a body in GJK's simplex.
struct NearestCorners {
  std::array<std::uint32_t, 4> vertex{};
  std::uint32_t count = 0;
  void add(std::uint32_t v) {
    for (std::uint32_t k = 0; k < count; ++k)
      if (vertex[k] == v) return;
    vertex[count++] = v;
  }
};

bool find_edge(const PolyhedronView& p, std::uint32_t v, std::uint32_t w, std::uint32_t& out) {
  for (out = 0; out < p.edges.size(); ++out) {
    const HullEdge& e = p.edges[out];
    if ((e.from == v && e.to == w) || (e.from == w && e.to == v)) return true;
  }
  return false;
}

bool find_face(const PolyhedronView& p, const NearestCorners& c, std::uint32_t& out) {
  const auto around = [&](std::uint32_t v, std::uint32_t f) {
    for (std::uint32_t k = p.fan_begin[v]; k < p.fan_begin[v + 1]; ++k)
      if (p.fans[k] == f) return true;
    return false;
  };
  for (std::uint32_t k = p.fan_begin[c.vertex[0]]; k < p.fan_begin[c.vertex[0] + 1]; ++k) {
    out = p.fans[k];
    if (around(c.vertex[1], out) && around(c.vertex[2], out)) return true;
  }
  return false;
}

/// The features spanned by the simplex itself: nearly always those that certify.
NearestFeatures features_of(const PolyhedronPair& pair, const NearestCorners& a, const NearestCorners& b) {
  NearestFeatures f{NearestKind::none, a.vertex[0], b.vertex[0]};
  if (a.count == 1 && b.count == 1) f.kind = NearestKind::vertices;
  if (a.count == 1 && b.count == 2 && find_edge(pair.b, b.vertex[0], b.vertex[1], f.b))
    f.kind = NearestKind::vertex_edge;
  if (a.count == 2 && b.count == 1 && find_edge(pair.a, a.vertex[0], a.vertex[1], f.a))
    f.kind = NearestKind::edge_vertex;
  if (a.count == 2 && b.count == 2 && find_edge(pair.a, a.vertex[0], a.vertex[1], f.a) &&
      find_edge(pair.b, b.vertex[0], b.vertex[1], f.b))
    f.kind = NearestKind::edges;
  if (a.count == 3 && b.count == 1 && find_face(pair.a, a, f.a)) f.kind = NearestKind::face_vertex;
  if (a.count == 1 && b.count == 3 && find_face(pair.b, b, f.b)) f.kind = NearestKind::vertex_face;
  return f;
}

/// The features of one body that may touch its supporting plane across a direction known up to an angle.
struct Near {
  std::vector<std::uint32_t> vertices, edges, faces;
  std::vector<char> near;
  void find(const PolyhedronView& p, const Vec3& d, double slack) {
    vertices.clear();
    edges.clear();
    faces.clear();
    near.assign(p.vertices.size(), 0);
    double top = -infinity;
    for (const Vec3& x : p.vertices) top = std::max(top, d.dot(x));
    for (std::uint32_t v = 0; v < p.vertices.size(); ++v)
      if (d.dot(p.vertices[v]) >= top - slack) {
        near[v] = 1;
        vertices.push_back(v);
      }
    for (std::uint32_t e = 0; e < p.edges.size(); ++e)
      if (near[p.edges[e].from] && near[p.edges[e].to]) edges.push_back(e);
    for (std::uint32_t f = 0; f + 1 < p.face_begin.size(); ++f) {
      bool all = true;
      for (std::uint32_t k = p.face_begin[f]; k < p.face_begin[f + 1]; ++k) all = all && near[p.face_vertices[k]];
      if (all) faces.push_back(f);
    }
  }
};

/// Every pair of features near the supporting planes. A vertex of small weight in the simplex sends one here.
bool search_near(const PolyhedronPair& pair, const GjkResult& g, NearestFeatures& found, PolyhedronDistance& out) {
  // The true normal makes an angle with g.normal whose cosine is at least lower / upper, both rounded.
  const double rounding = 1e-14 * (pair.a.radius + pair.b.radius + pair.offset.cwiseAbs().maxCoeff());
  const double cosine = std::clamp((g.lower - rounding) / (g.upper + rounding), 0.0, 1.0);
  const double angle = std::sqrt(2.0 * (1.0 - cosine)) + 1e-9;
  if (angle > 1e-3) return false;  // too many features look alike: all are searched (4.5 us otherwise, 0.8 so)
  static thread_local Near a, b;   // keep their size: no allocation once the largest was seen
  a.find(pair.a, g.normal, (2.0 * angle + room) * pair.a.radius);
  b.find(pair.b, -(pair.rotation.transpose() * g.normal), (2.0 * angle + room) * pair.b.radius);
  const auto any = [&](NearestKind kind, const auto& of_a, const auto& of_b) {
    for (const std::uint32_t i : of_a)
      for (const std::uint32_t j : of_b)
        if (certify(pair, found = {kind, i, j}, out)) return true;
    return false;
  };
  return any(NearestKind::face_vertex, a.faces, b.vertices) || any(NearestKind::vertex_face, a.vertices, b.faces) ||
         any(NearestKind::edges, a.edges, b.edges) || any(NearestKind::vertex_edge, a.vertices, b.edges) ||
         any(NearestKind::edge_vertex, a.edges, b.vertices) || any(NearestKind::vertices, a.vertices, b.vertices);
}

}  // namespace

bool certify(const PolyhedronPair& pair, const NearestFeatures& at, PolyhedronDistance& out) {
  out.beyond = false;
  out.uncertainty = 0.0;
  switch (at.kind) {
    case NearestKind::face_vertex:
      return on_face_a(pair, at, out);
    case NearestKind::vertex_face:
      return on_face_b(pair, at, out);
    case NearestKind::edges:
      return on_edges(pair, at, out);
    case NearestKind::vertex_edge:
    case NearestKind::edge_vertex:
      return on_edge_and_vertex(pair, at, out);
    case NearestKind::vertices:
      return on_vertices(pair, at, out);
    default:
      return false;
  }
}

bool find_nearest_features(const PolyhedronPair& pair, const GjkResult& g, NearestFeatures& features,
                           PolyhedronDistance& out) {
  NearestCorners a, b;
  for (int k = 0; k < g.simplex.count; ++k) {
    const MinkowskiVertex& v = g.simplex.vertex[static_cast<std::size_t>(k)];
    a.add(v.index_a);
    b.add(v.index_b);
  }
  features = features_of(pair, a, b);
  return certify(pair, features, out) || search_near(pair, g, features, out);
}

}  // namespace epafi
