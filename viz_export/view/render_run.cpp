#include "viz_export/view/render_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/error.h"
#include "viz_export/side_file.h"
#include "viz_export/view/film.h"
#include "viz_export/view/raster.h"

namespace epafi {
namespace {

constexpr Rgb paper{0.969, 0.973, 0.980}, ink{0.11, 0.14, 0.19}, soft{0.36, 0.40, 0.46}, wall_colour{0.70, 0.73, 0.78};
constexpr float wall_opacity = 0.22f;

ViewField find_field(const ViewSource& source, const std::string& name) {
  const std::string wanted = !name.empty() ? name : source.about().view.field;
  std::string known;
  const auto all = view_fields(source);
  for (const ViewField& f : all) {
    if (f.name == wanted) return f;
    known += (known.empty() ? "" : ", ") + f.name;
  }
  if (name.empty()) return all.front();
  throw FileError("this run has no field '" + name + "'; it has " + known);
}

void add_mesh(const ViewMesh& mesh, const BodyRecord& b, double scale, const Rgb& colour, float opacity,
              DrawnScene& out) {
  const Eigen::Matrix3f turn = b.pose.orientation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f place = b.pose.position.cast<float>();
  const auto size = static_cast<float>(scale);
  for (std::size_t c = 0; c + 2 < mesh.corners.size(); c += 3) {
    DrawnTriangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      t.corner[k] = place + turn * (size * mesh.points[mesh.corners[c + k]]);
      t.normal[k] = turn * mesh.normals[c + k];
    }
    t.colour = colour;
    t.opacity = opacity;
    out.triangles.push_back(t);
  }
}

double mean_radius(const ViewFrame& frame) {
  double sum = 0, count = 0;
  for (const BodyRecord& b : frame.bodies) {
    if (b.is_wall() || !std::isfinite(b.radius)) continue;
    sum += b.radius;
    ++count;
  }
  return count > 0 ? sum / count : 0.0;
}

void add_contacts(const ViewFrame& frame, double strongest, DrawnScene& out) {
  const auto widest = static_cast<float>(0.42 * mean_radius(frame));
  for (const StoredContact& c : frame.contacts) {
    const double share = std::min(1.0, std::abs(c.normal_force) / std::max(strongest, 1e-300));
    const auto width = static_cast<float>(std::max(0.06, std::sqrt(share))) * widest;
    out.lines.push_back({c.from, c.to, width, inferno(0.15 + 0.75 * share)});
  }
}

}  // namespace

std::string short_number(double v) {
  const bool five_digits = std::abs(v) >= 9999.5 && std::abs(v) < 99995;
  const std::string text = five_digits ? fmt::format("{:.0f}", 10 * std::round(v / 10)) : fmt::format("{:.4g}", v);
  return text == "-0" ? "0" : text;
}

RunPainter::RunPainter(const ViewSource& source, const Overview& overview, const RenderOptions& options)
    : source_(source),
      overview_(overview),
      options_(options),
      field_(find_field(source, options.field)),
      range_(colour_range(overview, source.about().view, field_.name)),
      camera_(choose_camera(options.camera, source.about().view, overview.box,
                            static_cast<double>(options.width) / options.height)) {}

Rgb RunPainter::colour_of(const BodyRecord& body, float value) const {
  if (field_.kind == ViewField::Kind::category) return kind_colour(static_cast<std::size_t>(value));
  if (body.is_wall()) return wall_colour;
  const double share = (static_cast<double>(value) - range_[0]) / (range_[1] - range_[0]);
  return viridis(std::isfinite(share) ? share : 0.0);
}

