#include "detection/narrow/mesh/mesh_pairs.h"

#include <algorithm>
#include <cmath>

namespace epafi {
namespace {

constexpr double on_triangle = 1e-9;  // of the radius: what counts as lying on an edge or triangle; rounding is 1e-15

/// A triangle near the ball.
struct Touch {
  NearestOnTriangle nearest;  ///< to the centre
  std::uint32_t triangle;
  Vec3 normal;            ///< from the mesh to the ball
  bool left_out = false;  ///< the contact of a nearer face is also its own
};

/// One ball, its centre in the mesh's axes.
class BallOnMesh {
 public:
  BallOnMesh(const TriangleMesh& mesh, const Vec3& centre, double radius, double reach)
      : mesh_(mesh),
        centre_(centre),
        radius_(radius),
        limit_(radius + reach),
        tolerance_(std::max(on_triangle * radius, mesh.joined.unevenness)),
        springs_(!(reach > 0.0)) {}

  /// Its contacts as f(touch, feature).
  template <class F>
  void collide(std::span<const std::uint32_t> triangles, const F& f) {
    find_touches(triangles);
    for (std::size_t i = 0; i < touches_.size(); ++i) {
      if (touches_[i].left_out || is_covered(i)) continue;
      f(settle(i), name(i));
    }
  }

 private:
  void find_touches(std::span<const std::uint32_t> triangles) {
    touches_.clear();
    for (const auto t : triangles) {
      const auto [height, beyond] = over_triangle(mesh_, t, centre_);
      const Vec3& front = mesh_.normals[t];
      if (std::abs(height) < limit_ && beyond <= tolerance_) {
        const Vec3 n = height < 0.0 ? Vec3(-front) : front;
        touches_.push_back({{centre_ - height * front, std::abs(height), TrianglePart::face}, t, n});
        continue;
      }
      if (!(OverTriangle{height, beyond}.least_square() < limit_ * limit_)) continue;
      auto corner = mesh_.corners(t);
      for (Vec3& c : corner) c -= centre_;
      const NearestOnTriangle near = nearest_on_triangle(Vec3::Zero(), corner, tolerance_);
      if (!(near.distance < limit_)) continue;
      const bool face = near.part == TrianglePart::face || !(near.distance > 0.0);
      const Vec3 n = face ? normal_towards(mesh_, t, centre_) : Vec3(-near.point / near.distance);
      touches_.push_back({{centre_ + near.point, near.distance, near.part}, t, n});
    }
    if (touches_.size() < 2) return;
    // at equal distance within rounding a face precedes its edge
    const auto is_before = [this](const Touch& a, const Touch& b) {
      const bool on_face = a.nearest.part == TrianglePart::face;
      const double da = a.nearest.distance, db = b.nearest.distance;
      if (on_face == (b.nearest.part == TrianglePart::face)) return da < db || (da == db && a.triangle < b.triangle);
      return on_face ? da - tolerance_ <= db : da < db - tolerance_;
    };
    std::sort(touches_.begin(), touches_.end(), is_before);
  }
  /// Faces that smooth edges join to that of touch i are one smooth surface to the ball, which touches it once: out of
  /// all their planes.
  Touch settle(std::size_t i) {
    Touch out = touches_[i];
    const double depth = radius_ - out.nearest.distance;
    spot_.assign(1, out.normal);
    walls_.clear();
    for (std::size_t k = i + 1; k < touches_.size(); ++k) {
      Touch wall = touches_[k];
      const auto is_beside = [&](const Vec3& n) { return n.dot(wall.normal) > one_spot; };
      const bool of_face = mesh_.face[wall.triangle] == mesh_.face[out.triangle];
      if (of_face && is_over_face(wall) && is_over_face(out)) touches_[k].left_out = true;
      if (of_face || smooth_around(mesh_, wall.triangle, springs_) != smooth_around(mesh_, out.triangle, springs_) ||
          std::ranges::none_of(spot_, is_beside))
        continue;
      spot_.push_back(wall.normal);
      const bool extended = goes_on(out) && goes_on(wall);
      if (extended) wall = on_plane_of(wall.triangle);
      const double cosine = wall.normal.dot(out.normal), deep = radius_ - wall.nearest.distance;
      if (!(cosine > 0.0)) continue;
      touches_[k].left_out = true;
      if (deep > std::max(0.0, cosine * depth) && (extended || !is_covered(k)))
        walls_.push_back(depth / deep * wall.normal);
    }
    if (walls_.empty()) return out;
    const Vec3 place = nearest_of_hull(out.normal, walls_);
    out.nearest.distance = radius_ - depth / place.norm();
    out.normal = place.normalized();
    return out;
  }
  Touch on_plane_of(std::uint32_t t) const {
    const Vec3 normal = normal_towards(mesh_, t, centre_);
    return {{centre_, normal.dot(centre_ - mesh_.corners(t)[0])}, t, normal};
  }
  /// The ball is over the triangle or the hollow that it is a side of; not so beyond the edge of a blade, behind one of
  /// its sides.
  bool goes_on(const Touch& touch) const {
    const Vec3 normal = normal_towards(mesh_, touch.triangle, centre_);
    return goes_on_to(mesh_, touch.triangle, normal, centre_, springs_, tolerance_);
  }
  static bool is_over_face(const Touch& touch) { return touch.nearest.part == TrianglePart::face; }
  /// True if its nearest point is on or behind a triangle that is as close or closer: a plate thinner than the overlap
  /// is one wall.
  bool is_covered(std::size_t i) const {
    const Vec3& point = touches_[i].nearest.point;
    const auto covers = [&](const Touch& other) {
      return lies_on(mesh_, other.triangle, point, tolerance_) ||
             stands_between(mesh_, other.triangle, centre_, point, tolerance_);
    };
    return std::any_of(touches_.begin(), touches_.begin() + static_cast<std::ptrdiff_t>(i), covers);
  }
  /// A contact on a face is named by it, an edge or vertex by the lowest triangle that holds the point.
  Feature name(std::size_t i) const {
    const Touch* owner = &touches_[i];
    if (owner->nearest.part == TrianglePart::face) return mesh_feature(mesh_.face[owner->triangle], 0);
    for (const Touch& other : touches_) {
      if (other.triangle < owner->triangle && other.nearest.part != TrianglePart::face &&
          lies_on(mesh_, other.triangle, touches_[i].nearest.point, tolerance_))
        owner = &other;
    }
    return mesh_feature(owner->triangle, static_cast<std::uint32_t>(owner->nearest.part));
  }

  const TriangleMesh& mesh_;
  const Vec3& centre_;
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

}  // namespace

void collide_triangles(const Sphere& a, const TriangleMesh& b, std::span<const std::uint32_t> triangles,
                       const PairQuery& q, ContactSink& sink) {
  const Vec3 centre = q.b.to_local(q.a.position);
  BallOnMesh(b, centre, a.radius, q.reach).collide(triangles, [&](const Touch& touch, Feature feature) {
    const Vec3 n = -(q.b.orientation * touch.normal);
    sink.add({touch.nearest.distance - a.radius, n, a.radius * n, q.curvature ? a.radius : 0.0, feature});
  });
}

}  // namespace epafi
