#include <algorithm>
#include <cmath>

#include "detection/narrow/epa.h"
#include "detection/narrow/mesh_pairs.h"
#include "detection/narrow/mesh_ridge.h"
#include "detection/narrow/triangle_solid.h"

namespace epafi {
namespace {

constexpr double on_surface = 1e-6;  // of the size, as in the manifold: what counts as lying on an edge or triangle
constexpr double along_face =
    1e-5;  // [rad] a direction of EPA nearer than this to the triangle's normal is meant to be it
constexpr double narrow_enough = 1e-6;  // of the size: a wider interval than this is reported as degenerate

/// What the surface around the point of a triangle says to a normal n from the mesh to the body.
enum class Verdict {
  free,  ///< n is in the normal cone of the surface there
  flat,  ///< a triangle in the same plane reaches out along n: an inner edge that the body cannot feel, the plane holds
  bent,  ///< only triangles of other planes reach out along n: the contact is theirs
  concave  ///< the same, and they rise to the body's side: the planes hold, each its own
};

/// face: the normal of the triangle towards the body's centre. Where n leads through it, it holds nobody: a body beside
/// a convex edge, its centre behind the plane of the far side (1 of 400 cylinders: a depth of half its size).
Verdict judge(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, std::uint32_t own, const Vec3& point,
              const Vec3& n, const Vec3& face, double tolerance) {
  Verdict verdict = Verdict::free;
  const bool holds = n.dot(face) > 0.0;
  for (const auto t : triangles) {
    if (t == own || !lies_on(mesh, t, point, tolerance)) continue;
    bool reaches_out = false, rises = false;
    for (const Vec3& c : mesh.corners(t)) {
      const Vec3 w = c - point;  // flat within 1e-6 rad is not reaching out
      reaches_out = reaches_out || n.dot(w) > 1e-3 * tolerance + 0.1 * along_face * w.norm();
      rises = rises || (holds && face.dot(w) > tolerance + along_face * w.norm());
    }
    if (!reaches_out) continue;
    if (mesh.normals[t].cross(mesh.normals[own]).squaredNorm() <= along_face * along_face) return Verdict::flat;
    if (!rises)
      verdict = Verdict::bent;
    else if (verdict == Verdict::free)
      verdict = Verdict::concave;
  }
  return verdict;
}

/// All triangles lie in one flat part and none at its rim: the body sees a plane. (Where the part ended below the body,
/// one of these would have an open or bent side.) A box on 30 triangles takes 0.2 us so, 14 us triangle by triangle
/// (perf/mesh.cpp).
bool all_plain(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles) {
  return std::all_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
    const auto& kinds = mesh.edge_kinds[t];
    return mesh.flat_group[t] == mesh.flat_group[triangles.front()] &&
           std::all_of(kinds.begin(), kinds.end(), [](EdgeKind k) { return k == EdgeKind::flat; });
  });
}

/// The inside of the triangle, up to `tolerance` beyond its sides, seen along its normal.
bool projects_into(const std::array<Vec3, 3>& corner, const Vec3& normal, const Vec3& x, double tolerance) {
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 side = corner[(k + 1) % 3] - corner[k];
    if (normal.cross(side).dot(x - corner[k]) < -tolerance * side.norm()) return false;
  }
  return true;
}

/// Of the faces around the vertex farthest against n (its own axes) the one that looks most against n.
std::uint32_t face_against(const PolyhedronView& p, const Vec3& n) {
  const std::uint32_t v = ConvexHull::support_vertex(p, -n);
  std::uint32_t best = p.fans[p.fan_begin[v]];
  for (std::uint32_t k = p.fan_begin[v] + 1; k < p.fan_begin[v + 1]; ++k)
    if (p.face_normals[p.fans[k]].dot(n) < p.face_normals[best].dot(n)) best = p.fans[k];
  return best;
}

