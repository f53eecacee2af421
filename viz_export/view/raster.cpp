#include "viz_export/view/raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace epafi {
namespace {

using V3 = Eigen::Vector3f;
constexpr int samples = 2;  // along each side of a pixel
constexpr float nowhere = std::numeric_limits<float>::infinity();

/// Camera axes: x right, y up, z towards the eye; depth is measured along -z.
struct Lens {
  V3 eye, right, up, towards;
  float scale, cx, cy;  ///< samples per unit of the plane at distance 1, and its middle
  float nearest;        ///< nothing nearer is drawn

  Lens(const Camera& c, int w, int h)
      : eye(c.eye.cast<float>()), nearest(static_cast<float>(1e-4 * (c.eye - c.target).norm())) {
    const Vec3 back = (c.eye - c.target).normalized();
    const Vec3 side = c.up.cross(back).normalized();
    towards = back.cast<float>();
    right = side.cast<float>();
    up = back.cross(side).cast<float>();
    scale = static_cast<float>(0.5 * h / std::tan(0.5 * c.angle * std::numbers::pi / 180.0));
    cx = 0.5f * static_cast<float>(w);
    cy = 0.5f * static_cast<float>(h);
  }
  /// x, y, and the depth in front of the eye.
  V3 seen(const V3& p) const {
    const V3 r = p - eye;
    return {right.dot(r), up.dot(r), -towards.dot(r)};
  }
  V3 turned(const V3& n) const { return {right.dot(n), up.dot(n), towards.dot(n)}; }
};

/// Depth and object of each sample (objects: balls, then triangles, then lines).
struct Layer {
  int w, h;
  std::vector<float> depth;
  std::vector<std::uint32_t> thing;
  Layer(int width, int height) : w(width), h(height), depth(count(), nowhere), thing(count(), ~0u) {}
  std::size_t count() const { return static_cast<std::size_t>(w) * static_cast<std::size_t>(h); }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(w) + static_cast<std::size_t>(x);
  }
};

struct SampleBox {
  int x0, x1, y0, y1;
};

SampleBox clamped(float x0, float x1, float y0, float y1, const Layer& layer) {
  const auto limit = [](float v, int most) { return static_cast<int>(std::clamp(v, 0.0f, static_cast<float>(most))); };
  return {limit(std::floor(x0), layer.w), limit(std::ceil(x1) + 1, layer.w), limit(std::floor(y0), layer.h),
          limit(std::ceil(y1) + 1, layer.h)};
}

/// Ends of a ball's outline along one axis of the plane at distance 1: tangents through the eye (Mara and Morgan 2013).
/// across: of the centre, z its distance > r.
std::array<float, 2> outline(float across, float z, float r) {
  const float rest = z * z - r * r;
  const float swing = r * std::sqrt(across * across + rest);
  return {(across * z - swing) / rest, (across * z + swing) / rest};
}

SampleBox box_of_ball(const V3& c, float r, const Lens& lens, const Layer& layer) {
  if (c.z() <= r * 1.001f) return {0, layer.w, 0, layer.h};  // it reaches beside the eye
  const auto [left, right] = outline(c.x(), c.z(), r);
  const auto [low, high] = outline(c.y(), c.z(), r);
  return clamped(lens.cx + lens.scale * left, lens.cx + lens.scale * right, lens.cy - lens.scale * high,
                 lens.cy - lens.scale * low, layer);
}

/// Calls f(x, y, depth) for each sample of the layer that shows the ball; none where the eye is inside it.
template <class F>
void each_of_ball(const V3& c, float r, const Lens& lens, const Layer& layer, const F& f) {
  const float rest = c.squaredNorm() - r * r;
  if (c.z() <= lens.nearest - r || rest <= 0) return;
  const SampleBox box = box_of_ball(c, r, lens, layer);
  for (int y = box.y0; y < box.y1; ++y) {
    const float v = (lens.cy - static_cast<float>(y) - 0.5f) / lens.scale;
    for (int x = box.x0; x < box.x1; ++x) {
      const float u = (static_cast<float>(x) + 0.5f - lens.cx) / lens.scale;
      const float square = u * u + v * v + 1;
      const float along = u * c.x() + v * c.y() + c.z();
      const float under = along * along - square * rest;
      if (under < 0) continue;
      const float depth = (along - std::sqrt(under)) / square;
      if (depth >= lens.nearest) f(x, y, depth);
    }
  }
}

