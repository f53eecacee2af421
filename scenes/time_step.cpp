#include "scenes/time_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>

#include "detection/narrow/polyhedra/manifold.h"
#include "engine/threads/parallel.h"
#include "laws/smooth/contact_links.h"
#include "laws/smooth/critical_step.h"
#include "scenes/contact_setup.h"
#include "scenes/expected_fall.h"
#include "scenes/railway/rolling.h"
#include "scenes/step_estimate.h"
#include "scenes/time_step_nonsmooth.h"

namespace epafi {

namespace {

/// Smallest free body of a material.
struct Smallest {
  double mass = infinity, radius = infinity;
  bool round = true;                         ///< spheres do not turn under the normal force
  int points = 1;                            ///< of a pair: round bodies touch at one, faces at four
  double end = 1.0;                          ///< share of its mass with which a round body gives way at its end
  std::map<std::uint32_t, FlatBody> flat{};  ///< by shape: those that rest on faces
};

/// That a body may rest on: the overlapping ones of a face on a plane or on another face all carry.
int corners_of_largest_face(const ShapeStore& shapes, ShapeRef ref) {
  return shapes.with(ref, []<class S>(const S& s) {
    std::size_t most = 4;
    if constexpr (PolyhedralShape<S>) {
      const auto begins = s.view().face_begin;
      for (std::size_t f = 0; f + 1 < begins.size(); ++f) most = std::max<std::size_t>(most, begins[f + 1] - begins[f]);
    }
    if constexpr (std::is_same_v<S, SolidParts>)
      for (const auto& face : s.outline.faces) most = std::max(most, face.size());
    return static_cast<int>(std::min(most, Patch::most));
  });
}

int points_of(ShapeRef ref) {
  const auto type = ref.type();
  const bool round = type == ShapeStore::type_of<Sphere>() || type == ShapeStore::type_of<Ellipsoid>() ||
                     type == ShapeStore::type_of<Capsule>();
  return round ? 1 : 4;
}

/// 1/(1 + m arm^2/I) where it gives way most. Normals of an ellipsoid pass its centre at no more than the difference of
/// two of its semi-axes, those of a capsule at half the length of its axis, which is the same of its box.
double share_at_end(const Vec3& half, double mass, const Vec3& inertia) {
  double most = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double arm = half[(k + 1) % 3] - half[(k + 2) % 3];
    if (inertia[k] > 0.0) most = std::max(most, mass * arm * arm / inertia[k]);
  }
  return 1.0 / (1.0 + most);
}

struct Survey {
  std::map<std::uint16_t, Smallest> free;  ///< by material
  std::map<std::uint16_t, bool> held;      ///< materials of fixed and driven bodies
  std::size_t free_bodies = 0, held_bodies = 0;
  double fall = 0.0;             ///< through the bodies' height [m/s]
  double hit = 0.0;              ///< of the fastest body or the longest fall: of an impact on a body at rest [m/s]
  double speed = 0.0;            ///< largest of twice that of the start and of the longest fall [m/s]
  double diameter = infinity;    ///< of the smallest free body [m]
  double fastest = 0.0;          ///< at the start [m/s]
  double load = 0.0;             ///< weights, external forces and servo walls, all together [N]
  double pressed = 0.0;          ///< by the strongest servo wall, part of the load [N]
  std::optional<Servo> plate{};  ///< the lightest servo wall without gains
  std::map<std::uint16_t, double> plates;  ///< by material: mass of the lightest servo wall without gains [kg]
  double pressure = 0.0;                   ///< of a cell [Pa]
  Vec3 low = Vec3::Constant(infinity), high = Vec3::Constant(-infinity);  ///< of the free bodies [m]
  Vec3 highest = Vec3::Zero();                                            ///< lowest point of the highest of them [m]
  double top = infinity;                                                  ///< depth of that point along `down` [m]

