#include "detection/profiles/wheelset_on_track.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace epafi {
namespace {

// the profile around a region is left where the wheel has risen so far: four times the deepest approach of 100 kN
constexpr double deep_enough = 4e-4;
constexpr double profile_step = 0.4e-3, profile_reach = 16e-3;
constexpr double together = 14e-3, alike = 0.3;  // regions within one profile: distance [m], difference of angle [rad]
// above the deepest region, vertically: a flange pressed in by 0.1 mm along its normal is so by 0.3 mm
constexpr double near = 1e-3;

/// Where the flange is highest, minus infinity where nothing rises 10 mm over the tape circle.
double flange_tip(const Profile& wheel) {
  constexpr double least = 10e-3;
  double highest = wheel.at(0.0).z + least, tip = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < wheel.size(); ++k) {
    if (wheel.z_of_point(k) <= highest) continue;
    highest = wheel.z_of_point(k);
    tip = wheel.y_of_point(k);
  }
  return tip;
}

}  // namespace

double WheelDefect::drop(double angle, double radius) const {
  double out = amplitude * std::sin(order * angle);
  const double half = 0.5 * flat_length / radius;
  const double from = std::abs(std::remainder(angle - flat_angle, 2.0 * std::numbers::pi));
  if (from < half) out += radius * (1.0 - std::cos(half - from));
  return out;
}

double WheelDefect::offset(double angle, double radius) const {
  double out = amplitude * order * std::cos(order * angle);
  const double half = 0.5 * flat_length / radius, from = std::remainder(angle - flat_angle, 2.0 * std::numbers::pi);
  if (std::abs(from) < half) out -= std::copysign(radius * std::sin(half - std::abs(from)), from);
  return out;
}

PlaceOnTrack place_on_track(const Wheelset& w, const Track& track, const Pose& body, const Pose& track_body) {
  PlaceOnTrack out;
  const Vec3 centre = track_body.to_local(body.position);
  out.distance = track.distance_of(centre);
  const Pose local = track.frame(out.distance);
  out.frame = {track_body.to_world(local.position), track_body.orientation * local.orientation};
  const Quat turn = out.frame.orientation.conjugate() * body.orientation;
  const Vec3 at = local.to_local(centre), axle = turn * Vec3::UnitY(), mark = turn * Vec3::UnitZ();
  out.position.lateral_shift = at.y();
  out.position.height = at.z() + w.geometry.radius;
  out.position.yaw = std::atan2(-axle.x(), axle.y());
  out.position.roll = std::asin(std::clamp(axle.z(), -1.0, 1.0));
  // the mark is straight down at the start and goes back under a wheel that rolls forwards
  const Vec3 down = (Vec3::UnitZ() - axle.z() * axle).normalized();
  out.angle = std::atan2(axle.dot(mark.cross(down)), mark.dot(down));
  return out;
}

WheelsetOnTrack::WheelsetOnTrack(const Wheelset& wheelset, const Track& track)
    : wheelset_(wheelset),
      track_(track),
      left_(wheelset.wheel, track.rail, wheelset.geometry, false),
      right_(wheelset.wheel, track.rail, wheelset.geometry, true),
      tip_(flange_tip(wheelset.wheel)) {
  for (WheelRailPair* pair : {&left_, &right_}) pair->sample_profiles({profile_step, profile_reach, deep_enough});
}

void WheelsetOnTrack::find(const Pose& body, const Pose& track_body, double reach, bool profiles,
                           std::vector<RollingRegion>& out) {
  const PlaceOnTrack at = place_on_track(wheelset_, track_, body, track_body);
  find_on(false, at, reach, profiles, out);
  find_on(true, at, reach, profiles, out);
}

WheelsetOnTrack::Placed WheelsetOnTrack::place(bool right, const PlaceOnTrack& at) {
  WheelRailPair& pair = right ? right_ : left_;
  WheelsetPosition position = at.position;
  Placed out;
  out.rail = track_.shift(at.distance, right);
  position.lateral_shift -= out.rail.y;
  position.height -= out.rail.z;
  out.along = track_.direction(at.distance, right, pair.rail_axis());
  position.yaw -= std::atan2(out.along.y(), out.along.x());
  const WheelDefect& defect = wheelset_.defect;
  if (defect.any() && (right ? defect.right : defect.left)) {
    position.height -= defect.drop(at.angle, wheelset_.geometry.radius);
    out.behind = defect.offset(at.angle, wheelset_.geometry.radius);
  }
  pair.place(position);
  return out;
}

