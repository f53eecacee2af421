#include <algorithm>
#include <cmath>

#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/mesh/mesh_pairs.h"
#include "detection/narrow/mesh/mesh_region.h"
#include "detection/narrow/mesh/triangle_solid.h"
#include "detection/narrow/pairs/flat_patch.h"
#include "detection/narrow/pairs/side_clip.h"

namespace epafi {
namespace {

constexpr double on_surface = 1e-6;  // of the size, as in the manifold: what counts as lying on an edge or triangle
constexpr double along_face = 1e-5;  // [rad]
constexpr double same_edge_cosine = 0.7;  // directions nearer than 45 degrees at one point of the surface are one
constexpr double narrow_enough = 1e-6;    // of the size: a wider interval than this is reported as degenerate

/// True if all triangles are inside one face, so that the body is on a plane. (If the face ended below the body, one of
/// them would have an open or bent side.) A box on 30 triangles then takes 0.2 us (perf/mesh.cpp).
bool all_plain(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles) {
  return std::all_of(triangles.begin(), triangles.end(), [&](std::uint32_t t) {
    const auto& kinds = mesh.edge_kinds[t];
    return mesh.face[t] == mesh.face[triangles.front()] &&
           std::all_of(kinds.begin(), kinds.end(), [](EdgeKind k) { return k == EdgeKind::flat; });
  });
}

/// The face most opposed to n (body axes) around the extreme vertex along -n.
std::uint32_t face_against(const PolyhedronView& p, const Vec3& n) {
  const std::uint32_t v = ConvexHull::support_vertex(p, -n);
  std::uint32_t best = p.fans[p.fan_begin[v]];
  for (std::uint32_t k = p.fan_begin[v] + 1; k < p.fan_begin[v + 1]; ++k)
    if (p.face_normals[p.fans[k]].dot(n) < p.face_normals[best].dot(n)) best = p.fans[k];
  return best;
}

/// The contacts of a body with a plane as if it were a half-space, as f(point, gap, feature of the closed form).
template <class Collide, class F>
void points_on_plane(const PlacedCore& b, const Vec3& n, const Vec3& point, const Collide& collide, const F& f) {
  static thread_local ContactSet set;  // keeps its size
  set.clear();
  ContactSink sink(set);
  collide(HalfSpace{n}, PairQuery{b.pose, {point, Quat(1, 0, 0, 0)}, b.reach, false, nullptr}, sink);
  for (std::size_t k = 0; k < set.size(); ++k) f(Vec3(b.pose.position + set.arm[k]), set.gap[k], set.feature[k]);
}

/// The face of a polyhedron towards a plane.
class PolyhedronSide {
 public:
  explicit PolyhedronSide(const PolyhedronView& body) : body_(body) {}
  ConvexRef core() const { return core_of(body_); }
  /// In the body's axes; n: unit, against which it is turned.
  void towards(const Vec3& n, std::vector<SidePoint>& out) const {
    const std::uint32_t face = face_against(body_, n);
    for (std::uint32_t k = body_.face_begin[face]; k < body_.face_begin[face + 1]; ++k)
      out.push_back({body_.vertices[body_.face_vertices[k]], body_.face_vertices[k], 0});
  }
  /// All vertices below the plane: with those of one face, a deep vertex would be lost when the face changes.
  template <class F>
  void on_plane(const PlacedCore& b, const Vec3& n, const Vec3& point, const F& f) const {
    const auto collide = [&](const HalfSpace& plane, const PairQuery& q, ContactSink& sink) {
      collide_with_plane(body_, b.sweep, 0.0, plane, q, sink);
    };
    points_on_plane(b, n, point, collide, [&](const Vec3& x, double gap, Feature name) {
      f(x, gap, local_name(FeatureKind::vertex_a, feature_vertex_a(name), 0));
    });
  }
  /// Its corners on faces that look against n, as f(corner), mesh axes.
  template <class F>
  void corners_towards(const PlacedCore& b, const Vec3& n, const F& f) const {
    const Vec3 local = b.turn.transpose() * n;
    for (std::uint32_t v = 0; v < body_.vertices.size(); ++v) {
      bool looks = false;
      for (std::uint32_t k = body_.fan_begin[v]; k < body_.fan_begin[v + 1] && !looks; ++k)
        looks = body_.face_normals[body_.fans[k]].dot(local) < -facing_cosine;
      if (looks) f(SidePoint{b.pose.position + b.turn * body_.vertices[v], v, 0});
    }
  }
  /// The points of an edge or corner of the region, along n: those of the triangles that reach as far.
  template <class F>
  void at_edge(const PlacedCore& b, const MeshRegion& region, const WayOut& way, const F& add) const {
    for (const std::uint32_t t : region.triangles) {
      const auto corner = b.mesh->corners(t);
      const auto reaches = [&](const Vec3& c) { return way.normal.dot(c - way.on_mesh) > -b.tolerance; };
      if (std::none_of(corner.begin(), corner.end(), reaches)) continue;
      const TriangleSolid solid(corner, b.mesh->normals[t]);
      const PolyhedronPair pair(body_, solid.view(), b.pose, solid.pose());
      PolyhedronDistance d;
      const Vec3 n = -(b.turn.transpose() * way.normal);
      const Vec3 on_mesh = b.turn.transpose() * (way.on_mesh - b.pose.position);
      d.axis.kind = SeparatingAxis::Kind::points;
      d.axis.gap = way.gap;
      d.axis.normal = n;
      d.witness_a = on_mesh - way.gap * n;
      d.witness_b = on_mesh;
      const Patch patch = contact_patch(pair, d, b.reach, b.sweep, 0.0);
      for (int k = 0; k < patch.count; ++k) {
        const PatchPoint& p = patch.point[static_cast<std::size_t>(k)];
        const std::uint32_t name =
            local_name(feature_kind(p.feature), feature_vertex_a(p.feature), feature_vertex_b(p.feature));
        add(b.pose.position + b.turn * p.position, p.gap, t, name);
      }
    }
  }

