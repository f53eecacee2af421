/// @file part_pairs.h  Two bodies, at least one of convex parts: selects the pairs of parts to test. Four of five pairs
/// of parts of two stones of ten parts are separated along the direction from stone to stone, which takes one support
/// per part; a search would take 0.4 us per pair.
#pragma once
#include <vector>

#include "detection/narrow/pairs/pair_query.h"
#include "detection/shapes/shape_concept.h"

namespace epafi {

/// Rigid cluster: every part touches on its own.
template <class S>
concept Compound = requires(const S& s, const Pose& pose) {
  typename S::Part;
  { s.part_count() } -> std::same_as<std::size_t>;
  { s.part(0) } -> std::same_as<typename S::Part>;
  { s.part_pose(0, pose) } -> std::same_as<Pose>;
};

namespace part_pairs_detail {

template <class W>
struct PartType {
  using type = W;
};
template <Compound W>
struct PartType<W> {
  using type = typename W::Part;
};

/// A part that may come near the other body.
struct NearPart {
  std::size_t number;
  Pose pose;
  double radius;  ///< of its bounding sphere [m]
  double end;     ///< extent from A's centre towards the other body [m]
};

/// The parts of a body as a list; a body without parts is one part of itself.
template <class W>
class PartList {
 public:
  explicit PartList(const W& whole) : whole_(whole) {}
  decltype(auto) part(std::size_t k) const {
    if constexpr (Compound<W>)
      return whole_.part(k);
    else
      return (whole_);
  }
  /// Finds the parts whose bounding spheres come within `limit` [m] of the other body's centre. origin: A's centre;
  /// towards: unit vector to the other body.
  void find_near(const Pose& pose, const Vec3& origin, const Vec3& towards, const Vec3& far, double limit,
                 std::vector<NearPart>& out) const {
    out.clear();
    for (std::size_t k = 0; k < count(); ++k) {
      const auto& p = part(k);
      const Pose at = pose_of(k, pose);
      const double radius = p.bounding_radius(), near = radius + limit;
      if ((at.position - far).squaredNorm() > near * near) continue;
      const Vec3 tip = at.orientation * p.support(at.orientation.conjugate() * towards);
      out.push_back({k, at, radius, towards.dot((at.position - origin) + tip) + p.rounding()});
    }
  }

 private:
  std::size_t count() const {
    if constexpr (Compound<W>)
      return whole_.part_count();
    else
      return 1;
  }
  Pose pose_of(std::size_t k, const Pose& pose) const {
    if constexpr (Compound<W>)
      return whole_.part_pose(k, pose);
    else
      return pose;
  }
  const W& whole_;
};

}  // namespace part_pairs_detail

/// Type of the parts of a shape; for a shape without parts, its own type.
template <class W>
using PartOf = typename part_pairs_detail::PartType<W>::type;

/// Calls f(part of A, part of B, query) for the parts that neither bounding spheres nor the direction between the
/// bodies separate.
template <class A, class B, class F>
void each_part_pair(const A& a, const B& b, const PairQuery& q, ContactSink& sink, const F& f) {
  using namespace part_pairs_detail;
  static thread_local std::vector<NearPart> near_a, near_b;  // keep their size
  const Vec3 between = q.b.position - q.a.position;
  const double radius_a = a.bounding_radius(), radius_b = b.bounding_radius(), distance = between.norm();
  if (distance > radius_a + radius_b + q.reach) return;
  const Vec3 direction = distance > 0.0 ? Vec3(between / distance) : Vec3(Vec3::UnitX());
  const PartList<A> parts_a(a);
  const PartList<B> parts_b(b);
  parts_a.find_near(q.a, q.a.position, direction, q.b.position, radius_b + q.reach, near_a);
  parts_b.find_near(q.b, q.a.position, -direction, q.a.position, radius_a + q.reach, near_b);
  const double apart = q.reach + 4e-12 * (radius_a + radius_b);  // by more than rounding: the search would find none
  if (q.parts) q.parts->begin();
  for (const NearPart& pa : near_a) {
    const Vec3 offset = pa.pose.position - q.a.position;
    if constexpr (Compound<A>) sink.enter_part(pa.number, offset);
    for (const NearPart& pb : near_b) {
      const double near = pa.radius + pb.radius + q.reach;
      if (-pb.end - pa.end > apart || (pb.pose.position - pa.pose.position).squaredNorm() > near * near) continue;
      PairCache* const cache = q.parts ? &q.parts->of(static_cast<std::uint32_t>(pa.number << 8 | pb.number)) : nullptr;
      if constexpr (Compound<B>) sink.enter_part(pb.number, Vec3::Zero());
      PairQuery of_parts = q.of_parts(pa.pose, pb.pose);
      of_parts.cache = cache;
      f(parts_a.part(pa.number), parts_b.part(pb.number), of_parts);
      if constexpr (Compound<B>) sink.leave_part(Vec3::Zero());
    }
    if constexpr (Compound<A>) sink.leave_part(offset);
  }
  if (q.parts) q.parts->end();
}

}  // namespace epafi
