#include "detection/narrow/mesh/mesh_pairs.h"

#include <algorithm>
#include <cmath>

#include "detection/narrow/gjk/gjk.h"

namespace epafi {
namespace {

constexpr double on_triangle = 1e-9;  // of the radius: what counts as lying on an edge or triangle; rounding is 1e-15
constexpr double one_spot = 0.86602540378443864676;  // cosine of 30 degrees
constexpr double sharp = 1e-6;  // [rad] an edge that bends less is no edge to the side of a capsule

/// A triangle near a sphere.
struct Touch {
  double distance;  ///< of the centre; < 0: the centre has gone through the triangle [m]
  std::uint32_t triangle;
  NearestOnTriangle nearest;
  Vec3 normal;            ///< from the mesh to the sphere
  bool left_out = false;  ///< the contact of a nearer face is also its own
};

/// Parameter in [0, 1] on the segment from a along u of its point nearest to the segment from b along v (Ericson
/// 2005, 5.1.9).
double nearest_of_segments(const Vec3& a, const Vec3& u, const Vec3& b, const Vec3& v) {
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), denominator = uu * vv - uv * uv;
  const double s = (uv * v.dot(a - b) - u.dot(a - b) * vv) / denominator;
  const Vec3 near = denominator > 1e-24 * uu * vv ? Vec3(a + std::clamp(s, 0.0, 1.0) * u) : Vec3(a + 0.5 * u);
  return nearest_on_segment(b + nearest_on_segment(near, b, b + v) * v, a, a + u);
}

/// A sphere of a body whose own centre may lie elsewhere (the end of a capsule), and the side between two.
class RoundOnMesh {
 public:
  RoundOnMesh(const TriangleMesh& mesh, std::span<const std::uint32_t> triangles, double radius, double reach)
      : mesh_(mesh),
        triangles_(triangles),
        radius_(radius),
        limit_(radius + reach),
        tolerance_(on_triangle * radius),
        springs_(!(reach > 0.0)) {}

  /// The contacts of the sphere at `centre` of a body whose centre is `inside`, as f(gap, normal, feature); local:
  /// distinguishes the spheres.
  template <class F>
  void collide(const Vec3& centre, const Vec3& inside, std::uint32_t local, const F& f) {
    find_touches(centre, inside);
    for (std::size_t i = 0; i < touches_.size(); ++i) {
      if (touches_[i].left_out || is_covered(i, inside)) continue;
      const Touch touch = settle(i, centre, inside);
      f(touch.distance - radius_, touch.normal, name(i, local));
    }
  }
  /// The inside of a capsule's axis from `from` along `axis` against the edges of the mesh.
  void collide_side(const Vec3& from, const Vec3& axis, std::vector<MeshPoint>& out) const {
    if (!(axis.squaredNorm() > 0.0)) return;
    for (const auto t : triangles_)
      for (std::uint32_t k = 0; k < 3; ++k)
        if (mesh_.edge_kinds[t][k] != EdgeKind::flat) collide_edge(t, k, from, axis, out);
  }

