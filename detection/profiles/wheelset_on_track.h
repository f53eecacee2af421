/// @file wheelset_on_track.h  Where a wheelset stands on a track, and all places where its wheels touch the rails.
#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "detection/profiles/track.h"
#include "detection/profiles/wheelset.h"
#include "engine/railway/rolling_regions.h"

namespace epafi {

/// A wheelset in the axes of the track where it is.
struct PlaceOnTrack {
  double distance = 0.0;      ///< along the line [m]
  WheelsetPosition position;  ///< lateral shift, height, yaw, roll
  double angle = 0.0;         ///< by which it has rolled from the marked place, in (-pi, pi] [rad]
  Pose frame;                 ///< of the track there, world axes
};
PlaceOnTrack place_on_track(const Wheelset& wheelset, const Track& track, const Pose& body, const Pose& track_body);

/// How far a wheel is pressed into its rail [m], along z, by what it touches first; >= 0.
using SinkOfRegion = std::function<double(const ContactRegion&)>;

/// Search for one wheelset on one track. Rails count as straight over the length of a patch: in a curve of 100 m a
/// patch of 20 mm leaves its tangent by half a micrometre.
class WheelsetOnTrack {
 public:
  /// Both must outlive this.
  WheelsetOnTrack(const Wheelset& wheelset, const Track& track);
  /// Appends the regions nearer than `reach` to touching [m], left wheel first; with the gap along lines across the
  /// track for the first of those that lie together. Their source is this object until the next call.
  void find(const Pose& body, const Pose& track_body, double reach, bool profiles, std::vector<RollingRegion>& out);
  /// The wheelset over the same place of the track and with the same yaw and turn of its wheels, its height and roll
  /// such that both wheels are pressed in by `sink`; nothing where it does not stand there.
  std::optional<Pose> stand(const Pose& body, const Pose& track_body, const SinkOfRegion& sink);
  /// How it has left the track, in words: a flange stands on its rail or a wheel lies beside it. Empty: it has not.
  std::string left_track(const Pose& body, const Pose& track_body);

 private:
  /// One wheel where it is; what the rail's direction is there and how far behind the axle it touches by a defect.
  struct Placed {
    Vec3 along = Vec3::UnitX();
    RailShift rail;
    double behind = 0.0;
  };
  Placed place(bool right, const PlaceOnTrack& at);
  void find_on(bool right, const PlaceOnTrack& at, double reach, bool profiles, std::vector<RollingRegion>& out);

  const Wheelset& wheelset_;
  const Track& track_;
  WheelRailPair left_, right_;
  double tip_;  ///< of the flange, from the tape circle; minus infinity where there is none [m]
  std::vector<ContactRegion> found_;
};

}  // namespace epafi
