#include "scenes/time_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "laws/smooth/critical_step.h"
#include "scenes/contact_setup.h"

namespace epafi {

namespace {

/// Smallest free body of a material.
struct Smallest {
  double mass = infinity, radius = infinity;
  bool round = true;  ///< spheres touch at one point and do not turn under its normal force
};

struct Survey {
  std::map<std::uint16_t, Smallest> free;  ///< by material
  std::map<std::uint16_t, bool> held;      ///< materials of fixed and driven bodies
  std::size_t free_bodies = 0, held_bodies = 0;
  double speed = 0.0;          ///< largest of the start and of the fall through the bodies' height [m/s]
  double diameter = infinity;  ///< of the smallest free body [m]
};

Survey survey(const Assembly& a) {
  const World& w = a.simulation->world;
  Survey out;
  const double g = w.gravity.norm();
  const Vec3 down = g > 0 ? Vec3(w.gravity / g) : -Vec3::UnitZ();
  double low = infinity, high = -infinity, fastest = 0;
  for (Slot s = 0; s < w.size(); ++s) {
    fastest = std::max(fastest, w.velocity[s].norm());
    if (!w.is_movable(s)) {
      out.held[w.material[s]] = true, ++out.held_bodies;
      continue;
    }
    ++out.free_bodies;
    auto& smallest = out.free[w.material[s]];
    const double radius = a.shapes->bounding_radius({w.shape[s]}), depth = w.position[s].dot(down);
    smallest.mass = std::min(smallest.mass, 1.0 / w.inverse_mass[s]),
    smallest.radius = std::min(smallest.radius, radius);
    smallest.round = smallest.round && ShapeRef{w.shape[s]}.type() == ShapeStore::type_of<Sphere>();
    out.diameter = std::min(out.diameter, 2 * radius);
    low = std::min(low, depth - radius), high = std::max(high, depth);
  }
  out.speed = std::max(2 * fastest, out.free_bodies > 0 ? fall_speed(g, high - low) : 0.0);
  return out;
}

TimeStep smooth_step(const Assembly& a, const Survey& s) {
  const SmoothSetup setup = smooth_setup(a.scene);
  StepLimit shortest;
  shortest.auto_step = shortest.stable_step = infinity;
  std::string between;
  const auto n = static_cast<int>(s.free_bodies + s.held_bodies) - 1;
  const auto look = [&](std::uint16_t i, const Smallest& p, std::uint16_t j, const Smallest* q) {
    const MaterialPair& pair = setup.materials.of(i, j);
    ExpectedContact c;
    c.effective_mass = q ? p.mass * q->mass / (p.mass + q->mass) : p.mass;
    c.mass = q ? std::min(p.mass, q->mass) : p.mass;
    c.effective_radius = q ? p.radius * q->radius / (p.radius + q->radius) : p.radius;
    // a corner of a cube moves as a quarter of its mass does; faces meet at four points
    const bool round = p.round && (!q || q->round);
    if (!round) c.effective_mass *= 0.25, c.mass *= 0.25;
    // at rest and without gravity: a thousandth of the sound speed, far above what a quiet scene sees
    c.speed = s.speed > 0 ? s.speed : 1e-3 * std::sqrt(pair.a.youngs_modulus / pair.a.density);
    const int points = round || a.plan.needs.area ? 1 : 4;  // cells of overlap volume share one face
    c.coordination = std::clamp(n, 1, 8) * points;
    const StepLimit limit = critical_step(setup, pair, c);
    if (limit.auto_step < shortest.auto_step) shortest = limit, between = pair.a.name + "-" + pair.b.name;
  };
  for (const auto& [i, p] : s.free) {
    for (const auto& [j, q] : s.free)
      if (i <= j && (i != j || s.free_bodies > 1)) look(i, p, j, &q);
    for (const auto& [j, unused] : s.held) look(i, p, j, nullptr);
  }
  return {shortest.auto_step, shortest.stable_step, fmt::format("contact {}: {}", between, shortest.reason)};
}

TimeStep nonsmooth_step(const Assembly& a, const Survey& s) {
  const double by_output = a.scene.run.output_interval.value / 10, g = a.scene.gravity.norm();
  const double by_size = g > 0 && std::isfinite(s.diameter) ? std::sqrt(0.01 * s.diameter / g) : infinity;
  if (by_output <= by_size) return {by_output, infinity, "output_interval / 10"};
  return {by_size, infinity, fmt::format("sqrt(0.01 d / g) of the smallest body, d = {:.4g} m", s.diameter)};
}

}  // namespace

TimeStep choose_time_step(const Assembly& a) {
  const Survey s = survey(a);
  const auto& written = a.scene.run.time_step;
  const bool smooth = a.scene.contact.method.value == Method::smooth;
  TimeStep step{a.scene.run.output_interval.value / 10, infinity, "no body can touch another: output_interval / 10"};
  if (s.free_bodies > 0 && s.free_bodies + s.held_bodies > 1) step = smooth ? smooth_step(a, s) : nonsmooth_step(a, s);
  if (!written.value) return step;
  if (*written.value > step.limit)
    throw SceneError(
        fmt::format("[run] time_step = {:g} s exceeds the limit {:.4g} s ({}); use time_step = \"auto\" ({:.4g} s)",
                    *written.value, step.limit, step.reason, step.value),
        written.place);
  return {*written.value, step.limit,
          "as written; " + fmt::format("auto would be {:.4g} s, {}", step.value, step.reason)};
}

}  // namespace epafi
