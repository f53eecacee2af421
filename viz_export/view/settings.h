/// @file settings.h  What a run says of itself to those who draw it: names of bodies and materials, springs, and how
/// its scene wants to be looked at. Kept as a text of one line per entry in run.h5 ("about"); older runs have none.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/state/types.h"

namespace epafi {

/// [view] of a scene.
struct ViewSettings {
  std::string preset;            ///< one of camera_presets(); "" where `from` and `to` are given, or nothing is
  std::optional<Vec3> from, to;  ///< eye and the point it looks at [m]
  Vec3 up = Vec3::Zero();        ///< unit; zero: against gravity
  double angle = 30.0;           ///< of the picture's height, in degrees, in (0, 170)
  std::string field;             ///< name of a field, "" for the default
  std::optional<std::array<double, 2>> range;  ///< of the colours, in units of the field
};

struct RunAbout {
  /// Bodies first .. first + count (ids) share a name.
  struct Group {
    std::string name;
    std::uint32_t first = 0, count = 0;
  };
  struct Spring {
    std::string name;
    std::uint32_t body = 0;
    std::optional<std::uint32_t> to;  ///< none: a frame that moves along the way
    Vec3 attachment = Vec3::Zero();   ///< axes of the body [m]
  };
  std::vector<std::string> materials;
  std::vector<Group> groups;
  std::vector<Spring> springs;
  Vec3 gravity = Vec3::Zero();  ///< at the start [m/s^2]
  double duration = 0.0;        ///< duration set in the scene [s]; 0: not known
  ViewSettings view;
};

[[nodiscard]] std::string to_text(const RunAbout& about);
/// Lines that it does not know are passed over.
[[nodiscard]] RunAbout about_from_text(const std::string& text);

}  // namespace epafi
