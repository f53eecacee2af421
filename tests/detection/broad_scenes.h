/// @file broad_scenes.h  Random scenes for the broad phases, and the pair list by its definition: every pair, every
/// test in full.
#pragma once
#include <algorithm>
#include <cmath>
#include <string>

#include "detection/broad/all_broad_phases.h"
#include "engine/units/random.h"

namespace epafi::test {

struct BroadScene {
  World world;
  ShapeStore shapes;
  BroadSetup setup;

  BroadScene() = default;
  BroadScene(BroadScene&& o) : world(std::move(o.world)), shapes(std::move(o.shapes)), setup(o.setup) {
    setup.shapes = &shapes;
  }

  BodyId add_sphere(const Vec3& x, double r, const Vec3& v = Vec3::Zero(), bool free = true) {
    Body b;
    b.position = x;
    b.velocity = v;
    b.mass = free ? r * r * r : 0.0;
    b.inertia = Vec3::Constant(r * r * r * r * r);
    b.shape = shapes.add(Sphere{r}).packed;
    return world.add(b);
  }
  BodyId add_plane(const Vec3& x, const Vec3& n) {
    Body b;
    b.position = x;
    b.shape = shapes.add(HalfSpace{n.normalized()}).packed;
    return world.add(b);
  }
};

inline Vec3 random_point(Random& r, double edge) {
  return Vec3(r.uniform(-1, 1), r.uniform(-1, 1), r.uniform(-1, 1)) * edge;
}

/// Kinds: mono, lognormal (1:10), bimodal (1:100), wide (1:1000), clustered, line. Velocities 1 % of the radius per
/// second. `unit` scales all lengths.
inline BroadScene random_scene(const std::string& kind, int n, std::uint64_t seed, double unit = 1.0,
                               Vec3 shift = Vec3::Zero()) {
  BroadScene scene;
  scene.setup.shapes = &scene.shapes;
  Random random(seed, 1);
  const double edge = std::cbrt(static_cast<double>(n)) * 0.6;
  for (int i = 0; i < n; ++i) {
    double r = 0.5;
    if (kind == "lognormal") r *= std::exp(random.uniform(-1.15, 1.15));
    if (kind == "bimodal" && i % 400 == 7) r *= 100.0;
    if (kind == "wide") r *= std::exp(std::pow(random.uniform(), 4.0) * 6.9);
    Vec3 x = random_point(random, edge);
    if (kind == "clustered")
      x = x * 0.1 + random_point(random, 1.0).array().sign().matrix() * edge * (i % 7 == 0 ? 1000.0 : 1.0);
    if (kind == "line") x = Vec3(x.x() * edge * edge, 0.3 * x.y(), 0.3 * x.z());
    scene.add_sphere(unit * x + shift, unit * r, 0.01 * unit * r * random_point(random, 1.0));
  }
  return scene;
}

/// The list by definition, for spheres, half-spaces and one margin for all: fat = exact + (reach + margin)/2 on every
/// side.
inline PairColumn pairs_by_definition(const BroadScene& scene, const World& world) {
  const double fat = 0.5 * (scene.setup.reach + scene.setup.margin);
  PairColumn out;
  for (Slot i = 0; i < world.size(); ++i)
    for (Slot j = i + 1; j < world.size(); ++j) {
      if (!world.is_movable(i) && !world.is_movable(j)) continue;
      const double ri = scene.shapes.bounding_radius({world.shape[i]}),
                   rj = scene.shapes.bounding_radius({world.shape[j]});
      const Vec3 d = world.position[j] - world.position[i];
      bool near = d.squaredNorm() <= (ri + rj + 2 * fat) * (ri + rj + 2 * fat);
      if (std::isinf(ri) || std::isinf(rj)) {
        const ShapeRef plane{world.shape[std::isinf(ri) ? i : j]};
        const Vec3 n = scene.shapes.of<HalfSpace>()[plane.index()].normal;
        near = n.dot(std::isinf(ri) ? d : Vec3(-d)) - std::min(ri, rj) <= 2 * fat;  // the ball is inside its box
      }
      if (!near) continue;
      world.id[i] < world.id[j] ? out.push_back({i, j}) : out.push_back({j, i});
    }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace epafi::test