std::string WheelsetOnTrack::left_track(const Pose& body, const Pose& track_body) {
  constexpr double overturned = 0.5;  // [rad]
  const PlaceOnTrack at = place_on_track(wheelset_, track_, body, track_body);
  if (std::abs(at.position.roll) > overturned) return "it has overturned";
  if (std::abs(at.position.yaw) > overturned) return "it stands across the track";
  for (const bool right : {false, true}) {
    WheelRailPair& pair = right ? right_ : left_;
    place(right, at);
    const std::string wheel = right ? "its right wheel" : "its left wheel";
    if (pair.missing() != WheelRailPair::Missing::nothing) return wheel + " lies beside its rail";
    const std::optional<ContactRegion> region = pair.deepest();
    if (region && region->y_wheel <= tip_ && pair.clearance() < near)
      return wheel + " stands on its rail by the flange";
  }
  return "";
}

std::optional<Pose> WheelsetOnTrack::stand(const Pose& body, const Pose& track_body, const SinkOfRegion& sink) {
  const PlaceOnTrack start = place_on_track(wheelset_, track_, body, track_body);
  PlaceOnTrack at = start;
  at.position.height = at.position.roll = 0.0;
  for (int k = 0; k < 100; ++k) {
    double open[2];  // vertical gap over what it should be, left and right
    for (const bool right : {false, true}) {
      WheelRailPair& pair = right ? right_ : left_;
      place(right, at);
      const std::optional<ContactRegion> region = pair.deepest();
      if (!region) return std::nullopt;
      open[right] = pair.clearance() + sink(*region);
    }
    at.position.height += 0.5 * (open[0] + open[1]);
    at.position.roll += (open[1] - open[0]) / (2.0 * right_.rail_axis());
    if (std::abs(at.position.roll) > 0.5) return std::nullopt;
    if (std::abs(open[0]) + std::abs(open[1]) > 1e-10) continue;
    const auto axle = [](const WheelsetPosition& p) {
      return Vec3(-std::sin(p.yaw) * std::cos(p.roll), std::cos(p.yaw) * std::cos(p.roll), std::sin(p.roll));
    };
    const Quat turn = at.frame.orientation * Quat::FromTwoVectors(axle(start.position), axle(at.position)) *
                      at.frame.orientation.conjugate();
    const Vec3 rise(0.0, 0.0, at.position.height - start.position.height);
    return Pose{body.position + at.frame.orientation * rise, (turn * body.orientation).normalized()};
  }
  return std::nullopt;
}

void WheelsetOnTrack::find_on(bool right, const PlaceOnTrack& at, double reach, bool profiles,
                              std::vector<RollingRegion>& out) {
  WheelRailPair& pair = right ? right_ : left_;
  const auto [along, rail, behind] = place(right, at);
  const double clearance = pair.touch(near, found_);
  // the wheel is where it is: it came down along z, which matters on flanks and between regions (scenes/patch)
  if (profiles && clearance < 0.0) pair.lower(-clearance);
  const std::size_t first = out.size();
  for (ContactRegion& r : found_) {
    const double approach = -clearance * std::cos(r.angle) - r.offset;
    if (approach <= -reach) continue;
    RollingRegion region;
    for (std::size_t k = first; k < out.size(); ++k)
      region.within |=
          std::abs(out[k].region.y_rail - r.y_rail) < together && std::abs(out[k].region.angle - r.angle) < alike;
    if (profiles && !region.within) pair.add_profile(r);
    // along the rail as it lies: its slope turns the normal, or an irregularity would do work out of nothing
    const Vec3 across(0.0, std::cos(r.angle), std::sin(r.angle)), t = (across - across.dot(along) * along).normalized();
    Mat3 axes;
    axes << along, t, along.cross(t);
    region.axes = at.frame.orientation.toRotationMatrix() * axes;
    region.point = at.frame.to_world(r.point + Vec3(-behind, rail.y, rail.z));
    region.mirrored = !right;
    region.approach = approach;
    region.source = &pair;
    region.region = std::move(r);
    out.push_back(std::move(region));
  }
  // named from the field side on, so that a second contact at the flange does not rename the first
  std::vector<double> place;
  for (std::size_t k = first; k < out.size(); ++k) place.push_back(out[k].region.y_rail);
  std::sort(place.begin(), place.end());
  for (std::size_t k = first; k < out.size(); ++k) {
    const auto number = std::find(place.begin(), place.end(), out[k].region.y_rail) - place.begin();
    out[k].name = (right ? 16u : 0u) + static_cast<std::uint32_t>(number);
  }
}

}  // namespace epafi
