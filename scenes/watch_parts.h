/// @file watch_parts.h  Sees the parts of divided steps, of which observers see only the last, and bodies too fast for
/// the step.
#pragma once
#include <algorithm>
#include <cmath>

#include "engine/threads/parallel.h"
#include "scenes/assemble.h"

namespace epafi {

/// Smallest radius of all bodies of the scene, including those poured later [m].
inline double least_radius(const Assembly& a) {
  const World& world = a.simulation->world;
  double least = infinity;
  for (const std::uint32_t shape : world.shape) least = std::min(least, a.shapes->bounding_radius({shape}));
  for (const PourBodies* source : a.sources)
    for (const auto& b : source->setup().bodies) least = std::min(least, a.shapes->bounding_radius({b.body.shape}));
  return least;
}

/// In smooth contact. Adds the overlaps of all parts but the last to the report of the step.
class WatchParts final : public Event {
 public:
  /// least_radius: of all present and later bodies [m]; interval: steps between looks at speeds.
  WatchParts(const Assembly& a, double least_radius, std::uint64_t interval)
      : simulation_(*a.simulation), shapes_(*a.shapes), least_radius_(least_radius), interval_(interval) {}
  void before_step(World& world, double dt, std::vector<BodyId>& /*leaving*/) override {
    if (dt < simulation_.time_step) note_overlap(world);
    if ((simulation_.steps() - 1) % interval_ == 0) watch_speeds(world, dt);
  }
  bool rests_next(const World& /*world*/, double /*dt*/) const override { return simulation_.steps() % interval_ != 0; }
  bool is_local() const override { return true; }

 private:
  double radius(const World& world, std::size_t s) const { return shapes_.bounding_radius({world.shape[s]}); }

  /// Of the contacts of the last part.
  void note_overlap(const World& world) const {
    const ContactSet& c = simulation_.work.contacts;
    double& known = simulation_.work.report.deepest_relative;
    if (!(simulation_.work.report.deepest > known * least_radius_)) return;
    known = block_max<double>(c.size(), known, [&, before = known](std::size_t k) {
      if (!(-c.gap[k] > before * least_radius_)) return 0.0;
      return -c.gap[k] / std::min(radius(world, c.a[k]), radius(world, c.b[k]));
    });
  }

  /// Warns of the body that moves furthest, by its radius, if it may pass through others.
  void watch_speeds(const World& world, double dt) const {
    const auto square = [&](std::size_t s) {
      return world.is_movable(static_cast<Slot>(s)) ? world.velocity[s].squaredNorm() : 0.0;
    };
    if (!(std::sqrt(block_max<double>(world.size(), 0.0, square)) * dt > least_radius_)) return;
    double most = 1.0;
    std::size_t fastest = world.size();
    for (std::size_t s = 0; s < world.size(); ++s) {
      const double moved = std::sqrt(square(s)) * dt / radius(world, s);
      if (!(moved > most)) continue;
      most = moved;
      fastest = s;
    }
    if (fastest == world.size()) return;
    char text[200];
    std::snprintf(text, sizeof text,
                  "a body moves by %.3g of its radius in a time step and may pass through others; in a time_step of "
                  "%.2g s it moves by a tenth",
                  most, 0.1 * dt / most);
    simulation_.warnings.add({.kind = "motion",
                              .text = text,
                              .first_step = simulation_.steps(),
                              .first_time = world.time,
                              .value = most,
                              .body = world.id[fastest]});
  }

  Simulation& simulation_;
  const ShapeStore& shapes_;
  double least_radius_;
  std::uint64_t interval_;
};

}  // namespace epafi
