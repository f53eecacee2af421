#include "scenes/time_step_nonsmooth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "laws/smooth/critical_step.h"
#include "scenes/expected_fall.h"

namespace epafi {

namespace {

constexpr double longest_step = 1.0 / 60.0;  // [s]
constexpr double fallen_share = 0.01;        // of a body, in its first step
constexpr double moved_share = 0.25;         // of the smallest body
constexpr double turned_angle = 0.1;         // [rad]
constexpr double steps_a_swing = 40.0;
constexpr double strain_share = 0.01;

/// The shortest of several steps, and why.
struct ShortestStep {
  double value = longest_step;
  std::string reason = "1/60 s, the longest: bodies are large and slow";

  /// why: text of what asks for it, made only where it counts.
  template <class Text>
  void take(double step, const Text& why) {
    if (!(step < value)) return;
    value = step;
    reason = why();
  }
};

/// What free bodies do.
struct FreeBodies {
  double diameter = infinity;   ///< of the smallest [m]
  double lightest = infinity;   ///< mass [kg]
  double swift = infinity;      ///< least d / a [s^2]
  double swift_diameter = 0.0;  ///< of that body [m]
  double spin = 0.0;            ///< largest, but of spheres [rad/s]
  double speed = 0.0;           ///< largest that is written [m/s]
  Vec3 highest = Vec3::Zero();  ///< its lowest point, about
  double top = infinity;        ///< depth of that point along gravity [m]
  double deepest = -infinity;   ///< depth of the lowest centre [m]

