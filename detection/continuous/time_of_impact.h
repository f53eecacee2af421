/// @file time_of_impact.h  When two moving convex bodies first touch, by conservative advancement (Mirtich 1996,
/// ch. 2.3). The separation along a fixed direction n changes at most by the relative travel along n plus the turning
/// of each body at its bounding radius. From the present distance and its normal follows a time before which nothing
/// touches; from there again. For bodies that only travel this is Newton's method on the planes between them and ends
/// in a few steps. Fails (says so, after `toi_cap` steps) where bodies turn fast at a small distance without meeting.
#pragma once
#include "detection/narrow/gjk/minkowski.h"

namespace epafi {

/// A body's way during one interval: from pose `start`, drifting by `travel` [m] and turning by `turn` (axis times
/// angle, rad, world axes) at constant rates.
struct BodyPath {
  Pose start;
  Vec3 travel = Vec3::Zero(), turn = Vec3::Zero();
  Pose at(double share) const;
};

/// A convex body as a core with a sphere swept over it, and what its turning moves.
struct MovingBody {
  ConvexRef core;
  double sweep = 0.0;           ///< [m]
  double turning_radius = 0.0;  ///< of what a turn moves [m]; 0 for spheres
  BodyPath path;
};

struct Impact {
  bool hits = false;
  double share = 1.0;           ///< of the interval, in [0, 1]: the earliest at which the gap is below the target
  double gap = 0.0;             ///< signed distance there [m]
  Vec3 normal = Vec3::UnitZ();  ///< unit, from A to B, world axes
  int iterations = 0;
  bool converged = true;  ///< false: the cap was reached before the end, at `share`, still apart
};

inline constexpr int toi_cap = 256;

/// First time the gap falls to `target` [m] (0: touch; negative: that deep), to within `tolerance` [m], > 0.
/// Bodies that begin closer than target hit at share 0.
Impact time_of_impact(const MovingBody& a, const MovingBody& b, double target, double tolerance);

/// The same against the half-space below a fixed or drifting plane through `plane.position` with outward normal
/// `outward`.
Impact time_of_impact(const MovingBody& a, const BodyPath& plane, const Vec3& outward, double target, double tolerance);

}  // namespace epafi
