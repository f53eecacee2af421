#include "detection/continuous/sweep_guard.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "detection/narrow/mesh/triangle_core.h"

namespace epafi {
namespace {

constexpr double tenth = 0.1;  // of the inner radius: overlap that contact itself resolves
constexpr double fine = 1e-9;  // of the inner radius: where a touch is located; a force law cannot feel it

/// Radius of a sphere about the centre that the body contains [m].
template <class S>
double inner_radius(const S& s) {
  if constexpr (PolyhedralShape<S>)
    return s.view().inner_radius + s.rounding();
  else if constexpr (requires { s.half_length(); })
    return s.rounding() > 0.0 ? s.radius : std::min(s.radius, s.half_length());
  else if constexpr (requires { s.semi_axes; })
    return s.semi_axes.minCoeff();
  else
    return s.rounding();
}

/// The shape as a moving core; null support where it is not convex (meshes, half-spaces).
MovingBody moving_body(const ShapeStore& shapes, ShapeRef ref, const BodyPath& path) {
  return shapes.with(ref, [&](const auto& s) {
    MovingBody body;
    body.path = path;
    if constexpr (ConvexShape<std::decay_t<decltype(s)>>) {
      body.core = ConvexRef::to(s);
      body.sweep = s.rounding();
      body.turning_radius = body.core.radius;  // the sphere swept over the core turns in place
    }
    return body;
  });
}

double inner_radius(const ShapeStore& shapes, ShapeRef ref) {
  return shapes.with(ref, [](const auto& s) -> double {
    if constexpr (ConvexShape<std::decay_t<decltype(s)>>)
      return inner_radius(s);
    else
      return 0.0;
  });
}

Vec3 turn_between(const Quat& from, const Quat& to) {
  const Eigen::AngleAxisd turn(Quat(to * from.conjugate()));
  return turn.angle() > std::numbers::pi ? Vec3(turn.axis() * (turn.angle() - 2 * std::numbers::pi))
                                         : Vec3(turn.axis() * turn.angle());
}

/// Path of a body without stored position: back along its velocities.
BodyPath way_of(const World& world, Slot s, double duration) {
  const Pose now = world.pose(s);
  BodyPath path{now, duration * world.velocity[s], Vec3::Zero()};
  path.start.position -= path.travel;
  if (!world.rotates()) return path;
  path.turn = duration * world.angular_velocity[s];
  const double angle = path.turn.norm();
  if (angle > 0.0) path.start.orientation = Quat(Eigen::AngleAxisd(-angle, path.turn / angle)) * now.orientation;
  return path;
}

/// First share of the paths at which the centre comes as near to a wall as `distance` [m]; above 1: never. By
/// conservative advancement, as time_of_impact.h.
double share_near_wall(const HollowWall& wall, const BodyPath& ball, const BodyPath& way, double distance) {
  const double apart = (ball.start.position - way.start.position).norm() + (ball.travel - way.travel).norm();
  const double speed = (ball.travel - way.travel).norm() + way.turn.norm() * apart;
  double share = 0.0;
  for (int round = 0; round < toi_cap && share <= 1.0; ++round) {
    const double left = wall.distance(way.at(share).to_local(ball.at(share).position)) - distance;
    if (left <= fine * distance) return share;
    if (!(speed > 0.0)) return 2.0;
    share += left / speed;
  }
  return share;
}

/// Share of the path at which a ball that goes too deep first touches; above 1: it does not.
double share_at_wall(const HollowWall& wall, const BodyPath& ball, const BodyPath& way, double radius) {
  const double deep = (1.0 - tenth) * radius, share = share_near_wall(wall, ball, way, deep);
  if (share > 1.0) return share;
  const auto distance = [&](double t) { return wall.distance(way.at(t).to_local(ball.at(t).position)); };
  if (share == 0.0 && distance(fine) >= distance(0.0)) return 2.0;  // it comes out
  return share_near_wall(wall, ball, way, radius);
}

/// The surface of a tube or cone; null of other shapes.
const HollowWall* hollow_wall(const ShapeStore& shapes, ShapeRef ref) {
  return shapes.with(ref, [](const auto& s) -> const HollowWall* {
    if constexpr (HollowShape<std::decay_t<decltype(s)>>)
      return &s.wall;
    else
      return nullptr;
  });
}

/// True if it starts too deep and does not go deeper: the contact handles it.
bool comes_out(const Impact& deep, const BodyPath& a, const BodyPath& b) {
  return deep.share == 0.0 && deep.normal.dot(a.travel - b.travel) <= 0.0;
}

/// Sphere around the whole path of a body.
struct SweptBall {
  Vec3 centre;
  double radius;
  SweptBall(const BodyPath& path, double bounding)
      : centre(path.start.position + 0.5 * path.travel), radius(bounding + 0.5 * path.travel.norm()) {}
  bool meets(const SweptBall& o) const {
    return (centre - o.centre).squaredNorm() <= (radius + o.radius) * (radius + o.radius);
  }
};

}  // namespace

void SweepGuard::remember(const World& world) {
  before_.resize(flagged_.size());
  for (std::size_t k = 0; k < flagged_.size(); ++k)
    if (const Slot s = world.slot_of(flagged_[k]); s != no_slot) before_[k] = world.pose(s);
}

void SweepGuard::meet(const MovingBody& a, double allowed, const MovingBody& b, Hit& hit) {
  const double tolerance = fine * allowed / tenth;
  const Impact deep = time_of_impact(a, b, -allowed, 0.01 * allowed);
  capped_ += !deep.converged;
  if ((!deep.hits && deep.converged) || comes_out(deep, a.path, b.path)) return;
  const Impact touch = time_of_impact(a, b, 0.0, tolerance);
  if (touch.share < hit.share || !hit.found) hit = {std::min(hit.share, touch.share), true};
}

void SweepGuard::look(const World& world, double duration, std::size_t k, Hit& hit) {
  const Slot s = world.slot_of(flagged_[k]);
  const ShapeRef ref{world.shape[s]};
  const Pose now = world.pose(s);
  const BodyPath path{before_[k], now.position - before_[k].position,
                      turn_between(before_[k].orientation, now.orientation)};
  const MovingBody a = moving_body(shapes_, ref, path);
  const double inner = inner_radius(shapes_, ref), allowed = tenth * inner;
  if (path.travel.norm() + path.turn.norm() * a.turning_radius <= allowed) return;  // too slow to pass anything
  const SweptBall ball(path, shapes_.bounding_radius(ref));
  for (Slot o = 0; o < world.size(); ++o) {
    if (o == s) continue;
    const ShapeRef other{world.shape[o]};
    const BodyPath way = way_of(world, o, duration);
    const double bounding = shapes_.bounding_radius(other);
    if (std::isfinite(bounding) && !ball.meets(SweptBall(way, bounding))) continue;
    if (other.type() == ShapeStore::type_of<HalfSpace>()) {
      const Vec3 outward = way.start.orientation * shapes_.of<HalfSpace>()[other.index()].normal;
      const Impact deep = time_of_impact(a, way, outward, -allowed, 0.01 * allowed);
      if (!deep.hits || comes_out(deep, path, way)) continue;
      hit = {std::min(hit.share, time_of_impact(a, way, outward, 0.0, fine * inner).share), true};
    } else if (const HollowWall* const wall = hollow_wall(shapes_, other)) {
      const double share = share_at_wall(*wall, path, way, inner);
      if (share <= 1.0) hit = {std::min(hit.share, share), true};
    } else if (other.type() == ShapeStore::type_of<TriangleMesh>()) {
      const TriangleMesh& mesh = shapes_.of<TriangleMesh>()[other.index()];
      triangles_.clear();
      mesh.query(box_in_body_axes({ball.centre.array() - ball.radius, ball.centre.array() + ball.radius}, world.pose(o))
                     .fattened(way.travel.norm()),
                 triangles_);
      for (const std::uint32_t t : triangles_) {
        const TriangleCore triangle(mesh.corners(t));
        MovingBody b{ConvexRef::to(triangle), 0.0, mesh.bounding_radius(), way};
        b.path.start.position = way.start.to_world(triangle.centre);
        meet(a, allowed, b, hit);
      }
    } else {
      meet(a, allowed, moving_body(shapes_, other, way), hit);
    }
  }
}

double SweepGuard::hold_back(World& world, double duration) {
  double energy = 0.0;
  hits_.assign(flagged_.size(), {});
  for (std::size_t k = 0; k < flagged_.size(); ++k)
    if (world.slot_of(flagged_[k]) != no_slot) look(world, duration, k, hits_[k]);
  for (std::size_t k = 0; k < flagged_.size(); ++k) {  // after all have looked: the order of the flagged plays no part
    if (!hits_[k].found) continue;
    const Slot s = world.slot_of(flagged_[k]);
    const Pose now = world.pose(s);
    const BodyPath path{before_[k], now.position - before_[k].position,
                        turn_between(before_[k].orientation, now.orientation)};
    const Pose held = path.at(hits_[k].share);
    if (world.is_movable(s))
      energy -= world.steady_acceleration(s).dot(held.position - now.position) / world.inverse_mass[s];
    world.position[s] = held.position;
    if (world.has_orientation()) world.orientation[s] = held.orientation;
    if (world.columns().anisotropy && world.is_movable(s))
      world.angular_velocity[s] = world.apply_inverse_inertia(s, world.angular_momentum[s]);
    ++held_;
  }
  return energy;
}

}  // namespace epafi