/// A body of `radius` about `centre` is farther than `limit` from the triangle, as its sphere, the triangle's normal or
/// the direction across its nearest side tells, by more than rounding: a search would find no contact. 30 stones of
/// parts in a hopper ask 2600 triangles a step: 1040 are near by the sphere, 100 by all three. tip: the body's point
/// farthest along a direction.
template <class Tip>
bool is_out_of_reach(const TriangleMesh& mesh, std::uint32_t t, const Vec3& centre, double radius, double limit,
                     const Tip& tip) {
  const OverTriangle at = over_triangle(mesh, t, centre);
  const double near = radius + limit, apart = limit + 4e-12 * (near + std::abs(at.height) + std::abs(at.beyond));
  if (at.least_square() > near * near * (1.0 + 1e-12)) return true;
  const auto corner = mesh.corners(t);
  const Vec3 n = at.height < 0.0 ? Vec3(-mesh.normals[t]) : mesh.normals[t];
  if (n.dot(tip(-n) - corner[0]) > apart) return true;
  if (!(at.beyond > 0.0)) return false;
  const auto beyond = [&](std::size_t k) { return -mesh.inward[t][k].dot(centre - corner[k]); };
  std::size_t side = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (beyond(k) > beyond(side)) side = k;
  const Vec3& inward = mesh.inward[t][side];
  return -inward.dot(tip(inward) - corner[side]) > apart;
}

/// One polyhedron against many triangles, in the mesh's axes.
class PolyhedronOnMesh {
 public:
  PolyhedronOnMesh(const PolyhedronView& body, double sweep, const TriangleMesh& mesh,
                   std::span<const std::uint32_t> triangles, const PairQuery& q)
      : body_(body),
        sweep_(sweep),
        mesh_(mesh),
        triangles_(triangles),
        reach_(q.reach),
        pose_{q.b.to_local(q.a.position), q.b.orientation.conjugate() * q.a.orientation},
        turn_(pose_.orientation.toRotationMatrix()),
        tolerance_(on_surface * body.radius) {}

  const Vec3& centre() const { return pose_.position; }
  const TriangleMesh& mesh() const { return mesh_; }

  /// The corners of the face that looks at the plane of t.
  void collide_plain(std::uint32_t t, std::vector<MeshPoint>& out) const {
    const Vec3 n = normal_towards(mesh_, t, centre());
    const Vec3 on_plane = mesh_.corners(t)[0];
    const std::uint32_t face = face_against(body_, turn_.transpose() * n);
    for (std::uint32_t k = body_.face_begin[face]; k < body_.face_begin[face + 1]; ++k) {
      const std::uint32_t v = body_.face_vertices[k];
      const Vec3 x = centre() + turn_ * body_.vertices[v];
      const double gap = n.dot(x - on_plane) - sweep_;
      const auto name = static_cast<std::uint32_t>(FeatureKind::vertex_a) << 24 | v << 2;
      if (gap < reach_) out.push_back({x - (sweep_ + 0.5 * gap) * n, n, gap, mesh_feature(mesh_.flat_group[t], name)});
    }
  }

  CoreNearMesh core() const { return {core_of(body_), sweep_, pose_, reach_, tolerance_}; }

  void collide(std::uint32_t t, std::vector<MeshPoint>& out, std::vector<BarredTriangle>& barred,
               ContactSink& sink) const {
    const double limit = reach_ + sweep_;
    const auto tip = [&](const Vec3& d) -> Vec3 {
      return centre() + turn_ * body_.vertices[ConvexHull::support_vertex(body_, turn_.transpose() * d)];
    };
    if (is_out_of_reach(mesh_, t, centre(), body_.radius, limit, tip)) return;
    const Vec3 face_normal = normal_towards(mesh_, t, centre());
    const auto corner = mesh_.corners(t);
    const TriangleSolid solid(corner, mesh_.normals[t]);
    const PolyhedronPair pair(body_, solid.view(), pose_, solid.pose());
    const PolyhedronDistance d = polyhedron_distance(pair, limit);
    if (d.beyond) return;
    if (d.uncertainty > narrow_enough * pair.size()) sink.mark_degenerate();
    const Vec3 n = -(turn_ * d.axis.normal);
    // The triangle's own normal holds where it separates best, where the direction is that one within 1e-5 rad, and
    // where the direction belongs to an inner edge or vertex; towards the side of the body's centre.
    const bool face =
        d.axis.kind == SeparatingAxis::Kind::face_b || n.cross(face_normal).squaredNorm() <= along_face * along_face;
    const Vec3 on_mesh = centre() + turn_ * d.witness_b;
    const Verdict verdict = face ? Verdict::flat : judge(mesh_, triangles_, t, on_mesh, n, face_normal, tolerance_);
    // In a concave edge the least direction leans on both faces, and each would leave the contact to the other (a hull
    // sank through the floor beside a wall).
    if (verdict == Verdict::flat || verdict == Verdict::concave) return collide_face(t, corner, face_normal, out);
    if (verdict == Verdict::bent) {
      if (d.axis.gap < sweep_) barred.push_back({t, on_mesh});
      return;
    }
    const Patch patch = contact_patch(pair, d, reach_, sweep_, 0.0);
    for (int k = 0; k < patch.count; ++k) {
      const PatchPoint& p = patch.point[static_cast<std::size_t>(k)];
      out.push_back({centre() + turn_ * p.position, n, p.gap, mesh_feature(t, short_name(p.feature))});
    }
  }

