#include "viz_export/view/render_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string_view>

#include "engine/units/error.h"
#include "viz_export/files/side_file.h"
#include "viz_export/view/film.h"
#include "viz_export/view/raster.h"

namespace epafi {
namespace {

constexpr Rgb wall_colour{0.70, 0.73, 0.78}, ground_colour{0.86, 0.88, 0.90}, spring_colour{0.2, 0.2, 0.2},
    wall_edge{0.62, 0.65, 0.70}, ground_edge{0.45, 0.48, 0.54};
constexpr std::ptrdiff_t most_outlined = 400;  // free bodies; among more of them lines would hide the colours
constexpr int grid_parts = 4;                  // of a half-space from within, each way
constexpr double widest_part = 0.42;           // of a radius: half the width of a ribbon of contacts
constexpr float wall_opacity = 0.22f, pale_opacity = 0.15f;   // of walls; of free bodies around their contacts
constexpr float behind_opacity = 0.06f, grid_opacity = 0.3f;  // of a half-space from within, and of its lines

ViewField find_field(const ViewSource& source, const std::string& name) {
  const std::string wanted = !name.empty() ? name : source.about().view.field;
  std::string known;
  const auto all = view_fields(source);
  for (const ViewField& f : all) {
    if (f.name == wanted) return f;
    known += (known.empty() ? "" : ", ") + f.name;
  }
  if (name.empty()) return all.front();
  throw SceneError("this run has no field '" + name + "'; it has " + known);
}

/// Colour of edges that contrasts with this face colour.
Rgb edge_of(const Rgb& face) {
  const bool dark = 0.3 * face[0] + 0.6 * face[1] + 0.1 * face[2] < 0.3;
  Rgb out{};
  for (std::size_t part = 0; part < 3; ++part)
    out[part] = dark ? face[part] + 0.45 * (1 - face[part]) : 0.4 * face[part];
  return out;
}

/// How a body's surface is drawn.
struct MeshLook {
  double scale;
  Rgb colour;
  float opacity;
};

/// True where the eye is inside a half-space, which is then transparent. Of unbounded shapes (also rails) only
/// half-spaces are drawn as a square.
bool is_within(const BodyRecord& b, const ViewMesh& mesh, double scale, const Vec3& eye) {
  if (!std::isinf(b.radius) || mesh.points.size() != 4) return false;
  return mesh.normals[0].cast<double>().dot(b.pose.to_local(eye) - scale * mesh.points[0].cast<double>()) < 0;
}

void add_mesh(const ViewMesh& mesh, const BodyRecord& b, const MeshLook& look, const DrawnAxes& axes, DrawnScene& out) {
  const Eigen::Matrix3f turn = b.pose.orientation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f place = axes.place(b.pose.position);
  const float size = axes.length(look.scale);
  for (std::size_t c = 0; c + 2 < mesh.corners.size(); c += 3) {
    DrawnTriangle t;
    for (std::size_t k = 0; k < 3; ++k) {
      t.corner[k] = place + turn * (size * mesh.points[mesh.corners[c + k]]);
      t.normal[k] = turn * mesh.normals[c + k];
    }
    t.colour = look.colour;
    t.opacity = look.opacity;
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

/// Record of the body; end() where it is not in the frame.
std::vector<BodyRecord>::const_iterator record_of(const ViewFrame& frame, std::uint32_t id) {
  const auto row = std::lower_bound(frame.bodies.begin(), frame.bodies.end(), id,
                                    [](const BodyRecord& b, std::uint32_t wanted) { return b.id < wanted; });
  return row != frame.bodies.end() && row->id == id ? row : frame.bodies.end();
}

/// Draws contacts with a width by force: at most 0.42 of the mean body's and of the smaller body's size
/// (page/lines.js).
void add_contacts(const ViewFrame& frame, double strongest, const DrawnAxes& axes, DrawnScene& out) {
  const double widest = widest_part * mean_radius(frame);
  const auto radius_of = [&](std::uint32_t id) {
    const auto body = record_of(frame, id);
    const bool limits = body != frame.bodies.end() && !body->is_wall() && body->radius > 0;
    return limits ? body->radius : std::numeric_limits<double>::infinity();
  };
  for (const StoredContact& c : frame.contacts) {
    const double share = std::min(1.0, std::abs(c.normal_force) / std::max(strongest, 1e-300));
    const double most = widest_part * std::min(radius_of(c.a), radius_of(c.b));
    const double width = std::min(std::max(0.06, std::sqrt(share)) * widest, most);
    out.lines.push_back({axes.place(c.from.cast<double>()), axes.place(c.to.cast<double>()), axes.length(width),
                         inferno(0.15 + 0.75 * share)});
  }
}

/// A vector normal to a direction and, if possible, to y or x, so that it is visible from the front and the side.
Vec3 side_of(const Vec3& direction) {
  const bool along_y = std::abs(direction.y()) > std::abs(direction.x());
  return direction.cross(along_y ? Vec3(Vec3::UnitX()) : Vec3(Vec3::UnitY())).normalized();
}

/// Draws a spring as a zigzag between straight ends, as the page does (page/lines.js).
void add_spring(const Vec3& from, const Vec3& to, double widest, const DrawnAxes& axes, DrawnScene& out) {
  constexpr int pieces = 12;
  constexpr double straight = 0.15;  // of the length, at each end
  const Vec3 way = to - from;
  const double length = way.norm();
  if (!(length > 0)) return;
  const float width = axes.length(std::min(0.35 * widest, 0.008 * length));
  const Vec3 side = std::min(2 * widest, 0.06 * length) * side_of(way / length);
  Vec3 last = from;
  for (int k = 0; k <= pieces + 1; ++k) {
    const double share = k > pieces ? 1.0 : straight + (1 - 2 * straight) * k / pieces;
    const double swing = k > pieces || k % 2 == 0 ? 0.0 : k % 4 == 1 ? 1.0 : -1.0;
    const Vec3 next = from + share * way + swing * side;
    out.lines.push_back({axes.place(last), axes.place(next), width, spring_colour});
    last = next;
  }
}

/// Springs from the attachment to the other body's centre; those without one hang on a short line.
void add_springs(const ViewFrame& frame, const RunAbout& about, const DrawnAxes& axes, DrawnScene& out) {
  const double widest = 0.25 * mean_radius(frame), shown = 4 * widest;  // of a line to a moving frame
  for (const auto& spring : about.springs) {
    const auto a = record_of(frame, spring.body);
    if (a == frame.bodies.end()) continue;
    const Vec3 from = a->pose.to_world(spring.attachment);
    const double within = a->surface == nullptr ? a->radius : 0.0;  // of a ball it would be hidden
    Vec3 to = from + (shown + within) * upwards(about);
    if (spring.to) {
      const auto b = record_of(frame, *spring.to);
      if (b == frame.bodies.end()) continue;
      to = b->pose.position;
    }
    add_spring(from, to, widest, axes, out);
  }
}

}  // namespace

std::string short_number(double v, int most_digits) {
  constexpr int usual = 4;
  const bool five_digits = most_digits >= usual && std::abs(v) >= 9999.5 && std::abs(v) < 99995;
  std::string text =
      five_digits ? fmt::format("{:.0f}", 10 * std::round(v / 10)) : fmt::format("{:.{}g}", v, most_digits);
  for (const auto& [full, brief] : {std::pair{"e+0", "e"}, {"e-0", "e-"}, {"e+", "e"}})
    if (const std::size_t at = text.find(full); at != text.npos && most_digits < usual)
      text.replace(at, std::string_view(full).size(), brief);
  return text == "-0" ? "0" : text;
}

std::string time_text(const std::vector<double>& times, double time) {
  const double apart = times.size() > 1 ? (times.back() - times.front()) / static_cast<double>(times.size() - 1) : 0.0;
  const double ratio = apart > 0 ? std::abs(time) / apart : 0.0;
  const int telling = ratio > 1 ? 1 + static_cast<int>(std::ceil(std::log10(ratio))) : 0;
  return telling > 4 ? fmt::format("{:.{}g}", time, std::min(telling, 12)) : short_number(time);
}

DrawnAxes::DrawnAxes(const Camera& seen)
    : origin(seen.target),
      unit((seen.eye - seen.target).norm()),
      camera{Vec3::Zero(), Vec3::Zero(), seen.up, seen.angle} {
  camera.eye = (seen.eye - origin) / unit;
}

RunPainter::RunPainter(const ViewSource& source, const Overview& overview, const RenderOptions& options)
    : source_(source),
      overview_(overview),
      options_(options),
      field_(find_field(source, options.field)),
      range_(colour_range(overview, source.about().view, field_.name)),
      resting_(is_resting(overview, source.about().view, field_.name)),
      camera_(choose_camera(options.camera, source.about(), overview.box,
                            static_cast<double>(options.width) / options.height)),
      axes_(camera_),
      above_ground_(upwards(source.about()).dot(camera_.eye) > overview.ground_top),
      meshes_(source.bodies()) {
  const auto is_free = [](const BodyRecord& b) { return !b.is_wall(); };
  some_free_ = std::any_of(source.bodies().begin(), source.bodies().end(), is_free);
}

Rgb RunPainter::colour_of(const BodyRecord& body, float value) const {
  if (field_.kind == ViewField::Kind::category) return kind_colour(static_cast<std::size_t>(value));
  if (body.is_wall()) return is_solid(body) ? ground_colour : wall_colour;
  if (!range_ || resting_ || range_->front() == range_->back()) return viridis(only_share);
  const double share = (static_cast<double>(value) - range_->front()) / (range_->back() - range_->front());
  return viridis(std::isfinite(share) ? share : 0.0);
}

/// Draws a line 1.5 pixels wide, shifted slightly from the faces towards the eye.
void RunPainter::add_thin_line(Vec3 from, Vec3 to, const Rgb& colour, float opacity, DrawnScene& out) const {
  constexpr double before = 2e-3;
  const double pixel = 2 * std::tan(0.5 * camera_.angle * std::numbers::pi / 180) / options_.height;
  from += before * (camera_.eye - from);
  to += before * (camera_.eye - to);
  const double width = 0.7 * pixel * (0.5 * (from + to) - camera_.eye).norm();
  out.lines.push_back({axes_.place(from), axes_.place(to), axes_.length(width), colour, opacity});
}

void RunPainter::add_edges(std::int32_t mesh, const BodyRecord& body, double scale, const Rgb& colour,
                           DrawnScene& out) {
  constexpr std::size_t most_corners = 60'000;
  const ViewMesh& shape = meshes_.all()[static_cast<std::size_t>(mesh)];
  if (shape.corners.size() > most_corners) return;
  const auto [known, is_new] = edges_.try_emplace(mesh);
  if (is_new) known->second = feature_edges(shape);
  const auto place = [&](std::uint32_t point) -> Vec3 {
    return body.pose.to_world(scale * shape.points[point].cast<double>());
  };
  for (std::size_t k = 0; k + 1 < known->second.size(); k += 2)
    add_thin_line(place(known->second[k]), place(known->second[k + 1]), colour, 1.0f, out);
}

/// Draws a half-space seen from inside: outline and grid of its square.
void RunPainter::add_grid(const ViewMesh& square, const BodyRecord& body, double scale, DrawnScene& out) const {
  const auto corner = [&](std::size_t k) -> Vec3 {
    return body.pose.to_world(scale * square.points[k].cast<double>());
  };
  const Vec3 from = corner(0), u = corner(1) - from, v = corner(3) - from;
  for (int k = 0; k <= grid_parts; ++k) {
    const double share = static_cast<double>(k) / grid_parts;
    const float opacity = k % grid_parts == 0 ? 2 * grid_opacity : grid_opacity;
    for (const auto& [across, along] : {std::pair{u, v}, std::pair{v, u}}) {
      const Vec3 start = from + share * across;
      for (int piece = 0; piece < grid_parts; ++piece)  // each as wide as its own distance wants
        add_thin_line(start + piece * along / grid_parts, start + (piece + 1) * along / grid_parts, wall_edge, opacity,
                      out);
    }
  }
}

bool RunPainter::is_solid(const BodyRecord& wall) const {
  return above_ground_ && std::binary_search(overview_.grounds.begin(), overview_.grounds.end(), wall.id);
}

/// edges: also draws edges of free bodies.
void RunPainter::add_body(const BodyRecord& b, float value, bool edges, DrawnScene& out) {
  Rgb colour = colour_of(b, value);
  if (options_.contacts && !b.is_wall())
    for (std::size_t part = 0; part < 3; ++part) colour[part] = 0.85 * paper[part] + 0.15 * colour[part];
  const MeshStore::Copy copy = meshes_.of(b.surface);
  if (copy.mesh < 0) {
    const bool pale = options_.contacts && !b.is_wall();
    if (std::isfinite(b.radius) && b.radius > 0)
      out.balls.push_back({axes_.place(b.pose.position), axes_.length(b.radius), colour, pale ? pale_opacity : 1.0f});
    return;
  }
  const bool translucent = b.is_wall() && some_free_ && !is_solid(b);
  const ViewMesh& mesh = meshes_.all()[static_cast<std::size_t>(copy.mesh)];
  const bool within = is_within(b, mesh, copy.scale, camera_.eye);
  const float opacity = within                              ? behind_opacity
                        : translucent                       ? wall_opacity
                        : options_.contacts && !b.is_wall() ? pale_opacity
                                                            : 1.0f;
  add_mesh(mesh, b, {copy.scale, colour, opacity}, axes_, out);
  if (within) add_grid(mesh, b, copy.scale, out);
  const bool has_edges = b.is_wall() ? !std::isinf(b.radius) : edges;
  if (!has_edges) return;
  const Rgb edge = !b.is_wall() ? edge_of(colour) : translucent ? wall_edge : ground_edge;
  add_edges(copy.mesh, b, copy.scale, edge, out);
}

Image RunPainter::paint(std::size_t k) {
  const ViewFrame frame = source_.frame(k);
  const std::vector<float> values = FrameFields(frame, source_.about())(field_.name);
  const auto outlined = std::count_if(frame.bodies.begin(), frame.bodies.end(),
                                      [](const BodyRecord& b) { return !b.is_wall() && b.surface != nullptr; });
  DrawnScene scene;
  const bool wanted = options_.contacts;
  options_.contacts = wanted && !frame.contacts.empty();  // without chains the bodies are what there is to see
  for (std::size_t row = 0; row < frame.bodies.size(); ++row)
    add_body(frame.bodies[row], values[row], outlined <= most_outlined && !options_.contacts, scene);
  if (options_.contacts) add_contacts(frame, overview_.strongest, axes_, scene);
  add_springs(frame, source_.about(), axes_, scene);
  Image image = draw_scene(scene, axes_.camera, options_.width, options_.height, paper);
  options_.contacts = wanted;
  if (options_.labels) label(image, frame);
  return image;
}

std::size_t RunPainter::outside(const ViewFrame& frame) const {
  const Camera& seen = axes_.camera;
  const Vec3 towards = (seen.eye - seen.target).normalized(), right = seen.up.cross(towards).normalized(),
             up = towards.cross(right);
  const double high = std::tan(0.5 * seen.angle * std::numbers::pi / 180),
               wide = high * options_.width / options_.height;
  const auto shows = [&](const BodyRecord& b) {
    const Vec3 p = (b.pose.position - axes_.origin) / axes_.unit - seen.eye;
    const double depth = -towards.dot(p), r = b.radius / axes_.unit;
    // a side of the picture is a plane through the eye
    return depth > -r && std::abs(right.dot(p)) - wide * depth <= r * std::hypot(1.0, wide) &&
           std::abs(up.dot(p)) - high * depth <= r * std::hypot(1.0, high);
  };
  return static_cast<std::size_t>(std::count_if(frame.bodies.begin(), frame.bodies.end(),
                                                [&](const BodyRecord& b) { return !b.is_wall() && !shows(b); }));
}

std::string RunPainter::blind_text(const ViewFrame& frame) const {
  const auto free = std::count_if(frame.bodies.begin(), frame.bodies.end(), [](const auto& b) { return !b.is_wall(); });
  if (free == 0 || outside(frame) < static_cast<std::size_t>(free)) return {};
  const auto place = [](const Vec3& p) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", p.x(), p.y(), p.z()); };
  const Vec3 middle = overview_.box.centre();
  return fmt::format(
      "the camera sees none of the {} free bodies: it stands at {} and looks towards {}; the bodies are about {}; "
      "--camera iso shows them",
      free, place(camera_.eye), place(camera_.target), place(middle));
}

std::string RunPainter::dots_text(const ViewFrame& frame) const {
  constexpr double least_covered = 1e-3;  // of the picture: a dust of dots that fills more is seen
  const Camera& seen = axes_.camera;
  const Vec3 towards = (seen.eye - seen.target).normalized();
  const double pixel = 2 * std::tan(0.5 * seen.angle * std::numbers::pi / 180) / options_.height;  // at distance one
  std::size_t shown = 0, dots = 0;
  double covered = 0;  // [pixels]
  for (const BodyRecord& b : frame.bodies) {
    const double depth = towards.dot(seen.eye - (b.pose.position - axes_.origin) / axes_.unit);
    if (b.is_wall() || !std::isfinite(b.radius) || !(depth > 0)) continue;
    const double radius = b.radius / axes_.unit / (pixel * depth);
    ++shown;
    if (radius < 0.5) ++dots;
    covered += std::numbers::pi * radius * radius;
  }
  const bool is_seen = covered > least_covered * options_.width * options_.height;
  if (2 * dots <= shown || is_seen) return {};
  return fmt::format("{} of {} bodies {} smaller than a pixel here", dots, shown, dots == 1 ? "is" : "are");
}

std::string outside_text(std::size_t bodies) {
  return bodies == 0 ? "" : fmt::format("{} {} outside the picture", bodies, bodies == 1 ? "body" : "bodies");
}

namespace {

std::vector<std::string> outline_notes(const RunPainter& painter) {
  const std::string missing = painter.unwritable();
  if (missing.empty()) return {};
  return {"the font of pictures has no " + missing + ": drawn as codes in boxes"};
}

/// Text common to start, middle and end of a film.
template <class Text>
std::string throughout(const ViewSource& source, std::size_t every, const Text& text_of) {
  const std::size_t last = (source.times().size() - 1) / every;
  std::string text;
  for (const std::size_t k : {std::size_t{0}, last / 2, last}) {
    text = text_of(source.frame(k * every));
    if (text.empty()) return {};
  }
  return text;
}

std::vector<std::string> notes_of(const ViewSource& source, const RunPainter& painter, const RenderOptions& options,
                                  const std::string& blind, const std::string& dots) {
  std::vector<std::string> notes = view_notes(source, options.camera, options.field);
  for (const std::string& note : outline_notes(painter)) notes.push_back(note);
  if (!blind.empty()) notes.push_back(blind);
  if (!dots.empty()) notes.push_back(dots);
  return notes;
}

}  // namespace

std::vector<std::string> view_notes(const ViewSource& source, const std::string& camera, const std::string& field) {
  const ViewSettings& view = source.about().view;
  std::vector<std::string> out;
  if (camera == "scene" && view.preset.empty() && !view.from)
    out.push_back("the scene has no [view] camera: the picture is seen from " + camera_presets().front().first);
  if (!field.empty() || view.field.empty()) return out;
  std::string known;
  for (const ViewField& f : view_fields(source)) {
    if (f.name == view.field) return out;
    known += (known.empty() ? "" : ", ") + f.name;
  }
  out.push_back("there is no field '" + view.field + "' here, which [view] field names: colours show " +
                view_fields(source).front().name + "; there are " + known);
  return out;
}

std::vector<std::string> render_picture(const ViewSource& source, const RenderOptions& options, std::size_t frame,
                                        const std::filesystem::path& target) {
  const Overview overview = look_over(source);
  RunPainter painter(source, overview, options);
  write_whole_file(target, {png_of(painter.paint(frame))});
  const ViewFrame shown = source.frame(frame);
  return notes_of(source, painter, options, painter.blind_text(shown), painter.dots_text(shown));
}

WrittenFilm render_film(const ViewSource& source, const RenderOptions& options, std::size_t every,
                        const std::filesystem::path& target) {
  const Overview overview = look_over(source);
  RunPainter painter(source, overview, options);
  const std::size_t pictures = (source.times().size() + every - 1) / every;
  const double rate = film_rate(pictures);
  Film film(target, options.width, options.height, rate);
  for (std::size_t k = 0; k < source.times().size(); k += every) film.add(painter.paint(k));
  film.finish();
  const auto blind = throughout(source, every, [&](const ViewFrame& frame) { return painter.blind_text(frame); });
  const auto dots = throughout(source, every, [&](const ViewFrame& frame) { return painter.dots_text(frame); });
  return {pictures, rate, notes_of(source, painter, options, blind, dots)};
}

}  // namespace epafi
