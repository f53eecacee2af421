/// @file wheelset_on_track.h  Where a wheelset stands on a track, and all places where its wheels touch the rails.
#pragma once
#include "detection/profiles/track.h"
#include "detection/profiles/wheelset.h"
#include "engine/rolling_regions.h"

namespace epafi {

/// A wheelset in the axes of the track where it is.
struct PlaceOnTrack {
  double distance = 0.0;      ///< along the line [m]
  WheelsetPosition position;  ///< lateral shift, height, yaw, roll
  double angle = 0.0;         ///< by which it has rolled from the marked place, in (-pi, pi] [rad]
  Pose frame;                 ///< of the track there, world axes
};
PlaceOnTrack place_on_track(const Wheelset& wheelset, const Track& track, const Pose& body, const Pose& track_body);

/// Search for one wheelset on one track. Rails count as straight over the length of a patch: in a curve of 100 m a
/// patch of 20 mm leaves its tangent by half a micrometre.
class WheelsetOnTrack {
 public:
  /// Both must outlive this.
  WheelsetOnTrack(const Wheelset& wheelset, const Track& track);
  /// Appends the regions nearer than `reach` to touching [m], left wheel first; with the gap along lines across the
  /// track for the first of those that lie together. Their source is this object until the next call.
  void find(const Pose& body, const Pose& track_body, double reach, bool profiles, std::vector<RollingRegion>& out);

 private:
  void find_on(bool right, const PlaceOnTrack& at, double reach, bool profiles, std::vector<RollingRegion>& out);

  const Wheelset& wheelset_;
  const Track& track_;
  WheelRailPair left_, right_;
  std::vector<ContactRegion> found_;
};

}  // namespace epafi
