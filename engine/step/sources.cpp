#include "engine/step/sources.h"

#include <algorithm>
#include <cmath>

#include "engine/threads/exact_sum.h"
#include "engine/threads/parallel.h"
#include "engine/units/random.h"

namespace epafi {

namespace {

struct Ball {
  Vec3 centre;
  double radius;
  /// The same for its images.
  bool meets(const World& world, const Vec3& x, double r) const {
    Vec3 d = x - centre;
    for (int k = 0; world.cell && k < 3; ++k)
      if (world.cell->repeats[static_cast<std::size_t>(k)])
        d[k] -= std::round(d[k] / world.cell->size[k]) * world.cell->size[k];
    return d.squaredNorm() < (radius + r) * (radius + r);
  }
};

}  // namespace

void PourBodies::before_step(World& world, double, std::vector<BodyId>&) {
  constexpr int trials = 20;
  const auto& queue = setup_.bodies;
  const double time = world.clock + setup_.elapsed;
  if (!waits(time)) return;
  if (setup_.see_held) setup_.see_held(world);
  std::vector<Ball> balls;  // possible obstacles: in the box enlarged by both radii
  for (Slot s = 0; s < world.size(); ++s) {
    if (!world.is_movable(s)) continue;
    const double r = setup_.radius(world.shape[s]);
    const Vec3& x = world.position[s];
    if (world.cell || (((x - setup_.low).array() > -r).all() && ((setup_.high - x).array() > -r).all()))
      balls.push_back({x, r});
  }
  while (waits(time)) {
    const WaitingBody& waiting = queue[next_];
    Random random(setup_.seed, (next_ << 24) + tried_);
    bool placed = false;
    for (int t = 0; t < trials && !placed; ++t) {
      Body body = waiting.body;
      for (int k = 0; k < 3; ++k)
        body.position[k] = random.uniform(setup_.low[k] + waiting.radius, setup_.high[k] - waiting.radius);
      placed = true;
      for (const Ball& b : balls) placed = placed && !b.meets(world, body.position, waiting.radius);
      placed = placed && !(setup_.meets_held && setup_.meets_held(body));
      if (!placed) continue;
      world.add(body, waiting.id);
      balls.push_back({body.position, waiting.radius});
    }
    if (!placed) {
      ++tried_;
      return;
    }
    ++next_;
    tried_ = 0;
  }
}

std::uint64_t PourBodies::due(const World& world) const {
  const double time = world.clock + setup_.elapsed;
  const auto& queue = setup_.bodies;
  return static_cast<std::uint64_t>(std::ranges::upper_bound(queue, time, {}, &WaitingBody::time) - queue.begin());
}

void PourBodies::visit(StateVisitor& visitor) {
  visitor.value("pour/" + setup_.name + "/next", next_);
  visitor.value("pour/" + setup_.name + "/tried", tried_);
}

/// Time until the next check [s].
double Outlet::wait(const World& world, double dt) const {
  if (steps_ <= 1) return 0.0;
  const double fastest = block_max<double>(world.size(), 0.0, [&](std::size_t s) {
    return world.is_movable(static_cast<Slot>(s)) ? world.velocity[s].norm() : 0.0;
  });
  const double most = steps_ * dt, deep = 0.02 * (high_ - low_).minCoeff();
  return fastest * most > deep ? deep / fastest : most;
}

void Outlet::before_step(World& world, double dt, std::vector<BodyId>& leaving) {
  if (!is_due(world.time, dt)) return;
  next_look_ = world.time + wait(world, dt);
  const std::vector<BodyId> gone = leaving;  // those of other events are not counted here
  ExactSum mass;
  const auto is_inside = [&](std::size_t s) {
    const Vec3& x = world.position[s];
    return (x.array() >= low_.array()).all() && (x.array() <= high_.array()).all() &&
           world.is_movable(static_cast<Slot>(s));
  };
  const auto any = [&](std::size_t s) { return static_cast<char>(is_inside(s)); };
  if (block_max<char>(world.size(), 0, any) == 0) return;
  for (Slot s = 0; s < world.size(); ++s) {
    if (!is_inside(s)) continue;
    if (std::ranges::find(gone, world.id[s]) != gone.end()) continue;
    leaving.push_back(world.id[s]);
    tally_.count += 1.0;
    mass.add(1.0 / world.inverse_mass[s]);
  }
  tally_.mass += mass.value();
}

void Outlet::visit(StateVisitor& visitor) {
  visitor.value("outlet/" + name_ + "/count", tally_.count);
  visitor.value("outlet/" + name_ + "/mass", tally_.mass);
  if (visitor.has("outlet/" + name_ + "/next_look")) visitor.value("outlet/" + name_ + "/next_look", next_look_);
}

}  // namespace epafi