  void add_size(double size, double mass, double acceleration) {
    diameter = std::min(diameter, size);
    lightest = std::min(lightest, mass);
    if (!(acceleration > 0.0) || size / acceleration >= swift) return;
    swift = size / acceleration;
    swift_diameter = size;
  }
  void add_place(const Vec3& at, const Vec3& down, double radius) {
    const double depth = at.dot(down) + radius;
    if (depth < top) {
      top = depth;
      highest = at + radius * down;
    }
    deepest = std::max(deepest, depth);
  }
};

Vec3 downwards(const Assembly& a) {
  const Vec3& gravity = a.simulation->world.gravity;
  const double g = gravity.norm();
  return g > 0.0 ? Vec3(gravity / g) : Vec3(Vec3::Zero());
}

FreeBodies look_at_free(const Assembly& a) {
  const World& w = a.simulation->world;
  const Vec3 down = downwards(a);
  FreeBodies out;
  for (Slot s = 0; s < w.size(); ++s) {
    if (!w.is_movable(s)) continue;
    const ShapeRef shape{w.shape[s]};
    const double radius = a.shapes->bounding_radius(shape);
    out.add_size(2.0 * radius, 1.0 / w.inverse_mass[s], w.free_acceleration(s).norm());
    out.add_place(w.position[s], down, radius);
    out.speed = std::max(out.speed, w.velocity[s].norm());
    if (w.rotates() && shape.type() != ShapeStore::type_of<Sphere>())
      out.spin = std::max(out.spin, w.angular_velocity[s].norm());
  }
  for (const PourBodies* source : a.sources) {
    for (const auto& b : source->setup().bodies) {
      const double radius = a.shapes->bounding_radius(ShapeRef{b.body.shape});
      out.add_size(2.0 * radius, b.body.mass, a.simulation->world.gravity.norm());
      out.speed = std::max(out.speed, b.body.velocity.norm());
      for (const Vec3& corner : {source->setup().low, source->setup().high}) out.add_place(corner, down, radius);
    }
  }
  return out;
}

/// How far the highest body may fall: to the lowest body or onto what is held [m].
double fall_height(const Assembly& a, const FreeBodies& free) {
  return std::max({0.0, free.deepest - free.top, ExpectedFall(a).height(free.highest, downwards(a))});
}

/// One of the motions of a driven body.
void look_at_motion(const Motion& m, double arm, const std::string& name, double& speed, ShortestStep& step) {
  const double rate = std::abs(m.rotation_rate), swing = 2.0 * std::numbers::pi * m.oscillation_frequency;
  speed = std::max(speed, m.velocity.norm() + rate * arm + std::abs(swing * m.oscillation_amplitude));
  step.take(rate > 0.0 ? turned_angle / rate : infinity,
            [&] { return fmt::format("{} turns by {:g} rad per step", name, turned_angle); });
  if (m.oscillation_frequency > 0.0 && m.oscillation_amplitude != 0.0)
    step.take(1.0 / (steps_a_swing * m.oscillation_frequency),
              [&] { return fmt::format("{:g} steps per oscillation of {}", steps_a_swing, name); });
}

/// Walls that are driven, and what follows a table.
void look_at_driven(const Assembly& a, double& speed, ShortestStep& step) {
  const World& w = a.simulation->world;
  bool follows_table = false;
  for (std::size_t k = 0; k < a.scene.bodies.size(); ++k) {
    const BodySpec& b = a.scene.bodies[k];
    if (b.absent) continue;
    if (b.servo) speed = std::max(speed, b.servo->servo.max_speed);
    follows_table = follows_table || b.load;
    const Slot s = w.slot_of(a.id_of(k));
    if (!b.motion || s == no_slot) continue;
    const double radius = a.shapes->bounding_radius(ShapeRef{w.shape[s]}), reach = std::isfinite(radius) ? radius : 0.0;
    for (const Motion& m : b.motion->parts) {
      const double arm = m.rotation_about ? (*m.rotation_about - b.position).norm() : 0.0;
      look_at_motion(m, arm + reach, body_name(a, a.id_of(k)), speed, step);
      follows_table = follows_table || m.table;
    }
  }
  if (follows_table)
    step.take(a.scene.run.output_interval.value / 10.0,
              [] { return "output_interval / 10: a motion or load follows a table"; });
}

void look_at_springs(const Assembly& a, ShortestStep& step) {
  const World& w = a.simulation->world;
  for (const SpringSpec& spring : a.scene.springs) {
    double inverse_mass = w.inverse_mass[w.slot_of(Assembly::body_id(spring.body))];
    if (spring.to) inverse_mass += w.inverse_mass[w.slot_of(Assembly::body_id(*spring.to))];
    const double square = spring.stiffness.maxCoeff() * inverse_mass;
    if (!(square > 0.0)) continue;
    step.take(2.0 * std::numbers::pi / std::sqrt(square) / steps_a_swing,
              [&] { return fmt::format("{:g} steps per oscillation of spring '{}'", steps_a_swing, spring.name); });
  }
}

void look_at_cell(const Assembly& a, const FreeBodies& free, ShortestStep& step) {
  if (!a.scene.cell) return;
  const CellControl& control = a.scene.cell->control;
  const double rate = std::max(control.strain_rate.cwiseAbs().maxCoeff(), control.pressure ? control.rate_limit : 0.0);
  if (rate > 0.0)
    step.take(strain_share / rate, [&] { return fmt::format("the cell strains by {:g} per step", strain_share); });
  if (!control.pressure || !std::isfinite(free.diameter)) return;
  const double pressed = *control.pressure * free.diameter * free.diameter / free.lightest;
  step.take(std::sqrt(fallen_share * free.diameter / pressed), [&] {
    return fmt::format("the pressure moves the smallest body by {:g} of its size per step, d = {:.4g} m", fallen_share,
                       free.diameter);
  });
}

/// How far the highest body may fall within the run [m].
double longest_fall(const Assembly& a, const FreeBodies& free) {
  const double time = a.scene.run.duration.value;
  const double height = fall_height(a, free);
  return time > 0.0 ? std::min(height, 0.5 * a.simulation->world.gravity.norm() * time * time) : height;
}

void look_at_free_motion(const Assembly& a, const FreeBodies& free, ShortestStep& step) {
  double written = free.speed;
  look_at_driven(a, written, step);
  if (!std::isfinite(free.diameter)) return;
  step.take(std::sqrt(fallen_share * free.swift), [&] {
    return fmt::format("sqrt({:g} d / g): a body falls from rest by {:g} of its size per step, d = {:.4g} m",
                       fallen_share, fallen_share, free.swift_diameter);
  });
  const double height = longest_fall(a, free), fall = fall_speed(a.simulation->world.gravity.norm(), height);
  const double speed = std::max(written, fall);
  if (speed > 0.0)
    step.take(moved_share * free.diameter / speed, [&] {
      return fmt::format(
          "d / (4 v): no body moves further per step, d = {:.4g} m of the smallest body, v = {:.4g} "
          "m/s {}",
          free.diameter, speed, fall < speed ? "as written" : "of the fall from the highest body");
    });
  if (free.spin > 0.0)
    step.take(turned_angle / free.spin, [&] { return fmt::format("bodies turn by {:g} rad per step", turned_angle); });
}

}  // namespace

double dividing_step(double longest, double interval) {
  constexpr double rounding = 1e-9;  // an interval of whole steps is one
  if (!(interval > 0.0)) return longest;
  return interval / std::max(1.0, std::ceil(interval / longest * (1.0 - rounding)));
}

TimeStep nonsmooth_step(const Assembly& a) {
  ShortestStep step;
  const FreeBodies free = look_at_free(a);
  look_at_free_motion(a, free, step);
  look_at_springs(a, step);
  look_at_cell(a, free, step);
  const Placed<double>& interval = a.scene.run.output_interval;
  step.take(interval.value, [&] {
    return std::string(interval.written() ? "output_interval"
                                          : "a hundredth of the duration, the interval of snapshots");
  });
  for (const MeasureSpec& m : a.scene.measures)
    if (m.interval > 0.0) step.take(m.interval, [&] { return fmt::format("interval of measure '{}'", m.name); });
  const double whole = interval.written() ? interval.value : a.scene.run.duration.value;
  const double value = dividing_step(step.value, whole);
  if (interval.written() && value < (1.0 - 1e-6) * step.value) step.reason += "; shortened to divide output_interval";
  return {value, infinity, step.reason};
}

}  // namespace epafi
