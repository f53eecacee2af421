#include "scenes/railway/on_rails.h"

#include <fmt/format.h>

#include <cmath>

#include "laws/material.h"
#include "laws/wheel_rail/elastic_pair.h"
#include "laws/wheel_rail/normal/hertz_ellipse.h"
#include "scenes/contact_setup.h"
#include "scenes/railway/rolling.h"

namespace epafi {
namespace {

/// The slots of all tracks.
std::vector<Slot> tracks_of(const World& w) {
  std::vector<Slot> out;
  for (Slot s = 0; s < w.size(); ++s)
    if (ShapeRef{w.shape[s]}.type() == ShapeStore::type_of<RailProfile>()) out.push_back(s);
  return out;
}

const Wheelset& wheelset_of(const Assembly& a, Slot s) {
  return *a.shapes->of<WheelProfile>()[ShapeRef{a.simulation->world.shape[s]}.index()].wheelset;
}

/// Displacement along z of a wheel under half the load; 0 for rigid contact or no load.
SinkOfRegion sink_of(const Assembly& a, Slot s, Slot track) {
  const World& w = a.simulation->world;
  if (a.scene.contact.method.value != Method::smooth || !w.is_movable(s))
    return [](const ContactRegion&) { return 0.0; };
  const Vec3 down = w.pose(track).orientation * Vec3::UnitZ();
  const double load = 0.5 * w.free_acceleration(s).dot(down) / w.inverse_mass[s];
  const MaterialTable table = material_table(a.scene);
  const MaterialPair& pair = table.of(w.material[s], w.material[track]);
  const double modulus = elastic_pair(pair.a, pair.b).effective_modulus();
  return [load, modulus](const ContactRegion& r) {
    if (!(load > 0.0) || !(r.curvature_x > 0.0)) return 0.0;
    const double flattest = 0.02 * r.curvature_x, slope = std::cos(r.angle);
    const double across = std::max(r.curvature_y, flattest);
    return hertz_of_force(0.5 * r.curvature_x, 0.5 * across, modulus, load / slope).approach / slope;
  };
}

}  // namespace

void place_on_rails(Assembly& a) {
  World& w = a.simulation->world;
  const std::vector<Slot> tracks = tracks_of(w);
  for (std::size_t k = 0; k < a.scene.bodies.size(); ++k) {
    const BodySpec& body = a.scene.bodies[k];
    if (!body.on_rails || body.absent) continue;
    const Place& place = a.scene.groups[body.group].place;
    if (tracks.size() != 1)
      throw SceneError(fmt::format("body '{}': on_rails needs one body with a rail_profile in the scene, found {}",
                                   body_name(a.scene, k), tracks.size()),
                       place);
    const Slot s = w.slot_of(a.id_of(k)), track = tracks.front();
    const Track& rails = *a.shapes->of<RailProfile>()[ShapeRef{w.shape[track]}.index()].track;
    const auto pose = WheelsetOnTrack(wheelset_of(a, s), rails).stand(w.pose(s), w.pose(track), sink_of(a, s, track));
    if (!pose)
      throw SceneError(
          fmt::format("body '{}': on_rails: the wheelset does not stand on both rails {:.4g} m beside the track's "
                      "middle; a wheel would lie beside its rail, or a flange would run up",
                      body_name(a.scene, k),
                      place_on_track(wheelset_of(a, s), rails, w.pose(s), w.pose(track)).position.lateral_shift),
          place);
    w.position[s] = pose->position;
    w.orientation[s] = pose->orientation;
  }
}

TrackWatch::TrackWatch(const Assembly& a) : world_(a.simulation->world) {
  const std::vector<Slot> tracks = tracks_of(world_);
  if (tracks.size() != 1) return;
  track_body_ = world_.id[tracks.front()];
  track_ = a.shapes->of<RailProfile>()[ShapeRef{world_.shape[tracks.front()]}.index()].track;
  for (Slot s = 0; s < world_.size(); ++s) {
    if (ShapeRef{world_.shape[s]}.type() != ShapeStore::type_of<WheelProfile>() || !world_.is_movable(s)) continue;
    std::shared_ptr<const Wheelset> wheelset = a.shapes->of<WheelProfile>()[ShapeRef{world_.shape[s]}.index()].wheelset;
    auto search = std::make_unique<WheelsetOnTrack>(*wheelset, *track_);
    wheelsets_.push_back({world_.id[s], std::move(wheelset), std::move(search)});
  }
}

std::optional<Failure> TrackWatch::look(std::uint64_t step) {
  constexpr std::uint64_t interval = 8;
  if (wheelsets_.empty() || (step % interval != 0 && step > 1)) return std::nullopt;
  const Slot track = world_.slot_of(track_body_);
  for (Watched& w : wheelsets_) {
    const Slot s = world_.slot_of(w.body);
    if (s == no_slot || track == no_slot) continue;
    const std::string how = w.search->left_track(world_.pose(s), world_.pose(track));
    if (how.empty()) continue;
    const PlaceOnTrack at = place_on_track(*w.wheelset, *track_, world_.pose(s), world_.pose(track));
    return Failure{"off the track", step, w.body,
                   fmt::format("a wheelset left the track at t = {:.6g} s (step {}), {:.6g} m along it and {:.4g} m "
                               "beside its middle: {}",
                               world_.time, step, at.distance, at.position.lateral_shift, how)};
  }
  return std::nullopt;
}

}  // namespace epafi