  void see(const Vec3& lowest, const Vec3& down) {
    if (!(lowest.dot(down) < top)) return;
    top = lowest.dot(down);
    highest = lowest;
  }
};

/// Adds a free body.
void look_at(Survey& out, const Assembly& a, const Body& body, const Vec3& at) {
  const auto [shape, material, mass] = std::tuple(body.shape, body.material, body.mass);
  ++out.free_bodies;
  auto& smallest = out.free[material];
  const double radius = a.shapes->bounding_radius({shape});
  smallest.mass = std::min(smallest.mass, mass);
  smallest.radius = std::min(smallest.radius, radius);
  smallest.points = std::max(smallest.points, points_of(ShapeRef{shape}));
  smallest.round = smallest.round && ShapeRef{shape}.type() == ShapeStore::type_of<Sphere>();
  out.diameter = std::min(out.diameter, 2 * radius);
  out.load += mass * a.simulation->world.gravity.norm() + body.external_force.norm();
  out.low = out.low.cwiseMin(at - Vec3::Constant(radius));
  out.high = out.high.cwiseMax(at + Vec3::Constant(radius));
  constexpr std::size_t most = 50;  // shapes whose corners are read
  const bool round = points_of(ShapeRef{shape}) == 1;
  if (!round && (smallest.flat.size() >= most || smallest.flat.contains(shape))) return;
  const Aabb box = a.shapes->bounding_box(ShapeRef{shape}, Pose{});
  if (round) {
    smallest.end = std::min(smallest.end, share_at_end(0.5 * (box.max - box.min), mass, body.inertia));
    return;
  }
  const double density = a.scene.materials[material].material.density;
  const double volume = mass / density, of_volume = std::cbrt(0.75 * volume / std::numbers::pi);
  FlatBody flat{mass, body.inertia, box.max.cwiseAbs().cwiseMax(box.min.cwiseAbs()), density > 0 ? of_volume : radius,
                corners_of_largest_face(*a.shapes, ShapeRef{shape})};
  // the faces of other shapes do not fill the sides of their box: a cylinder's rim is as far as the corners of a square
  // in it
  if (ShapeRef{shape}.type() != ShapeStore::type_of<Box>()) flat.half *= std::sqrt(0.5);
  smallest.flat.emplace(shape, flat);
}

/// What sources will bring: low, high: heights that bodies reach against `down` [m]; fastest [m/s].
void survey_sources(const Assembly& a, const Vec3& down, Survey& out, double& low, double& high, double& fastest) {
  const World& w = a.simulation->world;
  for (const auto* source : a.sources) {
    for (const auto& b : source->setup().bodies) {
      look_at(out, a, b.body, 0.5 * (source->setup().low + source->setup().high));
      fastest = std::max(fastest, b.body.velocity.norm());
    }
    for (const Vec3& corner : {source->setup().low, source->setup().high}) {
      out.see(corner, down);
      out.low = out.low.cwiseMin(corner);
      out.high = out.high.cwiseMax(corner);
      low = std::min(low, corner.dot(down));
      high = std::max(high, corner.dot(down));
    }
    for (Slot s = 0; s < w.size(); ++s)  // what is poured falls onto what is there
      if (std::isfinite(a.shapes->bounding_radius({w.shape[s]}))) high = std::max(high, w.position[s].dot(down));
  }
}

/// Speed of the longest fall onto other bodies or walls, by weight or by a force of the body's own [m/s].
double fastest_fall(const Assembly& a, const Survey& s) {
  const World& w = a.simulation->world;
  const ExpectedFall walls(a);
  double fastest = s.fall;
  const auto fall = [&](const Vec3& lowest, const Vec3& acceleration, bool onto_bodies) {
    const double rate = acceleration.norm();
    if (!(rate > 0.0)) return;
    const Vec3 along = acceleration / rate;
    const double to_bodies = onto_bodies ? (furthest(s.low, s.high, along) - lowest).dot(along) : 0.0;
    fastest = std::max(fastest, fall_speed(rate, std::max(to_bodies, walls.height(lowest, along))));
  };
  if (s.free_bodies > 0) fall(s.highest, w.gravity, false);  // s.fall is that onto bodies
  if (!w.columns().external_force) return fastest;
  for (Slot i = 0; i < w.size(); ++i) {
    if (!w.is_movable(i) || w.external_force[i].isZero(0.0) || touches_rails_only(a, w.shape[i])) continue;
    const Vec3 acceleration = w.free_acceleration(i);
    const double radius = a.shapes->bounding_radius({w.shape[i]});
    fall(w.position[i] + radius * acceleration.stableNormalized(), acceleration, true);
  }
  return fastest;
}

Survey survey(const Assembly& a) {
  const World& w = a.simulation->world;
  Survey out;
  const double g = w.gravity.norm();
  const Vec3 down = g > 0 ? Vec3(w.gravity / g) : -Vec3::UnitZ();
  double low = infinity, high = -infinity, fastest = 0;
  for (Slot s = 0; s < w.size(); ++s) {
    if (touches_rails_only(a, w.shape[s])) continue;  // railway_step
    if (const Vec3& v = w.velocity[s]; !std::isfinite(v.squaredNorm()))
      throw SceneError(
          fmt::format("{}: a speed of {:g} m/s has no finite energy", body_name(a, w.id[s]), v.stableNorm()));
    fastest = std::max(fastest, w.velocity[s].norm());
    if (!w.is_movable(s)) {
      out.held[w.material[s]] = true;
      ++out.held_bodies;
      continue;
    }
    Body body;
    body.shape = w.shape[s];
    body.material = w.material[s];
    body.mass = 1.0 / w.inverse_mass[s];
    if (w.rotates()) body.inertia = w.inverse_inertia_of(s).cwiseInverse();
    if (w.columns().external_force) body.external_force = w.external_force[s];
    look_at(out, a, body, w.position[s]);
    const double depth = w.position[s].dot(down), radius = a.shapes->bounding_radius({w.shape[s]});
    out.see(w.position[s] + radius * down, down);
    low = std::min(low, depth - radius);
    high = std::max(high, depth);
  }
  survey_sources(a, down, out, low, high, fastest);
  for (const auto& b : a.scene.bodies)
    if (b.servo && !b.absent) {
      fastest = std::max(fastest, b.servo->servo.max_speed);
      out.pressed = std::max(out.pressed, b.servo->servo.force);
      if (b.servo->servo.has_gains()) continue;
      const double mass = b.servo->servo.mass;
      const auto known = out.plates.try_emplace(static_cast<std::uint16_t>(b.material), mass).first;
      known->second = std::min(known->second, mass);
      if (!out.plate || mass < out.plate->mass) out.plate = b.servo->servo;
    }
  out.load += out.pressed;
  if (a.scene.cell) out.pressure = a.scene.cell->control.pressure.value_or(0.0);
  out.fastest = fastest;
  out.fall = out.free_bodies > 0 ? fall_speed(g, high - low) : 0.0;
  const double longest = fastest_fall(a, out);
  out.hit = std::max(fastest, longest);
  out.speed = std::max(2 * fastest, longest);
  return out;
}

/// A step divided so that contacts at the present largest speed are resolved as the smooth step resolves those of the
/// survey: contact times go like speed^(-1/5) (Hertz). The longest step is that of a thousandth of the survey's speed,
/// or of a tenth of the fall through the whole height: the weight of what lies above presses contacts as such an impact
/// does (n g delta against g h: overlaps below 1e-2 of the size).
TimeStep smooth_step(const Assembly& a, const Survey& s);
double quiet_speed(const Material& material);

TimeStep adaptive_step(const Assembly& a, Survey fast) {
  if (!(fast.speed > 0.0))
    for (const auto& [i, unused] : fast.free)
      fast.speed = std::max(fast.speed, quiet_speed(a.scene.materials[i].material));
  if (!(fast.speed > 0.0)) return smooth_step(a, fast);
  Survey slow = fast;
  slow.speed = std::max(1e-3 * fast.speed, 0.1 * fast.fall);
  TimeStep step = smooth_step(a, slow);
  step.limit = infinity;
  const TimeStep least = smooth_step(a, fast);
  const double top = fast.speed, longest = step.value, shortest = least.value;
  const double least_share = slow.speed / top;
  const double power = longest > shortest ? std::log(shortest / longest) / std::log(least_share) : 0.0;
  step.adaptive = AdaptiveStep{top, longest, shortest, power, least_share};
  step.reason = fmt::format("adaptive: {} at {:.4g} m/s, divided down to {:.4g} s at {:.4g} m/s", step.reason,
                            slow.speed, shortest, top);
  return step;
}

/// Limits by impact, load and corners over all pairs of materials.
class ContactEstimate {
 public:
  ContactEstimate(const Assembly& a, const Survey& s, const SmoothSetup& setup) : survey_(s), links_(setup) {
    const Vec3 sides = s.high - s.low;
    const double g = a.simulation->world.gravity.norm();
    const Vec3 down = g > 0 ? Vec3(a.simulation->world.gravity / g) : Vec3::Zero();
    for (int k = 0; k < 3; ++k) {  // the loads act along the axis nearest to gravity; without, across the smallest area
      const double area = sides[(k + 1) % 3] * sides[(k + 2) % 3];
      if (g == 0.0 || std::abs(down[k]) > 0.7) area_ = std::min(area_, area);
    }
    if (!std::isfinite(area_)) area_ = sides[0] * sides[1];
  }