 private:
  const PolyhedronView& body_;
};

/// The flat side, if any, of a smooth body towards a plane.
class CoreSide {
 public:
  explicit CoreSide(const CoreOnPlane& body) : body_(body) {}
  const ConvexRef& core() const { return body_.core; }
  void towards(const Vec3& n, std::vector<SidePoint>& out) const {
    if (!body_.facing) return;
    const FlatSide side = body_.facing(body_.shape, -n);
    for (int k = 0; k < side.count; ++k)
      out.push_back({side.corner[static_cast<std::size_t>(k)], static_cast<std::uint32_t>(k), 0});
  }
  template <class F>
  void at_edge(const PlacedCore& b, const MeshRegion& region, const WayOut& way, const F& add) const {
    const Mat3 to_body = b.turn.transpose();
    const Vec3 n = -(to_body * way.normal);
    const double gap = way.gap - b.sweep;
    FlatPair pair{{}, {}, b.core.radius, b.sweep, 0.0};
    if (body_.facing) pair.a = body_.facing(body_.shape, n);
    std::uint32_t owner = region.triangles.front();
    for (const std::uint32_t t : region.triangles)
      for (const Vec3& c : b.mesh->corners(t)) {
        if (!(way.normal.dot(c - way.on_mesh) > -b.tolerance)) continue;
        owner = t;
        const Vec3 x = to_body * (c - b.pose.position);
        const auto one = [&](const Vec3& o) { return (o - x).squaredNorm() <= b.tolerance * b.tolerance; };
        const auto end = pair.b.corner.begin() + pair.b.count;
        if (pair.b.count < 3 && std::none_of(pair.b.corner.begin(), end, one))
          pair.b.corner[static_cast<std::size_t>(pair.b.count++)] = x;
      }
    if (pair.b.count != 2) pair.b.count = 0;  // a corner, or a plane that was not meant
    const Vec3 middle = to_body * (way.on_mesh - b.pose.position) - 0.5 * gap * n;
    const Patch patch = flat_patch(pair, {middle, n, gap}, b.reach);
    for (int k = 0; k < patch.count; ++k) {
      const PatchPoint& p = patch.point[static_cast<std::size_t>(k)];
      add(b.pose.position + b.turn * p.position, p.gap, owner,
          local_name(feature_kind(p.feature), feature_vertex_a(p.feature) << 8 | feature_vertex_b(p.feature), 0));
    }
  }

