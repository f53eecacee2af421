#include "scenes/load_poles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace epafi {

namespace {

constexpr double beyond = 1e6;  // times the values beside it

/// A bracket of f with the values at its ends.
struct Bracket {
  double low, high, at_low, at_high;
  double most() const { return std::max(std::abs(at_low), std::abs(at_high)); }
};

/// Bisects a change of sign: f tends to 0 where it is continuous, to infinity at a pole.
std::optional<double> pole_between(const std::function<double(double)>& f, Bracket b) {
  const double before = b.most();
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (b.low + b.high), value = f(middle);
    if (!std::isfinite(value)) return middle;
    if (middle <= b.low || middle >= b.high) break;
    if ((value > 0.0) == (b.at_low > 0.0)) {
      b.low = middle;
      b.at_low = value;
    } else {
      b.high = middle;
      b.at_high = value;
    }
  }
  if (std::min(std::abs(b.at_low), std::abs(b.at_high)) > beyond * before) return b.low;
  return std::nullopt;
}

/// Searches a pole at a peak of |f| between two times, by golden section.
std::optional<double> pole_at_peak(const std::function<double(double)>& f, double low, double high, double before) {
  constexpr double golden = 0.6180339887498949;
  double left = high - golden * (high - low), right = low + golden * (high - low);
  double at_left = std::abs(f(left)), at_right = std::abs(f(right));
  for (int k = 0; k < 80; ++k) {
    if (!std::isfinite(at_left)) return left;
    if (!std::isfinite(at_right)) return right;
    if (at_left > at_right) {
      high = right;
      right = left;
      at_right = at_left;
      left = high - golden * (high - low);
      at_left = std::abs(f(left));
    } else {
      low = left;
      left = right;
      at_left = at_right;
      right = low + golden * (high - low);
      at_right = std::abs(f(right));
    }
  }
  if (std::max(at_left, at_right) > beyond * before) return left;
  return std::nullopt;
}

void check_vector(const TimeVector& value, double from, double until, std::size_t samples, const std::string& what,
                  const Place& place) {
  if (!value) return;
  for (int axis = 0; axis < 3; ++axis)
    if (const auto pole = find_pole([&](double t) { return value(t)[axis]; }, from, until, samples))
      throw SceneError(fmt::format("{}: component {} leaves all measure at t = {:.9g} s, within the run (of {:.6g} s); "
                                   "keep the divisor of its expression away from 0, or end the run before",
                                   what, "xyz"[axis], *pole - from, until - from),
                       place);
}

}  // namespace

std::optional<double> find_pole(const std::function<double(double)>& f, double from, double until,
                                std::size_t samples) {
  const auto time = [&](std::size_t k) {
    return from + (until - from) * static_cast<double>(k) / static_cast<double>(samples);
  };
  double far = f(from), near = far;
  if (!std::isfinite(far)) return from;
  for (std::size_t k = 1; k <= samples; ++k) {
    const double now = f(time(k));
    if (!std::isfinite(now)) return time(k);
    if (near != 0.0 && now != 0.0 && (near > 0.0) != (now > 0.0))
      if (const auto pole = pole_between(f, {time(k - 1), time(k), near, now})) return pole;
    if (k > 1 && std::abs(near) > std::abs(far) && std::abs(near) >= std::abs(now))
      if (const auto pole = pole_at_peak(f, time(k - 2), time(k), std::abs(near))) return pole;
    far = near;
    near = now;
  }
  return std::nullopt;
}

void check_loads(const Assembly& a) {
  const Scene& scene = a.scene;
  const double duration = scene.run.duration.value;
  if (!std::isfinite(duration) || !(duration > 0.0)) return;
  const auto loaded = static_cast<std::size_t>(
      std::ranges::count_if(scene.bodies, [](const BodySpec& b) { return b.load && !b.absent; }));
  constexpr std::size_t fewest = 64, most = 4096, all = 400000;  // a tenth of a second
  const std::size_t samples = std::clamp(all / std::max<std::size_t>(1, loaded), fewest, most);
  const double start = a.elapsed(scene.gravity_since);
  check_vector(scene.loose_gravity, start, start + duration, samples, "[world] gravity", {});
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const BodySpec& b = scene.bodies[i];
    if (!b.load || b.absent) continue;
    const double from = a.elapsed(b.load->since);
    const std::string name = body_name(a, a.id_of(i));
    const Place& place = scene.groups[b.group].place;
    check_vector(b.load->force, from, from + duration, samples, "force of '" + name + "'", place);
    check_vector(b.load->torque, from, from + duration, samples, "torque of '" + name + "'", place);
  }
}

}  // namespace epafi
