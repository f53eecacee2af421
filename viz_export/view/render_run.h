/// @file render_run.h  Pictures and films of a run without a display: the page's camera, colours and shapes, with
/// colour bar, time and title. Films are coded by ffmpeg, which runs as a program.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "viz_export/view/image.h"
#include "viz_export/view/mesh.h"
#include "viz_export/view/overview.h"
#include "viz_export/view/raster.h"

namespace epafi {

struct RenderOptions {
  std::string camera, field;  ///< "": the scene's choice
  int width = 1280, height = 720;
  bool contacts = false;  ///< as ribbons, bodies pale
  bool labels = true;     ///< title, time, colour bar
};

class RunPainter {
 public:
  /// Throws FileError for a camera or field that is not there. Source and overview must outlive this.
  RunPainter(const ViewSource& source, const Overview& overview, const RenderOptions& options);
  RunPainter(const ViewSource& source, Overview&& overview, const RenderOptions& options) = delete;
  Image paint(std::size_t frame);
  const ViewField& field() const { return field_; }

 private:
  Rgb colour_of(const BodyRecord& body, float value) const;
  void add_edges(std::int32_t mesh, const BodyRecord& body, double scale, const Rgb& colour, DrawnScene& out);
  bool is_solid(const BodyRecord& wall) const;
  void add_body(const BodyRecord& body, float value, bool edges, DrawnScene& out);
  void label(Image& image, double time) const;
  void colour_bar(Image& image, double size) const;
  void kinds(Image& image, double size) const;
  std::string kind_name(std::size_t kind) const;
  const ViewSource& source_;
  const Overview& overview_;
  RenderOptions options_;
  ViewField field_;
  std::optional<std::array<double, 2>> range_;  ///< none: there is no value
  Camera camera_;
  bool above_ground_;      ///< the eye
  bool some_free_ = true;  ///< in any frame: walls are seen through even where all bodies have gone
  MeshStore meshes_;
  std::map<std::int32_t, std::vector<std::uint32_t>> edges_;  ///< of each mesh
};

/// One frame as PNG.
void render_picture(const ViewSource& source, const RenderOptions& options, std::size_t frame,
                    const std::filesystem::path& target);

/// Every so many frames as a film, 25 per second; the ending of the name chooses: .mp4 or .webm. Returns the number of
/// pictures. Throws FileError with what to install where ffmpeg is not there.
std::size_t render_film(const ViewSource& source, const RenderOptions& options, std::size_t every,
                        const std::filesystem::path& target);

/// "12.5", "3e-06": four digits, no trailing zeros.
[[nodiscard]] std::string short_number(double value);

/// A time of these, with as many digits as tell it from those of the frames before and after, four at least.
[[nodiscard]] std::string time_text(const std::vector<double>& times, double time);

/// What stands at start, middle and end of a colour bar: one text where all values are the same, no half counts.
[[nodiscard]] std::vector<std::string> range_ticks(const std::array<double, 2>& range, bool whole);

}  // namespace epafi
