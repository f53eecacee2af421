#include "scenes/step_estimate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace epafi {

namespace {

/// The largest dt with value(dt) <= 1, value between dt and dt^2.
template <class F>
double solve_step(const F& value) {
  double dt = 1.0;
  for (int k = 0; k < 60; ++k) {
    const double now = value(dt);
    if (!(now > 0.0)) return infinity;
    const double ratio = 1.0 / now;
    if (std::abs(ratio - 1.0) < 1e-3) break;
    dt *= std::sqrt(ratio);
  }
  return dt;
}

ContactKinematics with_overlap(ContactKinematics at, double overlap) {
  at.overlap = overlap;
  return at;
}

/// Solid spheres give way sideways with 7/2 of their mobility.
constexpr double sideways = 3.5;

}  // namespace

double overlap_under(const ContactLinks& links, const ExpectedPair& pair, double force) {
  const auto presses = [&](double overlap) {
    return links.normal(pair.i, pair.j, with_overlap(pair.at, overlap)).force;
  };
  double low = 0.0, high = 1e-12;
  while (presses(high) < force && high < 1e3) high *= 2.0;
  for (int k = 0; k < 40; ++k) {
    const double middle = 0.5 * (low + high);
    (presses(middle) < force ? low : high) = middle;
  }
  return high;
}

double impact_step(const ContactLinks& links, const ExpectedPair& pair, double overlap) {
  const double mobility = 1.0 / pair.at.effective_mass;
  const NormalSlopes n = links.normal(pair.i, pair.j, with_overlap(pair.at, overlap));
  return solve_step([&](double dt) {
    const StiffLink l = links.link(pair.i, pair.j, with_overlap(pair.at, overlap), sideways * mobility, 0.0, dt);
    const double along = lone_damped_weight(n.stiffness, n.dashpot, mobility, dt);
    return mobility * std::max(along, sideways * l.across);
  });
}

/// Solid spheres with Z contacts of weights w_n and w_t each, neighbours in antiphase: up to two are a chain, 2 Z/m
/// max(w_n, 7/2 w_t) (case B02: sqrt(m/k)); more are spread over all directions, 2 Z/(3 m) max(w_n + 2 w_t, 5 w_t).
double packing_step(const ContactLinks& links, const ExpectedPair& pair, double overlap, double coordination) {
  const double few = std::min(coordination, 2.0), many = coordination > 2 ? coordination / 3.0 : 0.0;
  return solve_step([&](double dt) {
    const StiffLink l =
        links.link(pair.i, pair.j, with_overlap(pair.at, overlap), sideways / pair.at.effective_mass, 0.0, dt);
    const double chain = std::max(l.along, sideways * l.across);
    const double packed = std::max(l.along + 2.0 * l.across, 5.0 * l.across);
    return 2.0 / pair.mass * std::max(few * chain, many * packed);
  });
}

double resting_contacts(double friction, double restitution) {
  const double isostatic = 4.0 + 2.0 / (1.0 + 30.0 * friction), damped = 1.0 - restitution;
  return isostatic * (1.1 + 0.4 * damped * damped * damped);
}

double column_step(const ContactLinks& links, const Column& c) {
  World world(Columns{.rotation = true, .force = false});
  Body ball;
  ball.mass = c.mass;
  ball.inertia = Vec3::Constant(0.4 * c.mass * c.radius * c.radius);
  for (std::size_t k = 0; k < c.balls; ++k) world.add(ball);
  Body plate;  // not free: it gives way by its own mass
  const BodyId pressing = world.add(plate);
  const auto add = [&](std::vector<StiffLink>& all, std::size_t below, double force, double dt) {
    const bool floor = below == c.balls, top = below + 1 == c.balls;
    const bool wall = floor || top;
    ExpectedPair pair{c.ball_material, wall ? c.floor_material : c.ball_material, c.mass, {}};
    pair.at.effective_mass = wall ? c.mass : 0.5 * c.mass;
    pair.at.effective_radius = wall ? c.radius : 0.5 * c.radius;
    pair.at.area = std::numbers::pi * pair.at.effective_radius * pair.at.effective_radius;
    const double overlap = overlap_under(links, pair, force);
    StiffLink l =
        links.link(pair.i, pair.j, with_overlap(pair.at, overlap), sideways / pair.at.effective_mass, 0.0, dt);
    l.a = floor ? no_slot : static_cast<Slot>(below);
    l.b = floor ? 0 : static_cast<Slot>(below + 1);  // the plate's slot follows that of the last ball
    l.arm_a = Vec3(0, 0, c.radius);
    l.arm_b = top && !floor ? Vec3(Vec3::Zero()) : Vec3(0, 0, -c.radius);
    all.push_back(l);
  };
  return solve_step([&](double dt) {
    std::vector<PressedBody> pressed;
    if (c.plate) pressed.push_back({pressing, Vec3::UnitZ(), c.plate->mass_in_step(dt)});
    std::vector<StiffLink> all;
    const double n = static_cast<double>(c.balls);
    add(all, c.balls, c.press + n * c.weight, dt);
    for (std::size_t k = 0; k < c.balls; ++k)
      if (k + 1 < c.balls || c.press > 0.0) add(all, k, c.press + (n - 1.0 - static_cast<double>(k)) * c.weight, dt);
    return stiffest_mode(world, all, 0.0, pressed).value;
  });
}

double corner_step(const ContactLinks& links, const ExpectedPair& pair, const FlatBody& body, double overlap,
                   std::size_t stacked) {
  const bool turns = body.inertia.minCoeff() > 0.0;
  World world(Columns{.rotation = turns, .anisotropy = turns, .force = false});
  Body b;
  b.mass = body.mass;
  b.inertia = body.inertia;
  world.add(b);
  // of n bodies on each other 4 cos^2(pi / (2 n + 1)) times the value of the lowest alone
  const double half_wave = std::cos(std::numbers::pi / (2.0 * static_cast<double>(stacked) + 1.0));
  // more than four corners carry as four points do that are stiffer together
  const double factor = 0.25 * body.corners * (stacked > 1 ? 4.0 * half_wave * half_wave : 1.0);
  const auto value = [&](double dt) {
    double most = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<StiffLink> points;
      for (const double u : {-1.0, 1.0})
        for (const double v : {-1.0, 1.0}) {
          Vec3 arm = body.half;
          arm[(axis + 1) % 3] *= u;
          arm[(axis + 2) % 3] *= v;
          const double slip =
              1.0 / body.mass + (turns ? arm.squaredNorm() * body.inertia.cwiseInverse().sum() / 3.0 : 0.0);
          StiffLink l = links.link(pair.i, pair.j, with_overlap(pair.at, overlap), slip, 0.0, dt);
          l.b = 0;
          l.arm_b = arm;
          l.normal = Vec3::Unit(axis);
          points.push_back(l);
        }
      most = std::max(most, stiffest_mode(world, points).value);
    }
    return factor * most;
  };
  return solve_step(value);
}

}  // namespace epafi