  /// The closed form against the plane of t, as f(point, gap, name).
  template <class F>
  void on_plane(const PlacedCore& b, const Vec3& n, const Vec3& point, const F& f) const {
    const auto collide = [&](const HalfSpace& plane, const PairQuery& q, ContactSink& sink) {
      body_.collide(body_.shape, plane, q, sink);
    };
    points_on_plane(b, n, point, collide, [&](const Vec3& x, double gap, Feature name) {
      f(x, gap, static_cast<std::uint32_t>((name >> 44 & 3u) << 20 | (name >> 22 & 0xffu) << 8 | (name & 0xffu)));
    });
  }

 private:
  const CoreOnPlane& body_;
};

/// One convex body against the convex regions of a surface.
template <class Side>
class ConvexOnMesh {
 public:
  ConvexOnMesh(const Side& side, const PlacedCore& body, std::span<const std::uint32_t> triangles,
               std::vector<MeshPoint>& out, ContactSink& sink)
      : side_(side), b_(body), mesh_(*body.mesh), triangles_(triangles), out_(out), sink_(sink) {}

  void collide() {
    if (!find_near()) return;
    const std::uint32_t first = triangles_.front();
    if (all_plain(mesh_, triangles_))
      return on_face(first, normal_towards(mesh_, first, b_.pose.position), {}, Face::plain);
    find_sides(mesh_, triangles_, b_.pose.position, fronts_);
    spoken_.assign(triangles_.size(), false);
    solved_.clear();
    solved_triangles_.clear();
    for (const std::uint32_t t : near_) {
      if (spoken_[place_of(triangles_, t)]) continue;
      gather_region(b_, triangles_, t, sees_front(t), region_);
      for (const std::uint32_t member : region_.triangles) spoken_[place_of(triangles_, member)] = true;
      solve();
    }
  }

 private:
  /// A region with contacts.
  struct Solved {
    WayOut way;
    std::ptrdiff_t begin, end;  ///< of its triangles
  };

  /// Replaces the candidates by the triangles near the body (of a plane by the first one), with their neighbours where
  /// the surface bends, since the way out may end at a face beyond a blunt edge. Returns false if there are none.
  bool find_near() {
    const bool plain = all_plain(mesh_, triangles_);
    near_.clear();
    for (const std::uint32_t t : triangles_) {
      if (!is_near(b_, t)) continue;
      near_.push_back(t);
      if (plain) break;
    }
    around_ = near_;
    if (!all_plain(mesh_, near_)) {
      for (const std::uint32_t t : near_)
        for (std::size_t side = 0; side < 3; ++side)
          if (mesh_.edge_kinds[t][side] != EdgeKind::open) around_.push_back(mesh_.neighbours[t][side]);
      std::sort(around_.begin(), around_.end());
      around_.erase(std::unique(around_.begin(), around_.end()), around_.end());
    }
    triangles_ = around_;
    return !near_.empty();
  }
  bool sees_front(std::uint32_t t) const { return fronts_[place_of(triangles_, t)]; }
  Vec3 normal_of(std::uint32_t t) const { return sees_front(t) ? mesh_.normals[t] : Vec3(-mesh_.normals[t]); }

  /// The shortest way out of the region; along the normal of a face if this is as short within the tolerance.
  void solve() {
    WayOut way = find_way_out(b_, region_);
    if (way.uncertainty > narrow_enough * std::max(b_.core.radius, region_.radius)) sink_.mark_degenerate();
    if (!(way.gap - b_.sweep < b_.reach) || !is_on_surface(way.on_mesh)) return;
    const RegionPlane& best = best_plane();
    // a plane within 1e-5 rad of the way out is used instead
    const bool along = way.normal.cross(best.normal).squaredNorm() <= along_face * along_face;
    const double slack = along ? b_.tolerance : 1e-3 * b_.tolerance + 1e-12 * region_.radius;
    const std::size_t before = out_.size();
    const bool bent = best.gap < way.gap - slack;
    bool leans = bent;
    if (bent)
      side_.at_edge(b_, region_, way, [&](const Vec3& x, double gap, std::uint32_t t, std::uint32_t name) {
        out_.push_back({x, way.normal, std::max(gap, way.gap - b_.sweep), mesh_feature(t, name)});
        leans = leans && leans_on_others(way, x - 0.5 * gap * way.normal);
      });
    if (leans) leans = leans_on_others(way, way.on_mesh);
    if (!bent || leans) {
      out_.resize(before);
      on_face(best.triangle, best.normal, region_.triangles, leans ? Face::leaning : Face::bent);
      way = {best.gap, best.normal, way.on_mesh, 0.0};
    } else if (is_known(way)) {
      return out_.resize(before);
    }
    if (!leans) hold_deepest(way, before);
    if (out_.size() == before) return;
    const auto begin = static_cast<std::ptrdiff_t>(solved_triangles_.size());
    solved_triangles_.insert(solved_triangles_.end(), region_.triangles.begin(), region_.triangles.end());
    solved_.push_back({way, begin, static_cast<std::ptrdiff_t>(solved_triangles_.size())});
  }

