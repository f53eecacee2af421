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
  bool contacts = false;      ///< as ribbons, bodies pale
  bool labels = true;         ///< title, time, colour bar
  bool title = true;          ///< among the labels
  double letters = 1.0 / 38;  ///< their size as part of the picture's height, 10 pixels at least
};

/// Places and lengths of a picture: from where the camera looks at, in units of its distance. So numbers of single
/// precision serve scenes of atoms and of mountains, and scenes far from the origin.
struct DrawnAxes {
  Vec3 origin;
  double unit;
  Camera camera;  ///< in these axes
  explicit DrawnAxes(const Camera& seen);
  Eigen::Vector3f place(const Vec3& p) const { return ((p - origin) / unit).cast<float>(); }
  float length(double l) const { return static_cast<float>(l / unit); }
};

/// Values of a colour bar: `range` of the colours, `extremes` of the values.
struct BarValues {
  std::array<double, 2> range;
  std::array<double, 2> extremes;
  bool whole = false;
};

class RunPainter {
 public:
  /// Throws FileError for a camera or field that is not there. Source and overview must outlive this.
  RunPainter(const ViewSource& source, const Overview& overview, const RenderOptions& options);
  RunPainter(const ViewSource& source, Overview&& overview, const RenderOptions& options) = delete;
  Image paint(std::size_t frame);
  const ViewField& field() const { return field_; }
  /// Free bodies of a frame of which the picture shows no part.
  std::size_t outside(const ViewFrame& frame) const;
  /// Text with the camera's position where the picture shows none of the free bodies; else empty.
  std::string blind_text(const ViewFrame& frame) const;
  /// Text where most visible free bodies are dots that cover little of the picture, as bodies far apart; else empty.
  std::string dots_text(const ViewFrame& frame) const;
  /// Characters of its labels that have no outline (without_outline); empty: all have one.
  std::string unwritable() const;

 private:
  Rgb colour_of(const BodyRecord& body, float value) const;
  void add_thin_line(Vec3 from, Vec3 to, const Rgb& colour, float opacity, DrawnScene& out) const;
  void add_grid(const ViewMesh& square, const BodyRecord& body, double scale, DrawnScene& out) const;
  void add_edges(std::int32_t mesh, const BodyRecord& body, double scale, const Rgb& colour, DrawnScene& out);
  bool is_solid(const BodyRecord& wall) const;
  void add_body(const BodyRecord& body, float value, bool edges, DrawnScene& out);
  void label(Image& image, const ViewFrame& frame) const;
  void colour_bar(Image& image, double size) const;
  BarValues bar_values() const;  ///< where there is a value
  void kinds(Image& image, double size) const;
  std::vector<std::size_t> kinds_shown() const;
  std::string kind_name(std::size_t kind) const;
  const ViewSource& source_;
  const Overview& overview_;
  RenderOptions options_;
  ViewField field_;
  std::optional<std::array<double, 2>> range_;  ///< none: there is no value
  bool resting_;                                ///< no value is more than rounding gives
  Camera camera_;
  DrawnAxes axes_;
  bool above_ground_;      ///< the eye
  bool some_free_ = true;  ///< in any frame: walls are seen through even where all bodies have gone
  MeshStore meshes_;
  std::map<std::int32_t, std::vector<std::uint32_t>> edges_;  ///< of each mesh
};

/// One frame as PNG. Returns notes: characters that could not be written, a camera that sees nothing or dots, what of
/// [view] there is not.
[[nodiscard]] std::vector<std::string> render_picture(const ViewSource& source, const RenderOptions& options,
                                                      std::size_t frame, const std::filesystem::path& target);

/// Every so many frames as a film; the ending of the name chooses: .mp4 or .webm. Throws FileError with what to install
/// where ffmpeg is not there.
struct WrittenFilm {
  std::size_t pictures;
  double rate;                     ///< of pictures [1/s]
  std::vector<std::string> notes;  ///< as of a picture
};
[[nodiscard]] WrittenFilm render_film(const ViewSource& source, const RenderOptions& options, std::size_t every,
                                      const std::filesystem::path& target);

/// "3 bodies outside the picture"; "" of none.
[[nodiscard]] std::string outside_text(std::size_t bodies);

/// "12.5", "3e-06": four digits or fewer, no trailing zeros; with less than four "3e-6".
[[nodiscard]] std::string short_number(double value, int most_digits = 4);

/// A time of these, with as many digits as tell it from those of the frames before and after, four at least.
[[nodiscard]] std::string time_text(const std::vector<double>& times, double time);

/// Labels at start, middle and end of a colour bar: one where all values are equal, integers for counts. An end that
/// values exceed is marked: ">= 5".
[[nodiscard]] std::vector<std::string> range_ticks(const BarValues& bar, int most_digits = 4);

struct PlacedText {
  std::string text;
  double left;  ///< of the bar's left end [pixels]
};

/// The same under a bar of this width in letters of this size [pixels]: with fewer digits, or without the middle one,
/// where they would run together.
[[nodiscard]] std::vector<PlacedText> placed_ticks(const BarValues& bar, double width, double size);

/// Notes on settings of the scene's [view] that this source cannot show, and their replacement. camera, field:
/// requested by the command; "": not set.
[[nodiscard]] std::vector<std::string> view_notes(const ViewSource& source, const std::string& camera,
                                                  const std::string& field);

}  // namespace epafi