  double chosen = infinity, limit = infinity;  ///< [s]
  std::string reason, limit_reason;

  void look(const MaterialPair& materials, std::uint16_t i, const Smallest& p, std::uint16_t j, const Smallest* q,
            double impact_overlap) {
    const auto [friction, restitution] = std::pair(materials.friction, materials.restitution);
    ExpectedPair pair{i, j, q ? std::min(p.mass, q->mass) : p.mass, {}};
    pair.at.effective_mass = q ? p.mass * q->mass / (p.mass + q->mass) : p.mass;
    const double radius = pair.at.effective_radius = q ? p.radius * q->radius / (p.radius + q->radius) : p.radius;
    pair.at.area = std::numbers::pi * radius * radius;
    const bool round = p.flat.empty() && (!q || q->flat.empty());
    if (!round) return corners(pair, p, q, impact_overlap, restitution);
    // a body has one contact with a wall and shares the others with its like; in a column they are two
    const bool column = is_column(p.radius);
    const int most = static_cast<int>(survey_.free_bodies + survey_.held_bodies) - 1;
    const int neighbours = std::min(column ? 2 : 10, most);
    const double pressed = overlap_under(links_, pair, chains * load_of(p.radius));
    const bool one = !q && survey_.free_bodies > 1;
    const int points = neighbours * (q ? std::min(p.points, q->points) : p.points);
    const auto under_load = [&](const ExpectedPair& of, double contacts) {
      return one ? impact_step(links_, of, pressed) : packing_step(links_, of, pressed, contacts);
    };
    const double resting = std::min<double>(resting_contacts(friction, restitution), most);
    const bool balls = p.round && (!q || q->round);
    const double bears = !column  ? under_load(pair, resting)
                         : !balls ? under_load(pair, neighbours)
                                  : (q ? infinity : column_of(i, j, p));
    ExpectedPair end = pair;
    const double share = q ? std::min(p.end, q->end) : p.end;
    end.mass *= share;
    end.at.effective_mass *= share;
    const double half = std::min(under_load(end, points), column && balls ? bears : infinity);
    take(bears, 0.5 * half, "under the load of the bodies above");
    take(impact_step(links_, pair, impact_overlap), 0.5 * impact_step(links_, end, impact_overlap),
         "at the expected speed");
  }