  /// If the deepest point of the body is beyond a rim, or between the corners of a round end, the nearest point of the
  /// region is the contact.
  void hold_deepest(const WayOut& way, std::size_t before) {
    const double gap = way.gap - b_.sweep;
    const auto holds = [&](const MeshPoint& p) { return p.gap <= gap + b_.tolerance; };
    if (std::any_of(out_.begin() + static_cast<std::ptrdiff_t>(before), out_.end(), holds)) return;
    NearestOnTriangle nearest{Vec3::Zero(), infinity, TrianglePart::face};
    for (const std::uint32_t t : region_.triangles) {
      const NearestOnTriangle here = nearest_on_triangle(way.on_mesh, mesh_.corners(t));
      if (here.distance < nearest.distance) nearest = here;
    }
    if (is_hidden(nearest.point, way.normal)) return;
    out_.push_back({nearest.point + 0.5 * gap * way.normal, way.normal, gap,
                    mesh_feature(region_.first, local_name(FeatureKind::single, region_.front, 0))});
  }

  /// True if another triangle is between the point and the body: the far side of a plate thinner than the overlap.
  bool is_hidden(const Vec3& point, const Vec3& n) const {
    const Vec3 way = n * n.dot(b_.pose.position - point);
    for (const std::uint32_t t : triangles_) {
      const Vec3& on_plane = mesh_.vertices[mesh_.triangles[t][0]];
      const double h0 = mesh_.normals[t].dot(point - on_plane), h1 = mesh_.normals[t].dot(point + way - on_plane);
      if (!(h0 * h1 < 0.0) || std::abs(h0) <= b_.tolerance) continue;
      if (over_triangle(mesh_, t, point + h0 / (h0 - h1) * way).beyond <= b_.tolerance) return true;
    }
    return false;
  }

  /// True for walls around a notch, seen from behind: they bend away from each other, but enclose nothing.
  bool is_on_surface(const Vec3& x) const {
    return std::any_of(triangles_.begin(), triangles_.end(),
                       [&](std::uint32_t t) { return lies_on(mesh_, t, x, 10.0 * b_.tolerance); });
  }
  const RegionPlane& best_plane() {
    for (RegionPlane& p : region_.planes) p.gap = p.normal.dot(b_.tip(-p.normal) - p.point);
    return *std::max_element(region_.planes.begin(), region_.planes.end(),
                             [](const RegionPlane& a, const RegionPlane& b) { return a.gap < b.gap; });
  }
  /// True if a triangle at x outside the region extends along the way out, so that the body would move into it or along
  /// the surface: a concave or an inner edge.
  bool leans_on_others(const WayOut& way, const Vec3& x) const {
    const auto& own = region_.triangles;
    for (const std::uint32_t t : triangles_) {
      if (std::binary_search(own.begin(), own.end(), t) || !lies_on(mesh_, t, x, 10.0 * b_.tolerance)) continue;
      const Vec3 n = normal_of(t);
      const auto goes_on = [&](const RegionPlane& p) {
        return n.dot(p.normal) > 0.5 && std::abs(p.normal.dot(x - p.point)) <= b_.tolerance;
      };
      const auto& planes = region_.planes;
      if (n.dot(way.normal) > -0.01 && std::none_of(planes.begin(), planes.end(), goes_on)) continue;
      for (const Vec3& c : mesh_.corners(t)) {
        const Vec3 w = c - x;  // flat within 1e-6 rad is not reaching out
        if (way.normal.dot(w) > 1e-3 * b_.tolerance + 1e-6 * w.norm()) return true;
      }
    }
    return false;
  }
  /// True if another region that contains the point is as deep there.
  bool is_known(const WayOut& way) const {
    return std::any_of(solved_.begin(), solved_.end(), [&](const Solved& s) {
      const auto first = solved_triangles_.begin();
      return s.way.gap <= way.gap + b_.tolerance && s.way.normal.dot(way.normal) > same_edge_cosine &&
             std::any_of(first + s.begin, first + s.end,
                         [&](std::uint32_t t) { return lies_on(mesh_, t, way.on_mesh, b_.tolerance); });
    });
  }