 private:
  /// Kind (2 bits), index on the body (22 bits), index on the triangle (2 bits).
  static std::uint32_t short_name(Feature f) {
    return static_cast<std::uint32_t>(f >> 44 & 3u) << 24 | static_cast<std::uint32_t>(f >> 22 & 0x3fffffu) << 2 |
           static_cast<std::uint32_t>(f & 3u);
  }
  /// Did the body come to x, behind the triangle, through the triangle (or one in its plane) and through no other
  /// before? Otherwise x belongs to the surface beyond an edge: a corner of a box on a table is behind the table's side
  /// as well. cut: 1 + side of the triangle whose prism cut the body at x; where the surface bends away or ends there,
  /// x is its edge.
  bool went_through(std::uint32_t t, const Vec3& n, const Vec3& x, std::uint32_t cut) const {
    const bool front = n.dot(mesh_.normals[t]) > 0.0;
    if (cut > 0) {  // an edge inside a plane says nothing: a box 3 mm beside a convex edge was 27 mm deep there
      const EdgeKind kind = mesh_.edge_kinds[t][cut - 1];
      if (kind != EdgeKind::flat && kind != (front ? EdgeKind::concave : EdgeKind::convex)) return true;
    }
    const double from = n.dot(centre() - mesh_.corners(t)[0]), to = n.dot(x - mesh_.corners(t)[0]);
    const double when = from / (from - to);
    const Vec3 gate = centre() + when * (x - centre());
    bool through = false;
    for (const auto other : triangles_) {
      const auto corner = mesh_.corners(other);
      const Vec3& m = mesh_.normals[other];
      if (m.cross(n).squaredNorm() <= along_face * along_face) {
        through =
            through || (std::abs(m.dot(gate - corner[0])) <= tolerance_ && projects_into(corner, m, gate, tolerance_));
        continue;
      }
      const double h0 = m.dot(centre() - corner[0]), h1 = m.dot(x - corner[0]);
      if (!(h0 * h1 < 0.0) || !(h0 / (h0 - h1) < when)) continue;
      if (projects_into(corner, m, centre() + h0 / (h0 - h1) * (x - centre()), 0.0)) return false;
    }
    return through;
  }
  /// The face of the body that looks at the triangle, cut to the prism over the triangle (Sutherland and Hodgman 1974).
  void collide_face(std::uint32_t t, const std::array<Vec3, 3>& corner, const Vec3& n,
                    std::vector<MeshPoint>& out) const {
    struct Corner {
      Vec3 x;
      std::uint32_t name;  ///< vertex of the body, or 1 + side of the triangle in the low bits after a cut
    };
    static thread_local std::vector<Corner> polygon, next;  // keep their size
    const std::uint32_t face = face_against(body_, turn_.transpose() * n);
    polygon.clear();
    for (std::uint32_t k = body_.face_begin[face]; k < body_.face_begin[face + 1]; ++k)
      polygon.push_back({centre() + turn_ * body_.vertices[body_.face_vertices[k]], body_.face_vertices[k] << 2});
    for (std::uint32_t side = 0; side < 3; ++side) {
      const Vec3 along = corner[(side + 1) % 3] - corner[side], inward = mesh_.normals[t].cross(along).normalized();
      next.clear();
      for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Corner &from = polygon[i], &to = polygon[(i + 1) % polygon.size()];
        const double d0 = inward.dot(from.x - corner[side]), d1 = inward.dot(to.x - corner[side]);
        const bool in0 = d0 >= -tolerance_, in1 = d1 >= -tolerance_;
        if (in0) next.push_back(from);
        if (in0 != in1)
          next.push_back(
              {from.x + std::clamp(d0 / (d0 - d1), 0.0, 1.0) * (to.x - from.x), (from.name & ~3u) | (1 + side)});
      }
      polygon.swap(next);
    }
    for (const Corner& c : polygon) {
      const double height = n.dot(c.x - corner[0]), gap = height - sweep_;
      if (!(gap < reach_) || (height < -tolerance_ && !went_through(t, n, c.x, c.name & 3u))) continue;
      const bool vertex = (c.name & 3u) == 0;
      const auto kind = static_cast<std::uint32_t>(vertex ? FeatureKind::vertex_a : FeatureKind::edges);
      out.push_back({c.x - (sweep_ + 0.5 * gap) * n, n, gap,
                     mesh_feature(vertex ? mesh_.flat_group[t] : t, kind << 24 | c.name)});
    }
  }

  const PolyhedronView& body_;
  double sweep_;
  const TriangleMesh& mesh_;
  std::span<const std::uint32_t> triangles_;
  double reach_;
  Pose pose_;  ///< of the body, in the mesh's axes
  Mat3 turn_;
  double tolerance_;
};

