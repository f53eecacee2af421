#include "detection/narrow/pairs/hollow_pairs.h"

namespace epafi {
namespace {

/// One half of the outline: sign is -1 beyond the axis.
struct HalfPlane {
  const HollowWall& wall;
  Vec3 outwards;  ///< unit, across the axis, towards the centre
  double radius;  ///< of the centre in the near half, >= 0 [m]
  double z, limit;

  /// From the side's foot or from the rim; curvature: from 1/R_n outside to -1/R_n inside, over the rim by the normal.
  void add(double sign, double foot_radius, double foot_z, Feature feature, WallTouches& out) const {
    const double across = sign * radius - foot_radius, up = z - foot_z;
    const double square = across * across + up * up;
    if (!(square < limit * limit)) return;
    const double distance = std::sqrt(square);
    // on the surface itself: off it towards the inside
    const double nr = distance > 0.0 ? across / distance : -wall.along_z;
    const double nz = distance > 0.0 ? up / distance : wall.along_radius;
    const double outside = nr * wall.along_z - nz * wall.along_radius;  // 1 on the outer side, -1 on the inner one
    const double curvature = foot_radius > 0.0 ? outside * wall.along_z / foot_radius : 0.0;
    const Vec3 direction = sign * nr * outwards + Vec3(0.0, 0.0, nz);
    out.add({distance, direction, curvature, feature});
  }

  void see_side(double sign, WallTouches& out) const {
    const double way = wall.way_along(sign * radius, z);
    const Feature feature = sign > 0.0 ? 0 : 1;
    const bool behind_disc = wall.closed && std::abs(z) > wall.half_length && wall.beyond_side(radius, z) <= 0.0;
    if (way >= 0.0 && way <= wall.side_length) {
      if (behind_disc) return;
      return add(sign, wall.radius_at(way), wall.along_z * way - wall.half_length, feature, out);
    }
    const bool at_end = way > 0.0;
    const double rim = wall.radius_of_end(at_end);
    if (sign < 0.0 && rim == 0.0) return;            // a tip, which the near half has
    if (wall.closed && sign * radius < rim) return;  // the disc has the nearest point
    add(sign, rim, wall.z_of_end(at_end), feature, out);
  }

  void see_disc(bool at_end, WallTouches& out) const {
    const double over = z - wall.z_of_end(at_end);
    if (!(radius <= wall.radius_of_end(at_end)) || wall.radius_of_end(at_end) == 0.0 || !(std::abs(over) < limit))
      return;
    const double inside = at_end ? -1.0 : 1.0;
    if (over * inside > 0.0 && wall.beyond_side(radius, z) > 0.0) return;  // behind the side
    const double sign = over > 0.0 ? 1.0 : over < 0.0 ? -1.0 : inside;
    out.add({std::abs(over), Vec3(0.0, 0.0, sign), 0.0, at_end ? Feature{3} : Feature{2}});
  }
};

}  // namespace

WallTouches ball_touches(const HollowWall& wall, const Vec3& centre, double limit) {
  WallTouches out;
  const double radius = std::sqrt(centre.x() * centre.x() + centre.y() * centre.y());
  if (radius > wall.most_radius() + limit || std::abs(centre.z()) > wall.half_length + limit) return out;
  const Vec3 outwards = radius > 0.0 ? Vec3(centre.x() / radius, centre.y() / radius, 0.0) : Vec3(Vec3::UnitX());
  const HalfPlane half{wall, outwards, radius, centre.z(), limit};
  half.see_side(1.0, out);
  const bool sees_far_side = wall.beyond_side(radius, centre.z()) <= 0.0 || std::abs(centre.z()) >= wall.half_length;
  const bool reaches_far_side = limit > std::min(wall.start_radius, wall.end_radius);
  if (sees_far_side && reaches_far_side) half.see_side(-1.0, out);
  if (!wall.closed) return out;
  half.see_disc(false, out);
  half.see_disc(true, out);
  return out;
}

void collide_ball(double radius, const HollowWall& wall, const PairQuery& q, ContactSink& sink) {
  const Vec3 centre = q.b.to_local(q.a.position);
  const WallTouches touches = ball_touches(wall, centre, radius + q.reach);
  for (int k = 0; k < touches.count; ++k) {
    const WallTouch& t = touches.touch[static_cast<std::size_t>(k)];
    const double gap = t.distance - radius;
    if (!(gap < q.reach)) continue;
    const Vec3 n = -(q.b.orientation * t.direction);
    sink.add({gap, n, radius * n, q.curvature ? wall_contact_radius(radius, t.curvature) : 0.0, t.feature});
  }
}

}  // namespace epafi