/// A triangle in sample coordinates. Barycentric weights over depth are linear there, also with a corner behind the
/// eye, so that no clipping is needed (Olano and Greer 1997).
struct FlatTriangle {
  SampleBox box{};
  V3 first, by_x, by_y;  ///< at the middle of the box's first sample, and per sample

  /// False where no part is in front of the eye.
  bool set(const V3 p[3], const Lens& lens, const Layer& layer) {
    if (!set_box(p, lens, layer)) return false;
    const Vec3 q[3] = {p[0].cast<double>(), p[1].cast<double>(), p[2].cast<double>()};
    const double volume = q[0].dot((q[1] - q[0]).cross(q[2] - q[0]));
    if (volume == 0) return false;
    const double step = 1.0 / static_cast<double>(lens.scale);
    const Vec3 ray(step * (static_cast<double>(box.x0) + 0.5 - static_cast<double>(lens.cx)),
                   step * (static_cast<double>(lens.cy) - static_cast<double>(box.y0) - 0.5), 1.0);
    for (int k = 0; k < 3; ++k) {
      const Vec3 &a = q[(k + 1) % 3], &b = q[(k + 2) % 3];
      const Vec3 side = a.cross(b - a) / volume;
      first[k] = static_cast<float>(side.dot(ray));
      by_x[k] = static_cast<float>(side.x() * step);
      by_y[k] = static_cast<float>(-side.y() * step);
    }
    return true;
  }
  V3 weights(int x, int y) const {
    return first + static_cast<float>(x - box.x0) * by_x + static_cast<float>(y - box.y0) * by_y;
  }
  /// Calls f(x, y, weights over depth, depth) for each sample inside.
  template <class F>
  void each(const Lens& lens, const F& f) const {
    for (int y = box.y0; y < box.y1; ++y)
      for (int x = box.x0; x < box.x1; ++x) {
        const V3 w = weights(x, y);
        const float inverse = w.sum();
        if (w.minCoeff() >= 0 && inverse > 0 && inverse * lens.nearest <= 1) f(x, y, w, 1 / inverse);
      }
  }

 private:
  /// Sets the bounding box of the part beyond the near plane.
  bool set_box(const V3 p[3], const Lens& lens, const Layer& layer) {
    float x0 = nowhere, x1 = -nowhere, y0 = nowhere, y1 = -nowhere;
    const auto include = [&](const V3& q) {
      const float x = lens.cx + lens.scale * q.x() / q.z(), y = lens.cy - lens.scale * q.y() / q.z();
      x0 = std::min(x0, x);
      x1 = std::max(x1, x);
      y0 = std::min(y0, y);
      y1 = std::max(y1, y);
    };
    for (int k = 0; k < 3; ++k) {
      const V3 &a = p[k], &b = p[(k + 1) % 3];
      if (a.z() >= lens.nearest) include(a);
      if ((a.z() >= lens.nearest) == (b.z() >= lens.nearest)) continue;
      V3 cut = a + (lens.nearest - a.z()) / (b.z() - a.z()) * (b - a);
      cut.z() = lens.nearest;
      include(cut);
    }
    if (!(x0 <= x1)) return false;
    box = clamped(x0, x1, y0, y1, layer);
    return box.x0 < box.x1 && box.y0 < box.y1;
  }
};

/// Lighting as on the page (page/shaders.js).
V3 lit(const Rgb& base, const V3& n) {
  static const V3 lamp = V3(-0.45f, 0.65f, 1.0f).normalized();
  static const V3 half = (lamp + V3(0, 0, 1)).normalized();
  const float diffuse = std::max(0.0f, n.dot(lamp));
  float shine = std::max(0.0f, n.dot(half));
  for (int k = 0; k < 5; ++k) shine *= shine;  // the 32nd power
  const float light = (0.42f + 0.08f * n.y() + 0.62f * diffuse) * (0.82f + 0.18f * n.z());
  return V3(static_cast<float>(base[0]), static_cast<float>(base[1]), static_cast<float>(base[2])) * light +
         V3::Constant(0.10f * shine);
}