Image RunPainter::paint(std::size_t k) {
  const ViewFrame frame = source_.frame(k);
  const std::vector<float> values = field_values(field_.name, frame, source_.about());
  const bool some_free =
      std::any_of(frame.bodies.begin(), frame.bodies.end(), [](const BodyRecord& b) { return !b.is_wall(); });
  DrawnScene scene;
  for (std::size_t row = 0; row < frame.bodies.size(); ++row) {
    const BodyRecord& b = frame.bodies[row];
    Rgb colour = colour_of(b, values[row]);
    if (options_.contacts && !b.is_wall())
      for (std::size_t part = 0; part < 3; ++part) colour[part] = 0.85 * paper[part] + 0.15 * colour[part];
    const MeshStore::Copy copy = meshes_.of(b.surface);
    if (copy.mesh >= 0) {
      const float opacity = b.is_wall() && some_free ? wall_opacity : options_.contacts ? 0.15f : 1.0f;
      add_mesh(meshes_.all()[static_cast<std::size_t>(copy.mesh)], b, copy.scale, colour, opacity, scene);
    } else if (std::isfinite(b.radius) && b.radius > 0 && !options_.contacts) {
      scene.balls.push_back({b.pose.position.cast<float>(), static_cast<float>(b.radius), colour});
    }
  }
  if (options_.contacts) add_contacts(frame, overview_.strongest, scene);
  Image image = draw_scene(scene, camera_, options_.width, options_.height, paper);
  if (options_.labels) label(image, frame.time);
  return image;
}

void RunPainter::label(Image& image, double time) const {
  const double size = std::max(10.0, options_.height / 38.0);
  const double left = 0.9 * size;
  draw_text(image, left, 1.7 * size, source_.title(), 1.25 * size, ink);
  draw_text(image, left, 3.1 * size, "t = " + short_number(time) + " s", size, ink);
  if (field_.kind == ViewField::Kind::category) return;
  const std::string unit = options_.contacts     ? "contact force [N]"
                           : field_.unit.empty() ? field_.label
                                                 : field_.label + " [" + field_.unit + "]";
  const std::array<double, 2> range = options_.contacts ? std::array<double, 2>{0, overview_.strongest} : range_;
  const int width = static_cast<int>(13 * size), height = static_cast<int>(0.8 * size);
  const int x = static_cast<int>(left), y = image.height - static_cast<int>(2.6 * size);
  draw_text(image, left, y - 0.5 * size, unit, size, ink);
  for (int k = 0; k < width; ++k) {
    const double share = (k + 0.5) / width;
    fill_box(image, x + k, y, 1, height, options_.contacts ? inferno(0.15 + 0.75 * share) : viridis(share));
  }
  std::array<std::string, 3> ticks;
  double written = 0;
  for (std::size_t tick = 0; tick < 3; ++tick) {
    ticks[tick] = short_number(range[0] + 0.5 * static_cast<double>(tick) * (range[1] - range[0]));
    written += text_width(ticks[tick], 0.9 * size);
  }
  // long numbers would run into each other: the ends are enough
  const int step = written + text_width(ticks[1], 0.9 * size) > 0.9 * width ? 2 : 1;
  for (int tick = 0; tick < 3; tick += step) {
    const std::string& text = ticks[static_cast<std::size_t>(tick)];
    const double shift = 0.5 * tick * text_width(text, 0.9 * size);
    draw_text(image, left + 0.5 * tick * width - shift, y + height + 1.1 * size, text, 0.9 * size, soft);
  }
}

void render_picture(const ViewSource& source, const RenderOptions& options, std::size_t frame,
                    const std::filesystem::path& target) {
  const Overview overview = look_over(source);
  RunPainter painter(source, overview, options);
  write_whole_file(target, {png_of(painter.paint(frame))});
}

std::size_t render_film(const ViewSource& source, const RenderOptions& options, std::size_t every,
                        const std::filesystem::path& target) {
  const Overview overview = look_over(source);
  RunPainter painter(source, overview, options);
  Film film(target, options.width, options.height);
  std::size_t pictures = 0;
  for (std::size_t k = 0; k < source.times().size(); k += every) {
    film.add(painter.paint(k));
    ++pictures;
  }
  film.finish();
  return pictures;
}

}  // namespace epafi
