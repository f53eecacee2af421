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

/// Axes of the camera: x right, y up, z towards the eye; distances count along -z.
struct Lens {
  V3 eye, right, up, towards;
  float scale, cx, cy;  ///< samples per unit of the plane at distance 1, and its middle

  Lens(const Camera& c, int w, int h) : eye(c.eye.cast<float>()) {
    const Vec3 back = (c.eye - c.target).normalized();
    const Vec3 side = c.up.cross(back).normalized();
    towards = back.cast<float>();
    right = side.cast<float>();
    up = back.cross(side).cast<float>();
    scale = static_cast<float>(0.5 * h / std::tan(0.5 * c.angle * std::numbers::pi / 180.0));
    cx = 0.5f * static_cast<float>(w);
    cy = 0.5f * static_cast<float>(h);
  }
  /// x, y, and the distance in front of the eye.
  V3 seen(const V3& p) const {
    const V3 r = p - eye;
    return {right.dot(r), up.dot(r), -towards.dot(r)};
  }
  V3 turned(const V3& n) const { return {right.dot(n), up.dot(n), towards.dot(n)}; }
};

/// What each sample shows: depth, and the thing (balls first, then triangles, then lines).
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

/// f(x, y, depth) of each sample of the layer that shows the ball.
template <class F>
void each_of_ball(const V3& c, float r, const Lens& lens, const Layer& layer, const F& f) {
  if (c.z() <= r * 1.001f) return;
  const float reach = lens.scale * r / (c.z() - r);
  const float px = lens.cx + lens.scale * c.x() / c.z(), py = lens.cy - lens.scale * c.y() / c.z();
  const SampleBox box = clamped(px - reach, px + reach, py - reach, py + reach, layer);
  const float rest = c.squaredNorm() - r * r;
  for (int y = box.y0; y < box.y1; ++y) {
    const float v = (lens.cy - static_cast<float>(y) - 0.5f) / lens.scale;
    for (int x = box.x0; x < box.x1; ++x) {
      const float u = (static_cast<float>(x) + 0.5f - lens.cx) / lens.scale;
      const float square = u * u + v * v + 1;
      const float along = u * c.x() + v * c.y() + c.z();
      const float under = along * along - square * rest;
      if (under < 0) continue;
      const float depth = (along - std::sqrt(under)) / square;
      f(x, y, depth);
    }
  }
}

/// A triangle in samples, with 1/depth, which is linear there.
struct FlatTriangle {
  float x[3], y[3], inverse[3];
  float area = 0;

  /// false where a corner is behind the eye, or nothing is left.
  bool set(const V3 p[3], const Lens& lens) {
    for (int k = 0; k < 3; ++k) {
      if (p[k].z() <= 1e-6f) return false;
      inverse[k] = 1 / p[k].z();
      x[k] = lens.cx + lens.scale * p[k].x() * inverse[k];
      y[k] = lens.cy - lens.scale * p[k].y() * inverse[k];
    }
    area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    return area != 0;
  }
  V3 weights(float px, float py) const {
    const float b = ((px - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (py - y[0])) / area;
    const float c = ((x[1] - x[0]) * (py - y[0]) - (px - x[0]) * (y[1] - y[0])) / area;
    return {1 - b - c, b, c};
  }
  /// f(x, y, weights, depth) of each sample inside.
  template <class F>
  void each(const Layer& layer, const F& f) const {
    const SampleBox box = clamped(std::min({x[0], x[1], x[2]}), std::max({x[0], x[1], x[2]}),
                                  std::min({y[0], y[1], y[2]}), std::max({y[0], y[1], y[2]}), layer);
    for (int sy = box.y0; sy < box.y1; ++sy)
      for (int sx = box.x0; sx < box.x1; ++sx) {
        const V3 w = weights(static_cast<float>(sx) + 0.5f, static_cast<float>(sy) + 0.5f);
        if (w.minCoeff() < 0) continue;
        f(sx, sy, w, 1 / (w.x() * inverse[0] + w.y() * inverse[1] + w.z() * inverse[2]));
      }
  }
};

/// The same light as the page (page/shaders.js).
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
      mark_line(scene_.lines[k], first + scene_.triangles.size() + k);
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
      if (!flat.set(corners_of(t).data(), lens_)) continue;
      flat.each(layer_, [&](int x, int y, const V3& w, float depth) {
        const std::size_t k = layer_.at(x, y);
        if (depth < layer_.depth[k]) colour_[k] += t.opacity * (lit(t.colour, normal_of(t, w, flat)) - colour_[k]);
      });
    }
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
    if (!flat.set(p, lens_)) return;
    flat.each(layer_, [&](int x, int y, const V3&, float depth) { put(thing, x, y, depth); });
  }

  /// Where nothing nearer is.
  void put(std::size_t thing, int x, int y, float depth) {
    const std::size_t k = layer_.at(x, y);
    if (depth >= layer_.depth[k]) return;
    layer_.depth[k] = depth;
    layer_.thing[k] = static_cast<std::uint32_t>(thing);
  }

  void mark_line(const DrawnLine& line, std::size_t thing) {
    const V3 a = lens_.seen(line.from), b = lens_.seen(line.to);
    V3 side = (b - a).cross(a);
    if (!(side.norm() > 0)) return;
    side *= line.width / side.norm();
    const V3 one[3] = {a - side, a + side, b - side}, two[3] = {b - side, a + side, b + side};
    mark(one, thing);
    mark(two, thing);
  }

  /// Towards the eye, in axes of the camera.
  V3 normal_of(const DrawnTriangle& t, const V3& w, const FlatTriangle& flat) const {
    const V3 true_weights(w.x() * flat.inverse[0], w.y() * flat.inverse[1], w.z() * flat.inverse[2]);
    V3 n =
        lens_.turned(true_weights.x() * t.normal[0] + true_weights.y() * t.normal[1] + true_weights.z() * t.normal[2]);
    n.normalize();
    return n.z() < 0 ? V3(-n) : n;
  }

  V3 normal_of(const DrawnBall& ball, const V3& centre, int x, int y, float depth) const {
    const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
    const V3 hit((px - lens_.cx) / lens_.scale * depth, (lens_.cy - py) / lens_.scale * depth, depth);
    const V3 n = (hit - centre) / ball.radius;
    return {n.x(), n.y(), -n.z()};
  }

  V3 colour_of(std::uint32_t thing, int x, int y, float depth) const {
    const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
    std::size_t k = thing;
    if (k < scene_.balls.size()) {
      const DrawnBall& ball = scene_.balls[k];
      return lit(ball.colour, normal_of(ball, lens_.seen(ball.centre), x, y, depth));
    }
    k -= scene_.balls.size();
    if (k < scene_.triangles.size()) {
      FlatTriangle flat{};
      flat.set(corners_of(scene_.triangles[k]).data(), lens_);
      return lit(scene_.triangles[k].colour, normal_of(scene_.triangles[k], flat.weights(px, py), flat));
    }
    return lit(scene_.lines[k - scene_.triangles.size()].colour, V3(0, 0, 1));
  }

  const DrawnScene& scene_;
  Lens lens_;
  Layer layer_;
  std::vector<V3> colour_;
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