/// Signed distance of a core and a triangle: the normal from the mesh to the body, the nearest or deepest point.
struct CoreDistance {
  bool wanted = false;
  double gap = 0.0;  ///< of the core [m]
  Vec3 normal, on_mesh;
};

/// One smooth convex body against many triangles, in the mesh's axes.
class CoreOnMesh {
 public:
  CoreOnMesh(const CoreOnPlane& body, double sweep, const TriangleMesh& mesh, std::span<const std::uint32_t> triangles,
             const PairQuery& q)
      : body_(body),
        sweep_(sweep),
        mesh_(mesh),
        triangles_(triangles),
        reach_(q.reach),
        pose_{q.b.to_local(q.a.position), q.b.orientation.conjugate() * q.a.orientation},
        turn_(pose_.orientation.toRotationMatrix()),
        tolerance_(on_surface * body.core.radius) {}

  const Vec3& centre() const { return pose_.position; }
  const TriangleMesh& mesh() const { return mesh_; }

  /// The closed form against the plane of t.
  void collide_plain(std::uint32_t t, std::vector<MeshPoint>& out) const {
    on_plane(t, mesh_.corners(t), normal_towards(mesh_, t, centre()), out, infinity, -infinity);
  }

  CoreNearMesh core() const { return {body_.core, sweep_, pose_, reach_, tolerance_}; }

  void collide(std::uint32_t t, std::vector<MeshPoint>& out, std::vector<BarredTriangle>& barred,
               ContactSink& sink) const {
    const auto tip = [&](const Vec3& d) -> Vec3 {
      return centre() + turn_ * body_.core.support(turn_.transpose() * d);
    };
    if (is_out_of_reach(mesh_, t, centre(), body_.core.radius, reach_ + sweep_, tip)) return;
    const auto corner = mesh_.corners(t);
    const Vec3 face_normal = normal_towards(mesh_, t, centre());
    const TriangleSolid solid(corner, mesh_.normals[t]);
    const CoreDistance d = measure(solid, corner, sink);
    if (!d.wanted) return;
    // Away from its sides a triangle knows no direction but its own: what else EPA says there is its own uncertainty.
    const bool is_face = d.normal.cross(face_normal).norm() <= along_face ||
                         projects_into(corner, mesh_.normals[t], d.on_mesh, -tolerance_);
    const Verdict verdict =
        is_face ? Verdict::flat : judge(mesh_, triangles_, t, d.on_mesh, d.normal, face_normal, tolerance_);
    if (verdict == Verdict::bent) {
      if (d.gap < sweep_) barred.push_back({t, d.on_mesh});
      return;
    }
    if (verdict == Verdict::free) {
      const double gap = d.gap - sweep_;
      out.push_back({d.on_mesh + 0.5 * gap * d.normal, d.normal, gap, mesh_feature(t, 1u << 24)});
      return;
    }
    const double nearest = d.gap > 0.0 ? d.gap - sweep_ - tolerance_ : -infinity;
    if (on_plane(t, corner, face_normal, out, tolerance_, nearest) || !is_face) return;
    // The triangle lies under the middle of a flat side, where the plane's own points do not reach: its point nearest
    // to the axis is surely under the side.
    const Vec3 deepest = centre() + turn_ * body_.core.support(turn_.transpose() * -face_normal);
    const double gap = face_normal.dot(deepest - corner[0]) - sweep_;
    const Vec3 on_mesh = nearest_on_triangle(centre(), corner).point;
    if (gap < reach_) out.push_back({on_mesh + 0.5 * gap * face_normal, face_normal, gap, mesh_feature(t, 2u << 24)});
  }