 private:
  static constexpr double chains = 1.5;  ///< chains of force carry half as much again

  /// Of the contacts of a body of that radius [N].
  double load_of(double radius) const {
    const double below = 4.0 * radius * radius;
    return survey_.load * std::min(1.0, below / area_) + survey_.pressure * below;
  }
  bool is_column(double radius) const { return area_ < 2.0 * 4.0 * radius * radius; }
  double column_of(std::uint16_t ball, std::uint16_t floor, const Smallest& p) const {
    constexpr std::size_t most = 10;  // a longer one is no stiffer, but by its load
    Column c{std::clamp<std::size_t>(survey_.free_bodies, 1, most),
             p.mass,
             p.radius,
             0.0,
             survey_.pressed,
             survey_.plate,
             ball,
             floor};
    c.weight = (survey_.load - survey_.pressed) / static_cast<double>(c.balls);
    return column_step(links_, c);
  }
  void corners(ExpectedPair pair, const Smallest& p, const Smallest* q, double impact_overlap, double restitution) {
    for (const Smallest* kind : {&p, q}) {
      if (!kind) continue;
      for (const auto& [shape, flat] : kind->flat) {
        pair.mass = flat.mass;
        pair.at.effective_mass = q ? 0.5 * flat.mass : flat.mass;
        pair.at.effective_radius = q ? 0.5 * flat.radius : flat.radius;
        pair.at.area = 0.25 * std::numbers::pi * pair.at.effective_radius * pair.at.effective_radius;
        // its part of the weight each; it falls onto its points from rest
        const double falls = 1.0 + restitution;
        const double pressed = overlap_under(links_, pair, falls * load_of(kind->radius) / flat.corners);
        const std::size_t stacked = q ? std::min<std::size_t>(survey_.free_bodies, 3) : 1;
        const double overlap = std::max(impact_overlap, pressed);
        take(corner_step(links_, pair, flat, pressed, stacked),
             0.5 * corner_step(links_, pair, flat, overlap, std::min<std::size_t>(stacked, 2)),
             flat.corners > 4 ? "with all corners of a face" : "with four points of a face");
      }
    }
  }
  void take(double stable, double half, const char* why) {
    if (stable < limit) {
      limit = stable;
      limit_reason = fmt::format("what a contact {} bears as a rule", why);
    }
    if (half >= chosen) return;
    chosen = half;
    reason = fmt::format("half of {:.4g} s, the stable step of the worst contact {}", 2.0 * half, why);
  }