 private:
  void find_touches(const Vec3& centre, const Vec3& inside) {
    touches_.clear();
    for (const auto t : triangles_) {
      const auto [height, beyond] = over_triangle(mesh_, t, centre);
      const Vec3& front = mesh_.normals[t];
      const bool through = &centre != &inside && stands_between(mesh_, t, inside, centre, 0.0);
      if (through || (std::abs(height) < limit_ && beyond <= tolerance_)) {
        const double distance = through ? -std::abs(height) : std::abs(height);
        const Vec3 n = through ? normal_towards(mesh_, t, inside) : height < 0.0 ? Vec3(-front) : front;
        touches_.push_back({distance, t, {centre - height * front, std::abs(height), TrianglePart::face}, n});
        continue;
      }
      if (!(OverTriangle{height, beyond}.least_square() < limit_ * limit_)) continue;
      auto corner = mesh_.corners(t);
      for (Vec3& c : corner) c -= centre;
      const NearestOnTriangle near = nearest_on_triangle(Vec3::Zero(), corner, tolerance_);
      if (!(near.distance < limit_)) continue;
      const bool face = near.part == TrianglePart::face || !(near.distance > 0.0);
      const Vec3 n = face ? normal_towards(mesh_, t, centre) : Vec3(-near.point / near.distance);
      touches_.push_back({near.distance, t, {centre + near.point, near.distance, near.part}, n});
    }
    if (touches_.size() < 2) return;
    // at equal distance within rounding a face precedes its edge
    const auto is_before = [this](const Touch& a, const Touch& b) {
      const bool on_face = a.nearest.part == TrianglePart::face;
      if (on_face == (b.nearest.part == TrianglePart::face))
        return a.distance < b.distance || (a.distance == b.distance && a.triangle < b.triangle);
      return on_face ? a.distance - tolerance_ <= b.distance : a.distance < b.distance - tolerance_;
    };
    std::sort(touches_.begin(), touches_.end(), is_before);
  }
  /// Faces that smooth edges join to that of touch i are one smooth surface to the ball, which touches it once. Its
  /// overlap is the shortest way out of all their planes: y with n . y >= depth of each (the distance from a convex
  /// set, which turns continuously; Rockafellar and Wets 1998, 2.23). With n / depth as the point of a plane, y / |y|^2
  /// is the point of their hull that is nearest to the origin.
  Touch settle(std::size_t i, const Vec3& centre, const Vec3& inside) {
    Touch out = touches_[i];
    const double depth = radius_ - out.distance;
    Simplex nearest;
    nearest.count = 1;
    Vec3 place = nearest.vertex[0].y = out.normal;
    spot_.assign(1, out.normal);
    walls_.clear();
    for (std::size_t k = i + 1; k < touches_.size(); ++k) {
      Touch wall = touches_[k];
      const auto is_beside = [&](const Vec3& n) { return n.dot(wall.normal) > one_spot; };
      if (mesh_.face[wall.triangle] == mesh_.face[out.triangle] ||
          surface_of(wall.triangle) != surface_of(out.triangle) || std::ranges::none_of(spot_, is_beside))
        continue;
      spot_.push_back(wall.normal);
      const bool extended = extend(wall, centre, inside);
      const double cosine = wall.normal.dot(out.normal), deep = radius_ - wall.distance;
      if (!(cosine > 0.0)) continue;
      touches_[k].left_out = true;
      if (deep > std::max(0.0, cosine * depth) && (extended || !is_covered(k, inside)))
        walls_.push_back(depth / deep * wall.normal);
    }
    const auto is_nearer = [&](const Vec3& v, const Vec3& w) { return v.dot(place) < w.dot(place); };
    bool around = false;
    for (std::size_t rounds = 0; rounds < 4 * walls_.size() && !around; ++rounds) {
      const Vec3& wall = *std::min_element(walls_.begin(), walls_.end(), is_nearer);
      if (wall.dot(place) >= (1.0 - 1e-12) * place.squaredNorm()) break;
      nearest.vertex[static_cast<std::size_t>(nearest.count++)].y = wall;
      place = closest_to_origin(nearest, around);
      out.distance = radius_ - depth / place.norm();
      out.normal = place.normalized();
    }
    return out;
  }
  std::uint32_t surface_of(std::uint32_t t) const { return springs_ ? mesh_.around[t].smooth : mesh_.around[t].gentle; }
  /// Where the foot of the centre lies only beyond smooth concave edges of the triangle its plane goes on.
  bool extend(Touch& touch, const Vec3& centre, const Vec3& inside) const {
    const std::uint32_t t = touch.triangle;
    const Vec3 normal = normal_towards(mesh_, t, inside);
    const EdgeKind hollow = normal.dot(mesh_.normals[t]) > 0.0 ? EdgeKind::concave : EdgeKind::convex;
    const auto corner = mesh_.corners(t);
    for (std::size_t k = 0; k < 3; ++k) {
      const bool goes_on = mesh_.edge_kinds[t][k] == hollow && surface_of(mesh_.neighbours[t][k]) == surface_of(t);
      if (!goes_on && mesh_.inward[t][k].dot(centre - corner[k]) < -tolerance_) return false;
    }
    touch.distance = normal.dot(centre - corner[0]);
    touch.normal = normal;
    return true;
  }
  /// True if its nearest point is on or behind a triangle that is as close or closer (a plate thinner than the overlap
  /// is one wall), or behind a face that the centre has passed.
  bool is_covered(std::size_t i, const Vec3& inside) const {
    const Touch& touch = touches_[i];
    for (std::size_t j = 0; j < i; ++j) {
      const std::uint32_t other = touches_[j].triangle;
      if (lies_on(mesh_, other, touch.nearest.point, tolerance_)) return true;
      if (touches_[j].distance < 0.0 && mesh_.face[other] == mesh_.face[touch.triangle]) return true;
      if (stands_between(mesh_, other, inside, touch.nearest.point, tolerance_)) return true;
    }
    return false;
  }
  /// A contact on a face is named by it, an edge or vertex by the lowest triangle that holds the point.
  Feature name(std::size_t i, std::uint32_t local) const {
    const Touch* owner = &touches_[i];
    if (owner->nearest.part == TrianglePart::face) return mesh_feature(mesh_.face[owner->triangle], local << 3);
    for (const Touch& other : touches_) {
      if (other.triangle < owner->triangle && other.nearest.part != TrianglePart::face &&
          lies_on(mesh_, other.triangle, touches_[i].nearest.point, tolerance_))
        owner = &other;
    }
    return mesh_feature(owner->triangle, local << 3 | static_cast<std::uint32_t>(owner->nearest.part));
  }
  void collide_edge(std::uint32_t t, std::uint32_t k, const Vec3& from, const Vec3& axis,
                    std::vector<MeshPoint>& out) const {
    const auto corner = mesh_.corners(t);
    const Vec3 &a = corner[k], &b = corner[(k + 1) % 3];
    const double s = nearest_of_segments(from, axis, a, b - a);
    if (!(s > on_triangle && s < 1.0 - on_triangle)) return;  // the ends are spheres of their own
    const Vec3 centre = from + s * axis;
    const Vec3 point = a + nearest_on_segment(centre, a, b) * (b - a);
    const Vec3 d = centre - point;
    const double distance = d.norm();
    if (!(distance < limit_) || !(distance > 0.0)) return;
    const Vec3 n = d / distance;
    if (!supports(t, centre, point, n, distance)) return;
    const double gap = distance - radius_;
    const Vec3 position = centre - radius_ * n;
    const auto one = [&](const MeshPoint& p) {
      return (p.position - position).squaredNorm() <= tolerance_ * tolerance_;
    };
    if (std::any_of(out.begin(), out.end(), one)) return;  // the same edge or vertex from a lower triangle
    out.push_back({position, n, gap, mesh_feature(t, 2u << 3 | (1 + k))});
  }
  /// No triangle at the point comes closer to the axis, and the surface bends away there or ends.
  bool supports(std::uint32_t own, const Vec3& centre, const Vec3& point, const Vec3& n, double distance) const {
    bool bends = false, ends = true;
    for (const auto t : triangles_) {
      if (!lies_on(mesh_, t, point, tolerance_)) continue;
      if (nearest_on_triangle(centre, mesh_.corners(t)).distance < distance - tolerance_) return false;
      bends = bends || n.cross(mesh_.normals[t]).squaredNorm() > sharp * sharp;
      ends = ends && t == own;
    }
    return bends || ends;
  }