  /// Whether the body sees a plane; a face whose region lets it out sooner, but onto others, or a face with edges.
  enum class Face { plain, leaning, bent };
  /// The points on the plane of t, towards n: those over its face.
  void on_face(std::uint32_t t, const Vec3& n, const std::vector<std::uint32_t>& members, Face kind) {
    const Vec3 point = mesh_.vertices[mesh_.triangles[t][0]];
    const std::size_t before = out_.size();
    if (kind == Face::plain) {
      side_.on_plane(b_, n, point, [&](const Vec3& x, double gap, std::uint32_t name) {
        out_.push_back({x, n, gap, mesh_feature(mesh_.face[t], name)});
      });
      return;
    }
    if constexpr (std::is_same_v<Side, CoreSide>) {
      bool all = true;
      side_.on_plane(b_, n, point, [&](const Vec3& x, double gap, std::uint32_t name) {
        if (is_over(members, t, x) && came_through(t, n, x + (0.5 * gap) * n))
          out_.push_back({x, n, gap, mesh_feature(mesh_.face[t], name)});
        else
          all = false;
      });
      if (all) return;
      const Vec3 tip = b_.tip(-n);
      side_points(n);
      if (side_points_.size() < 2) return;
      out_.resize(before);
      if (is_over(members, t, tip) && came_through(t, n, tip)) add(t, n, point, {tip, 0x3ffffu, 0}, 0);
    }
    if constexpr (std::is_same_v<Side, PolyhedronSide>)
      side_.corners_towards(b_, n, [&](const SidePoint& p) {
        if (is_over(members, t, p.x) && came_through(t, n, p.x)) add(t, n, point, p, 0);
      });
    for (const std::uint32_t member : members) {
      if (mesh_.face[member] != mesh_.face[t]) continue;
      side_points(n);
      const Triangle& corner = mesh_.triangles[member];
      clip_side([&](std::uint32_t k) -> const Vec3& { return mesh_.vertices[corner[k]]; }, 3, mesh_.normals[member],
                b_.tolerance, side_points_);
      for (const SidePoint& p : side_points_) {
        if (std::is_same_v<Side, PolyhedronSide> && p.cut == 0) continue;  // a corner of the body
        const Cut cut = p.cut == 0 ? Cut::none : cut_at(member, region_.front, p.x);
        if (cut == Cut::inside) continue;
        if ((cut == Cut::rim && kind == Face::bent) || came_through(member, n, p.x)) add(member, n, point, p, p.cut);
      }
    }
  }
  /// Where a side of the body was cut: inside the face (no corner of what they share), at its rim, at a concave edge.
  enum class Cut { none, inside, rim, concave };
  Cut cut_at(std::uint32_t t, bool front, const Vec3& x) const {
    Cut cut = Cut::inside;
    const auto corner = mesh_.corners(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const EdgeKind kind = mesh_.edge_kinds[t][k];
      if (kind == EdgeKind::flat || std::abs(mesh_.inward[t][k].dot(x - corner[k])) > 2.0 * b_.tolerance) continue;
      if (kind != (front ? EdgeKind::concave : EdgeKind::convex)) return Cut::rim;
      cut = Cut::concave;
    }
    return cut;
  }
  void side_points(const Vec3& n) {
    side_points_.clear();
    side_.towards(b_.turn.transpose() * n, side_points_);
    for (SidePoint& p : side_points_) p.x = b_.pose.position + b_.turn * p.x;
  }
  void add(std::uint32_t t, const Vec3& n, const Vec3& point, const SidePoint& p, std::uint32_t cut) {
    const double gap = n.dot(p.x - point) - b_.sweep;
    if (!(gap < b_.reach)) return;
    const std::uint32_t name = local_name(cut == 0 ? FeatureKind::vertex_a : FeatureKind::edges, p.corner, cut);
    out_.push_back({p.x - (b_.sweep + 0.5 * gap) * n, n, gap, mesh_feature(cut == 0 ? mesh_.face[t] : t, name)});
  }
  bool is_over(const std::vector<std::uint32_t>& members, std::uint32_t face, const Vec3& x) const {
    return std::any_of(members.begin(), members.end(), [&](std::uint32_t t) {
      return mesh_.face[t] == mesh_.face[face] && over_triangle(mesh_, t, x).beyond <= b_.tolerance;
    });
  }
  /// True if the body has reached x, behind the face of t, through that face first. Otherwise x belongs to the surface
  /// beyond an edge: a corner of a box on a table is also behind the table's side.
  bool came_through(std::uint32_t face, const Vec3& n, const Vec3& x) const {
    const Vec3& point = mesh_.vertices[mesh_.triangles[face][0]];
    const Vec3& centre = b_.pose.position;
    const double from = n.dot(centre - point), to = n.dot(x - point);
    if (!(to < -b_.tolerance)) return true;
    const double when = from / (from - to);
    const Vec3 gate = centre + when * (x - centre);
    bool through = false;
    for (const std::uint32_t t : triangles_) {
      if (mesh_.face[t] == mesh_.face[face]) {
        through = through || over_triangle(mesh_, t, gate).beyond <= b_.tolerance;
        continue;
      }
      const Vec3 on_plane = mesh_.vertices[mesh_.triangles[t][0]];
      const double h0 = mesh_.normals[t].dot(centre - on_plane), h1 = mesh_.normals[t].dot(x - on_plane);
      if (!(h0 * h1 < 0.0) || !(h0 / (h0 - h1) < when)) continue;
      if (over_triangle(mesh_, t, centre + h0 / (h0 - h1) * (x - centre)).beyond <= 0.0) return false;
    }
    return through;
  }