  const Survey& survey_;
  ContactLinks links_;
  double area_ = infinity;  ///< that the loads act on [m^2]
};

/// At rest and without forces: a thousandth of the sound speed, far above what a quiet scene sees [m/s].
double quiet_speed(const Material& m) { return 1e-3 * std::sqrt(m.youngs_modulus / m.density); }

constexpr double soft_overlap = 0.3;  // of the radius: softened grains that fall through all of a scene have 0.24

std::string soft_impacts(double overlap, double speed) {
  return fmt::format("; impacts at {:.3g} m/s overlap by {:.2g} of the radius{}", speed, overlap,
                     overlap_remedy(overlap, true));
}

TimeStep smooth_step(const Assembly& a, const Survey& s) {
  const SmoothSetup setup = smooth_setup(a.scene);
  StepLimit shortest;
  shortest.auto_step = infinity;
  std::string between;
  double softest = 0.0;
  ContactEstimate estimate(a, s, setup);
  const auto look = [&](std::uint16_t i, const Smallest& p, std::uint16_t j, const Smallest* q) {
    const MaterialPair& pair = setup.materials.of(i, j);
    ExpectedContact c;
    c.effective_mass = q ? p.mass * q->mass / (p.mass + q->mass) : p.mass;
    c.effective_radius = q ? p.radius * q->radius / (p.radius + q->radius) : p.radius;
    // a corner of a cube moves as a quarter of its mass does
    const bool round = p.round && (!q || q->round);
    if (!round) c.effective_mass *= 0.25;
    c.speed = s.speed > 0 ? s.speed : quiet_speed(pair.a);
    StepLimit limit = critical_step(setup, pair, c);
    const double deepest = limit.impact.largest_overlap;
    const double radius = q ? std::min(p.radius, q->radius) : p.radius;
    if (deepest > soft_overlap * radius && s.hit > 0.0) {
      c.speed = s.hit;
      softest = std::max(softest, critical_step(setup, pair, c).impact.largest_overlap / radius);
      c.speed = s.speed;
    }
    if (const auto plate = s.plates.find(j); !q && plate != s.plates.end()) {
      c.moved_mass = p.mass * plate->second / (p.mass + plate->second);
      c.part = pressed_step_part;
      limit = critical_step(setup, pair, c);
    }
    if (limit.auto_step < shortest.auto_step) {
      shortest = limit;
      between = pair.a.name + "-" + pair.b.name;
    }
    estimate.look(pair, i, p, j, q, deepest);
  };
  for (const auto& [i, p] : s.free) {
    for (const auto& [j, q] : s.free)
      if (i <= j && (i != j || s.free_bodies > 1)) look(i, p, j, &q);
    for (const auto& [j, unused] : s.held) look(i, p, j, nullptr);
  }
  TimeStep step{shortest.auto_step, infinity, fmt::format("contact {}: {}", between, shortest.reason)};
  if (estimate.chosen < step.value) {
    step.value = estimate.chosen;
    step.reason = estimate.reason;
  }
  if (softest > soft_overlap) step.reason += soft_impacts(softest, s.hit);
  step.limit = estimate.limit;
  step.limit_reason = estimate.limit_reason;
  return step;
}

/// "[[stage]] 'shear': " of a scene with stages.
std::string stage_name(const Assembly& a) {
  const std::string& name = a.scene.stages[a.scene.stage].name;
  return name.empty() ? name : "[[stage]] '" + name + "': ";
}

/// Where the step is written; a stage that came later has made it too long.
Place place_of_step(const Assembly& a) {
  const Place &written = a.scene.run.time_step.place, &stage = a.scene.stages[a.scene.stage].place;
  return stage.file == written.file && stage.line > written.line ? stage : written;
}

}  // namespace

