#include "detection/narrow/pairs/ball_parts.h"

#include <algorithm>
#include <span>

#include "detection/narrow/pairs/sphere_pairs.h"

namespace epafi {
namespace {

/// The balls of a clump where it stands.
class BallsInPlace {
 public:
  void place(const Clump& clump, const Pose& pose) {
    const std::size_t n = clump.part_count();
    parts_ = clump.parts.data();
    centre_.resize(n);
    chosen_.resize(n + 1);
    for (std::size_t k = 0; k < n; ++k) centre_[k] = pose.to_world(parts_[k].centre);
  }
  /// The numbers of balls that come within `limit` [m] of a point.
  void choose_near(const Vec3& point, double limit) {
    choose([&](std::size_t k) {
      const double near = limit + parts_[k].radius;
      return (centre_[k] - point).squaredNorm() <= near * near;
    });
  }
  /// Those whose boxes meet a box.
  void choose_in(const Aabb& box) {
    choose([&](std::size_t k) {
      const Vec3& x = centre_[k];
      const double r = parts_[k].radius;
      const bool below = (x.x() + r < box.min.x()) | (x.y() + r < box.min.y()) | (x.z() + r < box.min.z());
      const bool above = (x.x() - r > box.max.x()) | (x.y() - r > box.max.y()) | (x.z() - r > box.max.z());
      return !(below | above);
    });
  }
  Aabb box_of_chosen() const {
    Aabb box{Vec3::Constant(infinity), Vec3::Constant(-infinity)};
    for (const std::uint32_t k : chosen()) {
      const Vec3 r = Vec3::Constant(parts_[k].radius);
      box.min = box.min.cwiseMin(centre_[k] - r);
      box.max = box.max.cwiseMax(centre_[k] + r);
    }
    return box;
  }
  std::span<const std::uint32_t> chosen() const { return {chosen_.data(), count_}; }
  const Vec3& centre(std::size_t k) const { return centre_[k]; }
  double radius(std::size_t k) const { return parts_[k].radius; }

 private:
  template <class F>
  void choose(const F& is_chosen) {
    count_ = 0;
    for (std::uint32_t k = 0; k < centre_.size(); ++k) {
      chosen_[count_] = k;  // no branch: the next one overwrites what is not kept
      count_ += is_chosen(k);
    }
  }
  const PlacedBall* parts_ = nullptr;
  std::vector<Vec3> centre_;
  std::vector<std::uint32_t> chosen_;
  std::size_t count_ = 0;
};

/// The centres of the first body's balls are kept while its pairs follow each other.
struct LastPlaced {
  BallsInPlace balls;
  Clump own;  // the caller's may be gone when the next one comes
  Pose pose;

  void place(const Clump& clump, const Pose& at) {
    if (at.position == pose.position && at.orientation.coeffs() == pose.orientation.coeffs() && is_of(clump)) return;
    pose = at;
    own.parts = clump.parts;
    balls.place(own, at);
  }
  bool is_of(const Clump& clump) const {
    return std::ranges::equal(own.parts, clump.parts, [](const PlacedBall& p, const PlacedBall& r) {
      return p.centre == r.centre && p.radius == r.radius;
    });
  }
};

}  // namespace

void collide_balls(const Clump& a, const Clump& b, const PairQuery& q, ContactSink& sink) {
  static thread_local LastPlaced first;  // they keep their size
  static thread_local BallsInPlace second;
  const double radius_b = b.bounding_radius();
  first.place(a, q.a);
  BallsInPlace& of_a = first.balls;
  of_a.choose_near(q.b.position, (1.0 + 1e-9) * (radius_b + q.reach));
  if (of_a.chosen().empty()) return;
  second.place(b, q.b);
  second.choose_in(of_a.box_of_chosen().fattened(q.reach + 1e-9 * radius_b));  // by more than rounding
  PairQuery of_balls = q.of_parts(q.a, q.b);
  for (const std::uint32_t k : of_a.chosen()) {
    const Vec3& x = of_a.centre(k);
    const Vec3 offset = x - q.a.position;
    of_balls.a.position = x;
    sink.enter_part(k, offset);
    for (const std::uint32_t j : second.chosen()) {
      const double near = (1.0 + 1e-9) * (of_a.radius(k) + second.radius(j) + q.reach);
      if ((second.centre(j) - x).squaredNorm() > near * near) continue;
      of_balls.b.position = second.centre(j);
      sink.enter_part(j, Vec3::Zero());
      collide_closed(Sphere{of_a.radius(k)}, Sphere{second.radius(j)}, of_balls, sink);
      sink.leave_part(Vec3::Zero());
    }
    sink.leave_part(offset);
  }
}

}  // namespace epafi