  struct Room {  // keeps its size: no allocation once the largest contact was seen
    std::vector<std::uint32_t> near, around;
    std::vector<unsigned char> spoken, fronts;
    std::vector<Solved> solved;
    std::vector<std::uint32_t> solved_triangles;
    std::vector<SidePoint> side_points;
    MeshRegion region;
  };
  static Room& room() {
    static thread_local Room r;
    return r;
  }
  const Side& side_;
  const PlacedCore& b_;
  const TriangleMesh& mesh_;
  std::span<const std::uint32_t> triangles_;
  std::vector<MeshPoint>& out_;
  ContactSink& sink_;
  std::vector<std::uint32_t>& near_ = room().near;
  std::vector<std::uint32_t>& around_ = room().around;
  std::vector<unsigned char>& spoken_ = room().spoken;  ///< by place: the triangle is in a region
  std::vector<unsigned char>& fronts_ = room().fronts;  ///< by place: the body is on the front of the surface there
  std::vector<Solved>& solved_ = room().solved;
  std::vector<std::uint32_t>& solved_triangles_ = room().solved_triangles;
  std::vector<SidePoint>& side_points_ = room().side_points;
  MeshRegion& region_ = room().region;
};

template <class Side>
void collide_all(const Side& side, double sweep, double radius, const TriangleMesh& mesh,
                 std::span<const std::uint32_t> triangles, const PairQuery& q, ContactSink& sink) {
  static thread_local std::vector<MeshPoint> points;  // keeps its size
  points.clear();
  const Pose pose{q.b.to_local(q.a.position), q.b.orientation.conjugate() * q.a.orientation};
  const ConvexRef core = side.core();
  const PlacedCore body{core, sweep, pose, pose.orientation.toRotationMatrix(), q.reach, on_surface * core.radius,
                        &mesh};
  ConvexOnMesh<Side>(side, body, triangles, points, sink).collide();
  reduce(points, core.radius, !(q.reach > 0.0));
  emit(points, pose.position, radius, q, sink);
}

}  // namespace

void collide_polyhedron_triangles(const PolyhedronView& a, double sweep, double radius, const TriangleMesh& b,
                                  std::span<const std::uint32_t> triangles, const PairQuery& q, ContactSink& sink) {
  if (!triangles.empty()) collide_all(PolyhedronSide(a), sweep, radius, b, triangles, q, sink);
}

void collide_core_triangles(const CoreOnPlane& a, double sweep, double radius, const TriangleMesh& b,
                            std::span<const std::uint32_t> triangles, const PairQuery& q, ContactSink& sink) {
  if (!triangles.empty()) collide_all(CoreSide(a), sweep, radius, b, triangles, q, sink);
}

}  // namespace epafi
