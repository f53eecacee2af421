/// @file view_commands.h  Commands that show a run: view, render, watch.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace epafi {

struct ViewOptions {
  std::string what;  ///< folder of a run, or a scene file
  std::vector<std::string> overrides;
  std::string out;  ///< file; empty: a local server
  std::uint16_t port = 8047;
  bool no_browser = false;
};

struct RenderRequest {
  std::string directory;
  std::string out;                   ///< .png, .mp4, .webm; empty: DIR/picture.png
  std::optional<double> time;        ///< [s]; the last frame where not given
  std::optional<std::size_t> every;  ///< frames of a film
  std::string camera, field, size = "1280x720";
  bool contacts = false;
};

int command_view(const ViewOptions& options);
int command_render(const RenderRequest& request);

}  // namespace epafi
