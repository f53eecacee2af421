/// @file contact_worlds.h  Contact problems for solver tests: stacks, heaps and random contacts, made without
/// detection.
#pragma once
#include "engine/units/random.h"
#include "laws/nonsmooth/residual.h"

namespace epafi::test {

/// n unit cubes of density 1000 on a plane, four contacts per face, one step of gravity; slots 1 .. n from below.
template <class Mass>
ContactProblem stack_of(int n, double mu, double dt, const Mass& mass) {
  World world{Columns{.rotation = true, .force = false}};
  world.gravity = Vec3(0, 0, -9.81);
  world.add({});
  for (int i = 0; i < n; ++i) {
    const double m = mass(i);
    world.add({.position = Vec3(0, 0, 0.5 + i), .mass = m, .inertia = Vec3::Constant(m / 6.0)});
  }
  ContactSet contacts;
  for (Slot a = 0; a < static_cast<Slot>(n); ++a)
    for (std::uint32_t k = 0; k < 4; ++k) {
      const Vec3 corner(k & 1 ? 0.5 : -0.5, k & 2 ? 0.5 : -0.5, a == 0 ? 0.0 : 0.5);
      contacts.append(a, a + 1, {.gap = 0.0, .normal = Vec3::UnitZ(), .arm = corner, .feature = k});
    }
  ContactProblem p;
  p.load_bodies(world, dt);
  p.load_contacts(world, contacts);
  p.load_diagonal();
  p.friction.assign(p.size(), mu);
  return p;
}

inline ContactProblem stack_problem(int n, double mu, double dt = 1.0 / 240, double top_mass_ratio = 1.0) {
  return stack_of(n, mu, dt, [&](int i) { return 1000.0 * (i + 1 == n ? top_mass_ratio : 1.0); });
}

/// n bodies with random inertia and velocities, each joined to a few earlier ones by contacts of random direction.
/// Every fifth body is fixed; `rotates` decides on the angular columns.
inline ContactProblem random_problem(int n, std::uint64_t seed, bool rotates, double mu) {
  Random random(seed, 0);
  const auto vec = [&](double s) { return Vec3(random.uniform(-s, s), random.uniform(-s, s), random.uniform(-s, s)); };
  World world{Columns{.rotation = rotates, .anisotropy = rotates, .force = false}};
  for (int i = 0; i < n; ++i) {
    Body body{.position = vec(1.0), .velocity = vec(1.0), .angular_velocity = vec(1.0)};
    body.mass = random.uniform(0.5, 2.0);
    if (i % 5 == 0) body.mass = 0.0;
    body.inertia = Vec3::Constant(0.1) + 0.05 * vec(1.0);
    world.add(body);
  }
  ContactSet contacts;
  for (Slot a = 0; a + 1 < static_cast<Slot>(n); ++a)
    for (Slot b = a + 1; b < std::min<Slot>(a + 4, static_cast<Slot>(n)); ++b)
      for (std::uint32_t k = 0; k < 1 + (a + b) % 3; ++k)
        contacts.append(a, b, {.gap = 0.0, .normal = vec(1.0).normalized(), .arm = vec(0.5), .feature = k});
  ContactProblem p;
  p.load_bodies(world, 0.01);
  p.load_contacts(world, contacts);
  p.load_diagonal();
  p.friction.assign(p.size(), mu);
  for (double& w : p.offset) w = random.uniform(-0.1, 0.1);
  return p;
}

/// A lattice of n^3 spheres on a plane, touching their neighbours: many colours, one contact per pair.
inline ContactProblem lattice_problem(int n, double mu, int points = 1) {
  World world{Columns{.rotation = true, .force = false}};
  world.gravity = Vec3(0, 0, -9.81);
  world.add({});
  for (int i = 0; i < n * n * n; ++i)
    world.add({.position = Vec3(i % n, i / n % n, 0.5 + i / (n * n)), .mass = 1.0, .inertia = Vec3::Constant(0.1)});
  ContactSet contacts;
  const auto join = [&](int a, int b, const Vec3& normal) {
    for (int k = 0; k < points; ++k) {
      Vec3 arm = (a == 0 ? Vec3(world.position[static_cast<Slot>(b)] - 0.5 * normal) : Vec3(0.5 * normal));
      if (points > 1) arm += 0.25 * Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, 0).cross(normal);
      contacts.append(static_cast<Slot>(a), static_cast<Slot>(b),
                      {.gap = 0.0, .normal = normal, .arm = arm, .feature = static_cast<Feature>(k)});
    }
  };
  for (int i = 1; i <= n * n; ++i) join(0, i, Vec3::UnitZ());
  for (int i = 0; i < n * n * n; ++i) {
    if (i % n + 1 < n) join(i + 1, i + 2, Vec3::UnitX());
    if (i / n % n + 1 < n) join(i + 1, i + 1 + n, Vec3::UnitY());
    if (i / (n * n) + 1 < n) join(i + 1, i + 1 + n * n, Vec3::UnitZ());
  }
  ContactProblem p;
  p.load_bodies(world, 1.0 / 240);
  p.load_contacts(world, contacts);
  p.load_diagonal();
  p.friction.assign(p.size(), mu);
  return p;
}

inline double residual_of(const ContactProblem& p, const Impulses& r) {
  BodyVelocities v;
  std::vector<Vec3> u;
  return measure_residual(p, r, p.mean_effective_mass(), v, u).value;
}

}  // namespace epafi::test
