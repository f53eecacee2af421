/// @file wheelset_on_track.h  Position of a wheelset on a track, and all contact points of its wheels with the rails.
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
  double angle = 0.0;         ///< rolling angle from the marked position, in (-pi, pi] [rad]
  Pose frame;                 ///< of the track there, world axes
};
PlaceOnTrack place_on_track(const Wheelset& wheelset, const Track& track, const Pose& body, const Pose& track_body);

/// Overlap of a wheel and its rail along z, at the first contact [m]; >= 0.
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
  /// The wheelset at the same place of the track, with the same yaw and angle of its wheels, and with height and roll
  /// such that both wheels overlap by `sink`; nothing if there is no such position.
  std::optional<Pose> stand(const Pose& body, const Pose& track_body, const SinkOfRegion& sink);
  /// Description of a derailment: a flange is on its rail or a wheel beside it. Empty: none.
  std::string left_track(const Pose& body, const Pose& track_body);

 private:
  /// One wheel, the rail's direction there, and the distance of its contact behind the axle by a defect.
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