class Painter {
 public:
  Painter(const DrawnScene& scene, const Camera& camera, int width, int height, const Rgb& background)
      : scene_(scene),
        lens_(camera, samples * width, samples * height),
        layer_(samples * width, samples * height),
        colour_(layer_.count(), V3(static_cast<float>(background[0]), static_cast<float>(background[1]),
                                   static_cast<float>(background[2]))) {}

  void find_nearest() {
    for (std::size_t k = 0; k < scene_.balls.size(); ++k) {
      const DrawnBall& ball = scene_.balls[k];
      if (ball.opacity >= 1)
        each_of_ball(lens_.seen(ball.centre), ball.radius, lens_, layer_,
                     [&](int x, int y, float depth) { put(k, x, y, depth); });
    }
    const std::size_t first = scene_.balls.size();
    for (std::size_t k = 0; k < scene_.triangles.size(); ++k)
      if (scene_.triangles[k].opacity >= 1) mark(corners_of(scene_.triangles[k]).data(), first + k);
    for (std::size_t k = 0; k < scene_.lines.size(); ++k)
      if (scene_.lines[k].opacity >= 1)
        each_half(scene_.lines[k], [&](const V3 p[3]) { mark(p, first + scene_.triangles.size() + k); });
  }

  void light() {
    for (int y = 0; y < layer_.h; ++y)
      for (int x = 0; x < layer_.w; ++x) {
        const std::size_t k = layer_.at(x, y);
        if (layer_.thing[k] != ~0u) colour_[k] = colour_of(layer_.thing[k], x, y, layer_.depth[k]);
      }
  }

  void lay_over() {
    for (const DrawnBall& ball : scene_.balls) {
      if (ball.opacity >= 1) continue;
      const V3 centre = lens_.seen(ball.centre);
      each_of_ball(centre, ball.radius, lens_, layer_, [&](int x, int y, float depth) {
        const std::size_t k = layer_.at(x, y);
        if (depth < layer_.depth[k])
          colour_[k] += ball.opacity * (lit(ball.colour, normal_of(ball, centre, x, y, depth)) - colour_[k]);
      });
    }
    for (const DrawnTriangle& t : scene_.triangles) {
      if (t.opacity >= 1) continue;
      FlatTriangle flat{};
      if (!flat.set(corners_of(t).data(), lens_, layer_)) continue;
      flat.each(lens_, [&](int x, int y, const V3& w, float depth) {
        const std::size_t k = layer_.at(x, y);
        if (depth < layer_.depth[k]) colour_[k] += t.opacity * (lit(t.colour, normal_of(t, w)) - colour_[k]);
      });
    }
    for (const DrawnLine& line : scene_.lines)
      if (line.opacity < 1) each_half(line, [&](const V3 p[3]) { lay_over(p, line); });
  }

  Image image() const {
    Image out(layer_.w / samples, layer_.h / samples);
    for (int y = 0; y < out.height; ++y)
      for (int x = 0; x < out.width; ++x) {
        V3 sum = V3::Zero();
        for (int sy = 0; sy < samples; ++sy)
          for (int sx = 0; sx < samples; ++sx) sum += colour_[layer_.at(samples * x + sx, samples * y + sy)];
        sum *= 255.0f / (samples * samples);
        for (int part = 0; part < 3; ++part)
          out.at(x, y)[part] = static_cast<std::uint8_t>(std::clamp(sum[part] + 0.5f, 0.0f, 255.0f));
      }
    return out;
  }

 private:
  std::array<V3, 3> corners_of(const DrawnTriangle& t) const {
    return {lens_.seen(t.corner[0]), lens_.seen(t.corner[1]), lens_.seen(t.corner[2])};
  }