  const TriangleMesh& mesh_;
  std::span<const std::uint32_t> triangles_;
  double radius_, limit_, tolerance_;
  bool springs_;
  // they keep their sizes: no allocation once the most were seen
  std::vector<Touch>& touches_ = room<Touch, 0>();
  std::vector<Vec3>&spot_ = room<Vec3, 0>(), &walls_ = room<Vec3, 1>();  ///< of one contact: normals, points of planes
  template <class T, int>
  static std::vector<T>& room() {
    static thread_local std::vector<T> kept;
    return kept;
  }
};

/// Of points of the ends and the side of a short capsule on one spot the deepest remains, with a name of both ends.
void keep_deepest(std::vector<MeshPoint>& points) {
  std::ranges::sort(points, [](const MeshPoint& p, const MeshPoint& q) {
    return p.gap < q.gap || (p.gap == q.gap && p.feature < q.feature);
  });
  const auto part = [](const MeshPoint& p) { return p.feature >> 3 & 3; };
  std::size_t kept = 0;
  for (const MeshPoint& p : points) {
    const auto stands_for = [&](const MeshPoint& q) { return part(q) != part(p) && q.normal.dot(p.normal) > one_spot; };
    if (std::none_of(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(kept), stands_for))
      points[kept++] = p;
  }
  points.resize(kept);
  for (MeshPoint& p : points) {
    const Feature shared = p.feature & ~mesh_feature(0, 1u << 3);
    const auto has_it = [&](const MeshPoint& q) { return q.feature == shared; };
    if (std::ranges::none_of(points, has_it)) p.feature = shared;
  }
}

}  // namespace

void collide_triangles(const Sphere& a, const TriangleMesh& b, std::span<const std::uint32_t> triangles,
                       const PairQuery& q, ContactSink& sink) {
  const Vec3 centre = q.b.to_local(q.a.position);
  RoundOnMesh(b, triangles, a.radius, q.reach)
      .collide(centre, centre, 0, [&](double gap, const Vec3& normal, Feature feature) {
        const Vec3 n = -(q.b.orientation * normal);
        sink.add({gap, n, a.radius * n, q.curvature ? a.radius : 0.0, feature});
      });
}

void collide_triangles(const Capsule& a, const TriangleMesh& b, std::span<const std::uint32_t> triangles,
                       const PairQuery& q, ContactSink& sink) {
  static thread_local std::vector<MeshPoint> points;
  points.clear();
  const Vec3 centre = q.b.to_local(q.a.position);
  const Vec3 half = q.b.orientation.conjugate() * (q.a.orientation * Vec3(0, 0, a.half_length()));
  const Vec3 low = centre - half, high = centre + half;
  RoundOnMesh round(b, triangles, a.radius, q.reach);
  const auto collide_end = [&](const Vec3& end, std::uint32_t local) {
    round.collide(end, centre, local, [&](double gap, const Vec3& normal, Feature feature) {
      points.push_back({end - a.radius * normal, normal, gap, feature});
    });
  };
  collide_end(low, 0);
  if (a.length > 0.0) collide_end(high, 1);
  round.collide_side(low, 2.0 * half, points);
  if (a.is_short()) keep_deepest(points);
  emit(
      points, centre, [&](const Vec3&) { return a.radius; }, q, sink);
}

}  // namespace epafi
