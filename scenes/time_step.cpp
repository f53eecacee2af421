#include "scenes/time_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "engine/parallel.h"
#include "laws/smooth/critical_step.h"
#include "scenes/contact_setup.h"
#include "scenes/railway/rolling.h"

namespace epafi {

namespace {

/// Smallest free body of a material.
struct Smallest {
  double mass = infinity, radius = infinity;
  bool round = true;  ///< spheres do not turn under the normal force
  int points = 1;     ///< of a pair: spheres and ellipsoids touch at one, capsules along a line, faces at four
};

int points_of(ShapeRef ref) {
  if (ref.type() == ShapeStore::type_of<Sphere>() || ref.type() == ShapeStore::type_of<Ellipsoid>()) return 1;
  return ref.type() == ShapeStore::type_of<Capsule>() ? 2 : 4;
}

struct Survey {
  std::map<std::uint16_t, Smallest> free;  ///< by material
  std::map<std::uint16_t, bool> held;      ///< materials of fixed and driven bodies
  std::size_t free_bodies = 0, held_bodies = 0;
  double fall = 0.0;           ///< through the bodies' height [m/s]
  double speed = 0.0;          ///< largest of the start and of the fall through the bodies' height [m/s]
  double diameter = infinity;  ///< of the smallest free body [m]
};

/// Adds a free body.
void look_at(Survey& out, const Assembly& a, std::uint32_t shape, std::uint16_t material, double mass) {
  ++out.free_bodies;
  auto& smallest = out.free[material];
  const double radius = a.shapes->bounding_radius({shape});
  smallest.mass = std::min(smallest.mass, mass), smallest.radius = std::min(smallest.radius, radius);
  smallest.points = std::max(smallest.points, points_of(ShapeRef{shape}));
  smallest.round = smallest.round && ShapeRef{shape}.type() == ShapeStore::type_of<Sphere>();
  out.diameter = std::min(out.diameter, 2 * radius);
}

bool is_railway(std::uint32_t shape) {
  const auto type = ShapeRef{shape}.type();
  return type == ShapeStore::type_of<WheelProfile>() || type == ShapeStore::type_of<RailProfile>();
}

Survey survey(const Assembly& a) {
  const World& w = a.simulation->world;
  Survey out;
  const double g = w.gravity.norm();
  const Vec3 down = g > 0 ? Vec3(w.gravity / g) : -Vec3::UnitZ();
  double low = infinity, high = -infinity, fastest = 0;
  for (Slot s = 0; s < w.size(); ++s) {
    if (a.plan.rolling && is_railway(w.shape[s])) continue;  // they touch each other only: railway_step
    if (const Vec3& v = w.velocity[s]; !std::isfinite(v.squaredNorm()))
      throw SceneError(
          fmt::format("{}: a speed of {:g} m/s has no finite energy", body_name(a, w.id[s]), v.stableNorm()));
    fastest = std::max(fastest, w.velocity[s].norm());
    if (!w.is_movable(s)) {
      out.held[w.material[s]] = true, ++out.held_bodies;
      continue;
    }
    look_at(out, a, w.shape[s], w.material[s], 1.0 / w.inverse_mass[s]);
    const double depth = w.position[s].dot(down);
    low = std::min(low, depth - a.shapes->bounding_radius({w.shape[s]})), high = std::max(high, depth);
  }
  for (const auto* source : a.sources) {
    for (const auto& b : source->setup().bodies) {
      look_at(out, a, b.body.shape, b.body.material, b.body.mass);
      fastest = std::max(fastest, b.body.velocity.norm());
    }
    for (const Vec3& corner : {source->setup().low, source->setup().high})
      low = std::min(low, corner.dot(down)), high = std::max(high, corner.dot(down));
    for (Slot s = 0; s < w.size(); ++s)  // what is poured falls onto what is there
      if (std::isfinite(a.shapes->bounding_radius({w.shape[s]}))) high = std::max(high, w.position[s].dot(down));
  }
  for (const auto& b : a.scene.bodies)
    if (b.servo) fastest = std::max(fastest, b.servo->max_speed);
  out.fall = out.free_bodies > 0 ? fall_speed(g, high - low) : 0.0;
  out.speed = std::max(2 * fastest, out.fall);
  return out;
}

/// A step divided so that contacts at the present largest speed are resolved as the smooth step resolves those of the
/// survey: contact times go like speed^(-1/5) (Hertz). The longest step is that of a thousandth of the survey's speed,
/// or of a tenth of the fall through the whole height: the weight of what lies above presses contacts as such an impact
/// does (n g delta against g h: overlaps below 1e-2 of the size).
TimeStep smooth_step(const Assembly& a, const Survey& s);

TimeStep adaptive_step(const Assembly& a, const Survey& fast) {
  Survey slow = fast;
  slow.speed = std::max(1e-3 * fast.speed, 0.1 * fast.fall);
  TimeStep step = smooth_step(a, slow);
  step.limit = infinity;
  const TimeStep least = smooth_step(a, fast);
  const double top = fast.speed, longest = step.value, shortest = least.value;
  const double least_share = slow.speed / top;
  const double power = longest > shortest ? std::log(shortest / longest) / std::log(least_share) : 0.0;
  step.parts = [=](const World& w) {
    const double square = block_max<double>(w.size(), 0.0, [&](std::size_t i) { return w.velocity[i].squaredNorm(); });
    const double share = std::clamp(2 * std::sqrt(square) / top, least_share, 1e3);  // two bodies that meet head-on
    return std::max(1, static_cast<int>(std::ceil(longest / shortest * std::pow(share, power) * (1 - 1e-9))));
  };
  step.reason = fmt::format("adaptive: {} at {:.4g} m/s, divided down to {:.4g} s at {:.4g} m/s", step.reason,
                            slow.speed, shortest, top);
  return step;
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
    // a corner of a cube moves as a quarter of its mass does
    const bool round = p.round && (!q || q->round);
    if (!round) c.effective_mass *= 0.25, c.mass *= 0.25;
    // at rest and without gravity: a thousandth of the sound speed, far above what a quiet scene sees
    c.speed = s.speed > 0 ? s.speed : 1e-3 * std::sqrt(pair.a.youngs_modulus / pair.a.density);
    // cells of overlap volume share one face
    const int points = a.plan.needs.area ? 1 : q ? std::min(p.points, q->points) : p.points;
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
  if (const TimeStep railway = railway_step(a); railway.value < infinity && smooth) {
    const bool only = s.free_bodies == 0 || s.free_bodies + s.held_bodies < 2;
    if (only || railway.value < step.value) step.value = railway.value, step.reason = railway.reason;
    step.limit = std::min(step.limit, railway.limit);
  }
  if (a.scene.run.adaptive && !smooth)
    throw SceneError("[run] time_step = \"adaptive\" is for contact.method = \"smooth\"", written.place);
  if (a.scene.run.adaptive && s.free_bodies > 0 && s.free_bodies + s.held_bodies > 1 && s.speed > 0)
    return adaptive_step(a, s);
  if (!written.value) return step;
  if (*written.value > step.limit && !a.scene.run.allow_unstable)
    throw SceneError(
        fmt::format("[run] time_step = {:g} s exceeds the limit {:.4g} s ({}); use time_step = \"auto\" ({:.4g} s)",
                    *written.value, step.limit, step.reason, step.value),
        written.place);
  return {*written.value, step.limit,
          "as written; " + fmt::format("auto would be {:.4g} s, {}", step.value, step.reason)};
}

}  // namespace epafi