 private:
  CoreDistance measure(const TriangleSolid& solid, const std::array<Vec3, 3>& corner, ContactSink& sink) const {
    const MinkowskiDifference difference(body_.core, ConvexRef::to(solid), pose_, solid.pose());
    const GjkResult g = gjk(difference, {reach_ + sweep_ + 1e-12 * difference.size(), 1e-14, Vec3::Zero()});
    const auto to_mesh = [&](const Vec3& x) -> Vec3 { return centre() + turn_ * x; };
    if (g.status == GjkResult::Status::beyond) return {};
    if (g.status != GjkResult::Status::overlapping) {
      if (g.upper - g.lower > narrow_enough * difference.size()) sink.mark_degenerate();
      return {true, g.lower, -(turn_ * g.normal), to_mesh(g.witness_b)};
    }
    const Penetration p = epa(difference);
    if (p.upper - p.lower > narrow_enough * difference.size()) sink.mark_degenerate();
    const Vec3 normal = -(turn_ * p.normal), on_mesh = to_mesh(p.witness_b);
    // The depth is certain, the points are not: on facets without area EPA's weights lose all digits, and of
    // coplanar facets it may take one beside the origin. Then: the triangle's point nearest to the centre.
    const bool sound = nearest_on_triangle(on_mesh, corner).distance <= tolerance_ &&
                       (on_mesh - centre()).norm() <= body_.core.radius + tolerance_;
    return {true, -p.upper, normal, sound ? on_mesh : nearest_on_triangle(centre(), corner).point};
  }
  /// The closed form against the triangle's plane, those of its points that lie over the triangle or less than `beside`
  /// [m] off, and no nearer than `least` [m]: a body beside the triangle reaches behind its plane without touching it.
  bool on_plane(std::uint32_t t, const std::array<Vec3, 3>& corner, const Vec3& n, std::vector<MeshPoint>& out,
                double beside, double least) const {
    static thread_local ContactSet set;  // keeps its size
    set.clear();
    ContactSink sink(set);
    body_.collide(body_.shape, HalfSpace{n}, {pose_, {corner[0], Quat(1, 0, 0, 0)}, reach_, false, nullptr}, sink);
    bool any = false;
    for (std::size_t k = 0; k < set.size(); ++k) {
      const Vec3 x = centre() + set.arm[k];
      if (set.gap[k] < least || !projects_into(corner, mesh_.normals[t], x, beside)) continue;
      const auto name = static_cast<std::uint32_t>((set.feature[k] >> 44 & 3u) << 22 |
                                                   (set.feature[k] >> 22 & 0xffu) << 8 | (set.feature[k] & 0xffu));
      out.push_back({x, n, set.gap[k], mesh_feature(mesh_.flat_group[t], name)});
      any = true;
    }
    return any;
  }

  const CoreOnPlane& body_;
  double sweep_;
  const TriangleMesh& mesh_;
  std::span<const std::uint32_t> triangles_;
  double reach_;
  Pose pose_;  ///< of the body, in the mesh's axes
  Mat3 turn_;
  double tolerance_;
};

template <class BodyOnMesh>
void collide_all(const BodyOnMesh& body, std::span<const std::uint32_t> triangles, double size, double radius,
                 const PairQuery& q, ContactSink& sink) {
  static thread_local std::vector<MeshPoint> points;  // keep their size
  static thread_local std::vector<BarredTriangle> barred;
  static thread_local std::vector<char> spoke;
  points.clear(), barred.clear(), spoke.clear();
  if (all_plain(body.mesh(), triangles)) {
    body.collide_plain(triangles.front(), points);
  } else {
    for (const auto t : triangles) {
      const std::size_t before = points.size();
      body.collide(t, points, barred, sink);
      spoke.push_back(points.size() > before);
    }
    if (!barred.empty()) collide_ridges(body.core(), body.mesh(), triangles, spoke, barred, points, sink);
  }
  reduce(points, size);
  emit(points, body.centre(), radius, q, sink);
}

}  // namespace

void collide_polyhedron_triangles(const PolyhedronView& a, double sweep, double radius, const TriangleMesh& b,
                                  std::span<const std::uint32_t> triangles, const PairQuery& q, ContactSink& sink) {
  if (triangles.empty()) return;
  collide_all(PolyhedronOnMesh(a, sweep, b, triangles, q), triangles, a.radius, radius, q, sink);
}

void collide_core_triangles(const CoreOnPlane& a, double sweep, double radius, const TriangleMesh& b,
                            std::span<const std::uint32_t> triangles, const PairQuery& q, ContactSink& sink) {
  if (triangles.empty()) return;
  collide_all(CoreOnMesh(a, sweep, b, triangles, q), triangles, a.core.radius, radius, q, sink);
}

}  // namespace epafi
