/// @file on_rails.h  Wheelsets and the track of a scene: initial position on the rails, and detection of derailment.
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "detection/profiles/wheelset_on_track.h"
#include "scenes/assemble.h"

namespace epafi {

/// Computes height and roll of every body with `on_rails = true`: both wheels overlap the rails by Hertz's approach
/// under weight and load (with rigid contact: just touching). Throws SceneError without exactly one track, or if there
/// is no such position.
void place_on_rails(Assembly& assembly);

/// Detects that a free wheelset has left the only track of a scene.
class TrackWatch {
 public:
  explicit TrackWatch(const Assembly& assembly);
  /// Checks every eighth step, since derailment takes milliseconds.
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
