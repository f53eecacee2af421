/// @file guideway.h  A line that bodies follow: pose of a moving frame, and distance along the line of a point.
/// Detection gives it a track, springs of moving frames read it; neither knows the other.
#pragma once
#include "engine/state/types.h"

namespace epafi {

class Guideway {
 public:
  virtual ~Guideway() = default;
  /// The frame at distance s along the way [m]: x forwards, y to the right, z down; in world axes.
  virtual Pose frame(double s) const = 0;
  /// Distance along the way of the frame whose plane x = 0 holds the point [m].
  virtual double distance_of(const Vec3& point) const = 0;
};

/// Straight along the axes of `start`.
class StraightWay final : public Guideway {
 public:
  explicit StraightWay(Pose start = {}) : start_(start) {}
  Pose frame(double s) const override { return {start_.to_world(Vec3(s, 0.0, 0.0)), start_.orientation}; }
  double distance_of(const Vec3& point) const override { return start_.to_local(point).x(); }

 private:
  Pose start_;
};

}  // namespace epafi
