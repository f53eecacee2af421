#include "laws/smooth/bristles.h"

#include <algorithm>

namespace epafi {

namespace {

/// Half as many bristles, twice as wide. The sum of two loads on twice the stiffness never holds more energy than they
/// did.
void merge(Bristles& b) {
  for (int i = 0; i < Bristles::count; ++i) {
    const std::size_t k = 2 * static_cast<std::size_t>(i);
    b.load[static_cast<std::size_t>(i)] = 2 * i + 1 < Bristles::count ? Vec3(b.load[k] + b.load[k + 1]) : Vec3(0, 0, 0);
  }
  b.width *= 2.0;
  b.share *= 0.5;
}

/// Twice as many, half as wide: the same energy. Only where the outer half is idle.
void split(Bristles& b) {
  for (int i = Bristles::count - 1; i >= 0; --i)
    b.load[static_cast<std::size_t>(i)] = 0.5 * b.load[static_cast<std::size_t>(i / 2)];
  b.width *= 0.5;
  b.share *= 2.0;
}

/// Part of bristle i inside the contact radius, in its width.
double covered(double share, int i) { return std::clamp(share - i, 0.0, 1.0); }

/// Normal load over x from i to i + w of a Hertzian row of radius s, as a part of the whole: integral of 1 - (x/s)^2.
double load_part(double s, int i, double w) {
  const double outer = i + w, inner = i;
  return (w - (outer * outer * outer - inner * inner * inner) / (3.0 * s * s)) * 1.5 / s;
}

}  // namespace

double energy_of(const Bristles& b) {
  double energy = 0.0;
  for (int i = 0; b.width > 0.0 && i < Bristles::count && b.share > i; ++i)
    energy += energy_of(Spring{b.load[static_cast<std::size_t>(i)], b.width * covered(b.share, i)});
  return energy;
}

FrictionResponse pull_bristles(const SlipStep& step, double stiffness, double limit, const Bristles& before,
                               Bristles& now) {
  now = before;
  FrictionResponse out;
  if (!(stiffness > 0.0)) {
    now = Bristles{};
    return out;
  }
  if (!(now.width > 0.0)) {
    now.load.fill(Vec3(0, 0, 0));
    now.width = stiffness / (0.75 * Bristles::count);
    now.share = 0.0;
  }
  while (stiffness > now.width * Bristles::count) merge(now);
  while (stiffness < 0.25 * now.width * Bristles::count && now.share <= 0.5 * Bristles::count) split(now);
  const double share = stiffness / now.width;
  Vec3 load_before = Vec3::Zero();
  for (int i = 0; i < Bristles::count; ++i) {
    Vec3& load = now.load[static_cast<std::size_t>(i)];
    const double was = covered(now.share, i), is = covered(share, i);
    if (was > 0.0) {
      load = turn_load(load, step.normal, step.twist);
      load_before += load;
    }
    if (!(is > 0.0)) {
      load.setZero();
      continue;
    }
    const Spring spring =
        extend({load, now.width * was}, load, now.width * is, step.displacement, limit * load_part(share, i, is));
    load = spring.load;
    out.load += load;
    out.energy += energy_of(spring);
  }
  now.share = share;
  out.work = 0.5 * (load_before + out.load).dot(step.displacement);
  return out;
}

}  // namespace epafi
