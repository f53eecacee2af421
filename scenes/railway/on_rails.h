/// @file on_rails.h  Wheelsets of a scene and its track: placed on its rails at the start, and looked after in a run.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "detection/profiles/wheelset_on_track.h"
#include "scenes/assemble.h"

namespace epafi {

/// Height and roll of every body with `on_rails = true`: both wheels pressed into the rails by what the wheelset weighs
/// and is pressed with, as Hertz' ellipse at the rigid contact has it (rigid contact: just touching). Throws SceneError
/// where there is not one track, or where it does not stand.
void place_on_rails(Assembly& assembly);

/// Says when a free wheelset has left the only track of a scene.
class TrackWatch {
 public:
  explicit TrackWatch(const Assembly& assembly);
  /// Of this step; looks only in one of eight, for leaving a track takes milliseconds.
  std::optional<Failure> look(std::uint64_t step);

 private:
  struct Watched {
    BodyId body;
    std::shared_ptr<const Wheelset> wheelset;
    std::unique_ptr<WheelsetOnTrack> search;
  };
  const World& world_;
  std::shared_ptr<const Track> track_;
  BodyId track_body_{};
  std::vector<Watched> wheelsets_;
};

}  // namespace epafi