  void mark(const V3 p[3], std::size_t thing) {
    FlatTriangle flat{};
    if (!flat.set(p, lens_, layer_)) return;
    flat.each(lens_, [&](int x, int y, const V3&, float depth) { put(thing, x, y, depth); });
  }

  /// Sets a sample where nothing is nearer.
  void put(std::size_t thing, int x, int y, float depth) {
    const std::size_t k = layer_.at(x, y);
    if (depth >= layer_.depth[k]) return;
    layer_.depth[k] = depth;
    layer_.thing[k] = static_cast<std::uint32_t>(thing);
  }

  void lay_over(const V3 p[3], const DrawnLine& line) {
    FlatTriangle flat{};
    if (!flat.set(p, lens_, layer_)) return;
    const V3 colour = lit(line.colour, V3(0, 0, 1));
    flat.each(lens_, [&](int x, int y, const V3&, float depth) {
      const std::size_t k = layer_.at(x, y);
      if (depth < layer_.depth[k]) colour_[k] += line.opacity * (colour - colour_[k]);
    });
  }

  /// Calls f(corners) for the two triangles of a ribbon.
  template <class F>
  void each_half(const DrawnLine& line, const F& f) const {
    const V3 a = lens_.seen(line.from), b = lens_.seen(line.to);
    V3 side = (b - a).cross(a);
    if (!(side.norm() > 0)) return;
    side *= line.width / side.norm();
    const V3 one[3] = {a - side, a + side, b - side}, two[3] = {b - side, a + side, b + side};
    f(one);
    f(two);
  }

  /// Normal towards the eye, in camera axes. w: weights of the corners, not normalised.
  V3 normal_of(const DrawnTriangle& t, const V3& w) const {
    V3 n = lens_.turned(w.x() * t.normal[0] + w.y() * t.normal[1] + w.z() * t.normal[2]);
    n.normalize();
    if (n.z() >= 0) return n;
    if (!shows_front(t)) return -n;
    n.z() = 0;  // beyond the outline of the curved surface that the triangle stands for
    return n.normalized();
  }

  bool shows_front(const DrawnTriangle& t) const {
    const V3 facet = (t.corner[1] - t.corner[0]).cross(t.corner[2] - t.corner[0]);
    const bool outward = facet.dot(t.normal[0] + t.normal[1] + t.normal[2]) > 0;
    return outward == (facet.dot(lens_.eye - t.corner[0]) > 0);
  }

  V3 normal_of(const DrawnBall& ball, const V3& centre, int x, int y, float depth) const {
    const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
    const V3 hit((px - lens_.cx) / lens_.scale * depth, (lens_.cy - py) / lens_.scale * depth, depth);
    const V3 n = (hit - centre) / ball.radius;
    return {n.x(), n.y(), -n.z()};
  }

  V3 colour_of(std::uint32_t thing, int x, int y, float depth) {
    std::size_t k = thing;
    if (k < scene_.balls.size()) {
      const DrawnBall& ball = scene_.balls[k];
      return lit(ball.colour, normal_of(ball, lens_.seen(ball.centre), x, y, depth));
    }
    k -= scene_.balls.size();
    if (k < scene_.triangles.size()) {
      if (thing != set_) {  // samples of one triangle follow each other
        last_.set(corners_of(scene_.triangles[k]).data(), lens_, layer_);
        set_ = thing;
      }
      return lit(scene_.triangles[k].colour, normal_of(scene_.triangles[k], last_.weights(x, y)));
    }
    return lit(scene_.lines[k - scene_.triangles.size()].colour, V3(0, 0, 1));
  }

  const DrawnScene& scene_;
  Lens lens_;
  Layer layer_;
  std::vector<V3> colour_;
  FlatTriangle last_{};      ///< that was lit
  std::uint32_t set_ = ~0u;  ///< its number among the things
};

}  // namespace

Image draw_scene(const DrawnScene& scene, const Camera& camera, int width, int height, const Rgb& background) {
  Painter painter(scene, camera, width, height, background);
  painter.find_nearest();
  painter.light();
  painter.lay_over();
  return painter.image();
}

}  // namespace epafi
