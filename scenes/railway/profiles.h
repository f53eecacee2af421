/// @file profiles.h  From the keys of a wheel_profile or rail_profile to the geometry: for scenes and patch cases
/// alike.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "detection/profiles/track.h"
#include "detection/profiles/wheelset.h"
#include "engine/units/error.h"
#include "engine/units/registry.h"

namespace epafi {

/// The object built from keys, or what is wrong with them and where.
template <class T>
struct Built {
  std::optional<T> value{};
  std::string problem{};  ///< begins with the label
  std::string key{};      ///< whose place to report; empty: the table's
  Place place{};          ///< inside a file that was read; file empty: see key
  /// Warnings of implausible or too coarse data; each begins with the label.
  std::vector<std::string> doubts{};
};

/// `label` names the table in messages. File names are relative to the working directory.
Built<Profile> build_profile(const Parameters& keys, bool is_wheel, const std::string& label);
Built<Wheelset> build_wheelset(const Parameters& keys, const std::string& label);
/// Text for a rail without a point at the depth of the gauge: an error unless the scene sets the gauge, which then is
/// the distance between the last points. Empty where there is such a point.
std::string gauge_face_problem(const Profile& rail, const TrackGeometry& track, const std::string& label);
Built<Track> build_track(const Parameters& keys, const std::string& label);

}  // namespace epafi