TimeStep choose_time_step(const Assembly& a) {
  const Survey s = survey(a);
  const auto& written = a.scene.run.time_step;
  const bool smooth = a.scene.contact.method.value == Method::smooth;
  TimeStep step{a.scene.run.output_interval.value / 10, infinity, "no body can touch another: output_interval / 10"};
  if (s.free_bodies > 0 && s.free_bodies + s.held_bodies > 1) step = smooth ? smooth_step(a, s) : nonsmooth_step(a);
  if (const TimeStep railway = railway_step(a); railway.value < infinity) {
    const bool only = smooth && (s.free_bodies == 0 || s.free_bodies + s.held_bodies < 2);
    if (only || railway.value < step.value) {
      step.value = railway.value;
      step.reason = railway.reason;
    }
    if (railway.limit < step.limit) step.limit_reason = railway.reason;
    step.limit = std::min(step.limit, railway.limit);
  }
  if (a.scene.run.adaptive && !smooth)
    throw SceneError("[run] time_step = \"adaptive\" is for contact.method = \"smooth\"", written.place);
  if (a.scene.run.adaptive && s.free_bodies > 0 && s.free_bodies + s.held_bodies > 1) return adaptive_step(a, s);
  if (!written.value) return step;
  if (*written.value > step.limit && !a.scene.run.allow_unstable)
    throw SceneError(
        stage_name(a) +
            fmt::format("[run] time_step = {:g} s exceeds the limit {:.4g} s ({}); use time_step = \"auto\" ({:.4g} s)",
                        *written.value, step.limit, step.limit_reason.empty() ? step.reason : step.limit_reason,
                        step.value),
        place_of_step(a));
  return {*written.value, step.limit,
          "as written; " + fmt::format("auto would be {:.4g} s, {}", step.value, step.reason), step.limit_reason};
}

int parts_by_motion(const World& w, const ShapeStore& shapes, double dt) {
  constexpr double moved = 0.1, most = 1e4;
  const double parts = block_max<double>(w.size(), 0.0, [&](std::size_t i) {
    const auto s = static_cast<Slot>(i);
    if (!w.is_movable(s)) return 0.0;
    const double speed = w.velocity[i].norm() + w.acceleration(s).norm() * dt;
    return speed * dt / (moved * shapes.bounding_radius({w.shape[i]}));
  });
  return std::max(1, static_cast<int>(std::ceil(std::min(most, parts))));
}

std::string chosen_text(const Assembly& a) {
  std::string out = fmt::format(" time step: {:.4g} s: {}\n", a.time_step.value, a.time_step.reason);
  for (std::size_t k = 0; k < a.scene.bodies.size(); ++k) {
    const BodySpec& b = a.scene.bodies[k];
    if (!b.servo || b.absent) continue;
    const Servo& s = b.servo->servo;
    out += fmt::format(" servo of '{}': {:.4g} N along ({:.3g}, {:.3g}, {:.3g}), {}at most {:.4g} m/s\n",
                       body_name(a.scene, k), s.force, s.direction.x(), s.direction.y(), s.direction.z(),
                       s.has_gains() ? "" : fmt::format("mass {:.4g} kg, ", s.mass), s.max_speed);
  }
  const ContactSettings& c = a.scene.contact;
  if (c.method.value != Method::nonsmooth) return out;
  const std::string impact = c.nonsmooth.has("impact") ? c.nonsmooth.text("impact") : "energetic";
  return out + fmt::format(" solver: {}{}, tolerance {:g}; impacts: {}\n", c.solver.value,
                           c.solver.written() ? "" : " (default)", c.nonsmooth.number_or("tolerance", 1e-6), impact);
}

/// Overlaps of an impact go like E^(-2/5) by Hertz, like k^(-1/2) by linear springs, those under a load with less.
std::string overlap_remedy(double relative, bool smooth) {
  constexpr double power = 2.5, wanted = 0.05;
  if (!smooth)
    return "; a shorter run.time_step keeps bodies apart, or more contact.nonsmooth.iterations above the tolerance";
  return fmt::format("; {:.2g} times the stiffness (youngs_modulus, stiffness) keeps it below {}",
                     std::pow(relative / wanted, power), wanted);
}

}  // namespace epafi
