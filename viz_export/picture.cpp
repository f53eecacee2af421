#include "viz_export/picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace epafi {
namespace {

/// Something to draw: `depth` along the view, larger is nearer.
struct Stroke {
  double depth;
  std::string svg;
};

struct Camera {
  Vec3 right, up, towards;  ///< unit; towards the eye
  double scale = 1.0;       ///< pixels per metre
  double x0 = 0.0, y0 = 0.0;

  explicit Camera(const Vec3& from) : towards(from.normalized()) {
    const Vec3 across = Vec3::UnitZ().cross(towards);
    right = across.norm() > 1e-9 ? Vec3(across.normalized()) : Vec3(Vec3::UnitX());
    up = towards.cross(right);
  }
  double x(const Vec3& p) const { return x0 + scale * right.dot(p); }
  double y(const Vec3& p) const { return y0 - scale * up.dot(p); }
};

struct Colour {
  double r, g, b;
  std::string hex(double light) const {
    const auto part = [&](double v) { return static_cast<int>(std::lround(255 * std::clamp(v * light, 0.0, 1.0))); };
    return fmt::format("#{:02x}{:02x}{:02x}", part(r), part(g), part(b));
  }
};

/// From slate over teal and green to yellow: lightness grows, so it reads in grey as well.
Colour colour_of(double share) {
  constexpr Colour stops[] = {{0.35, 0.40, 0.58}, {0.20, 0.52, 0.62}, {0.25, 0.68, 0.52}, {0.60, 0.80, 0.32}, {0.98, 0.88, 0.20}};
  const double at = 4 * std::clamp(share, 0.0, 1.0);
  const auto k = std::min<std::size_t>(3, static_cast<std::size_t>(at));
  const double t = at - static_cast<double>(k);
  const auto mix = [&](double a, double b) { return a + t * (b - a); };
  return {mix(stops[k].r, stops[k + 1].r), mix(stops[k].g, stops[k + 1].g), mix(stops[k].b, stops[k + 1].b)};
}

bool is_plane(const BodyRecord& b) { return !std::isfinite(b.radius); }

/// Scale and place so that the free bodies are inside, with a fifth of their extent of the walls around them; all bodies
/// but planes where none is free.
void frame(Camera& camera, const StoredSnapshot& snapshot, const PictureView& view) {
  double left = INFINITY, right = -INFINITY, low = INFINITY, high = -INFINITY;
  const auto include = [&](const Vec3& p, double r) {
    const double x = camera.right.dot(p), y = camera.up.dot(p);
    left = std::min(left, x - r), right = std::max(right, x + r), low = std::min(low, y - r), high = std::max(high, y + r);
  };
  const bool some_free = std::any_of(snapshot.bodies.begin(), snapshot.bodies.end(), [](const BodyRecord& b) { return !b.is_wall(); });
  for (const BodyRecord& b : snapshot.bodies) {
    if (is_plane(b) || (some_free && b.is_wall())) continue;
    if (b.surface == nullptr) include(b.pose.position, b.radius);
    else
      for (const Vec3& p : b.surface->points) include(b.pose.to_world(p), 0.0);
  }
  if (!(left < right)) left = low = -1, right = high = 1;
  const double margin = some_free ? 0.12 * std::min(view.width, view.height) : 14;
  camera.scale = std::min((view.width - 2 * margin) / (right - left), (view.height - 2 * margin) / std::max(high - low, 1e-12));
  camera.x0 = 0.5 * view.width - 0.5 * camera.scale * (left + right);
  camera.y0 = 0.5 * view.height + 0.5 * camera.scale * (low + high);
}

void add_faces(const BodyRecord& b, const Camera& camera, const Colour& colour, std::vector<Stroke>& out) {
  const Surface& s = *b.surface;
  const Vec3 light = (camera.towards + 0.6 * camera.up - 0.4 * camera.right).normalized();
  const bool wall = b.is_wall();
  std::int32_t begin = 0;
  for (const std::int32_t end : s.offsets) {
    std::string points;
    Vec3 middle = Vec3::Zero(), normal = Vec3::Zero();
    const Vec3 first = b.pose.to_world(s.points[static_cast<std::size_t>(s.connectivity[static_cast<std::size_t>(begin)])]);
    Vec3 before = first;
    for (std::int32_t k = begin; k < end; ++k) {
      const Vec3 p = b.pose.to_world(s.points[static_cast<std::size_t>(s.connectivity[static_cast<std::size_t>(k)])]);
      points += fmt::format("{:.1f},{:.1f} ", camera.x(p), camera.y(p));
      middle += p, normal += (before - first).cross(p - first), before = p;
    }
    middle /= std::max(1, end - begin), begin = end;
    const double facing = normal.dot(camera.towards);
    if (wall) {  // behind everything, so that they hide nothing
      out.push_back({camera.towards.dot(middle) - 1e9,
                     fmt::format("<polygon points='{}' fill='#e8eaee' fill-opacity='.35' stroke='#b8bcc6' stroke-width='.4'/>", points)});
    } else if (facing > 0) {
      const double shade = 0.55 + 0.5 * std::max(0.0, normal.normalized().dot(light));
      const std::string fill = colour.hex(shade);
      out.push_back({camera.towards.dot(middle), fmt::format("<polygon points='{}' fill='{}' stroke='{}' stroke-width='.5'/>", points,
                                                             fill, colour.hex(0.45))});
    }
  }
}

}  // namespace

std::string picture_svg(const StoredSnapshot& snapshot, const PictureView& view, double fastest) {
  Camera camera(view.from);
  frame(camera, snapshot, view);
  if (!(fastest > 0))
    for (const BodyRecord& b : snapshot.bodies) fastest = std::max(fastest, b.is_wall() ? 0.0 : b.velocity.norm());
  std::vector<Stroke> strokes;
  for (const BodyRecord& b : snapshot.bodies) {
    const Colour colour = colour_of(fastest > 0 ? b.velocity.norm() / fastest : 0.0);
    if (b.surface != nullptr) {
      add_faces(b, camera, colour, strokes);
      continue;
    }
    const Vec3& x = b.pose.position;
    strokes.push_back({camera.towards.dot(x), fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='{:.2f}' fill='{}' stroke='{}' stroke-width='.5'/>",
                                                          camera.x(x), camera.y(x), camera.scale * b.radius, colour.hex(1.0), colour.hex(0.5))});
  }
  std::stable_sort(strokes.begin(), strokes.end(), [](const Stroke& a, const Stroke& b) { return a.depth < b.depth; });
  const std::size_t skip = strokes.size() > view.most ? strokes.size() - view.most : 0;
  std::string out = fmt::format("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {} {}' width='{}' height='{}' role='img'>", view.width,
                                view.height, view.width, view.height);
  out += "<rect width='100%' height='100%' fill='#fbfbfc'/>";
  for (std::size_t k = skip; k < strokes.size(); ++k) out += strokes[k].svg;
  return out + "</svg>";
}

}  // namespace epafi
