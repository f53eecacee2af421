#include "detection/continuous/time_of_impact.h"

#include <cmath>

#include "detection/narrow/gjk/epa.h"
#include "detection/narrow/gjk/gjk.h"

namespace epafi {
namespace {

struct Separation {
  double gap;
  Vec3 normal;  ///< A to B, world axes
};

/// Signed distance: a lower bound that the normal certifies.
Separation separation(const MovingBody& a, const MovingBody& b, const Pose& pose_a, const Pose& pose_b) {
  const MinkowskiDifference difference(a.core, b.core, pose_a, pose_b);
  const GjkResult g = gjk(difference, {infinity, 1e-13, Vec3::Zero()});
  const double sweeps = a.sweep + b.sweep;
  if (g.status != GjkResult::Status::overlapping) return {g.lower - sweeps, pose_a.orientation * g.normal};
  const Penetration p = epa(difference, 1e-9);
  return {-p.upper - sweeps, pose_a.orientation * p.normal};
}

/// Share of the interval before which a separation of `room` along n cannot be used up.
double safe_share(double room, const Vec3& n, const BodyPath& a, const BodyPath& b, double turning) {
  const double closing = n.dot(a.travel - b.travel) + turning;  // per interval
  return closing > 0.0 ? room / closing : infinity;
}

template <class Measure>
Impact advance(const Measure& measure, const BodyPath& a, const BodyPath& b, double turning, double target,
               double tolerance) {
  Impact impact;
  double share = 0.0;
  for (impact.iterations = 1; impact.iterations <= toi_cap; ++impact.iterations) {
    const Separation s = measure(share);
    impact.share = share;
    impact.gap = s.gap;
    impact.normal = s.normal;
    if (s.gap <= target + tolerance) {
      impact.hits = true;
      return impact;
    }
    share += safe_share(s.gap - target, s.normal, a, b, turning);
    if (share > 1.0) {
      impact.share = 1.0;
      return impact;
    }
  }
  impact.converged = false;
  return impact;
}

}  // namespace

Pose BodyPath::at(double share) const {
  Pose p{start.position + share * travel, start.orientation};
  const double angle = turn.norm();
  if (angle > 0.0) p.orientation = Quat(Eigen::AngleAxisd(share * angle, turn / angle)) * start.orientation;
  return p;
}

Impact time_of_impact(const MovingBody& a, const MovingBody& b, double target, double tolerance) {
  const double turning = a.path.turn.norm() * a.turning_radius + b.path.turn.norm() * b.turning_radius;
  return advance([&](double share) { return separation(a, b, a.path.at(share), b.path.at(share)); }, a.path, b.path,
                 turning, target, tolerance);
}

Impact time_of_impact(const MovingBody& a, const BodyPath& plane, const Vec3& outward, double target,
                      double tolerance) {
  const double turning = a.path.turn.norm() * a.turning_radius;
  const auto measure = [&](double share) -> Separation {
    const Pose p = a.path.at(share);
    const Vec3 deepest = p.orientation * a.core.support(p.orientation.conjugate() * -outward);
    return {outward.dot(p.position - plane.at(share).position + deepest) - a.sweep, -outward};
  };
  return advance(measure, a.path, plane, turning, target, tolerance);
}

}  // namespace epafi
