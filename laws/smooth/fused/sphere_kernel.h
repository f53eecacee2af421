/// @file sphere_kernel.h  Hertz-like contact of spheres with a friction spring, four contacts at a time: gap, law,
/// spring and sums in one pass. The formulas are those of the law parts (respond, stiffness, limit) and of
/// laws/smooth/spring.h; the result equals the generic loop to rounding (tests/physics/test_fused_spheres.cpp).
#pragma once
#include "laws/contact_law.h"
#include "laws/smooth/fused/sphere_blocks.h"

namespace epafi {

template <class Normal, class Tangential>
struct SphereLaw {
  typename Normal::Parameters normal{};
  typename Tangential::Parameters tangential{};
};

/// What all groups of a block share.
struct SphereLoop {
  const SpherePlane* planes;
  const SphereState* states;
  SphereSum *sums, *records;
  double dt;
  bool damped;
  Vec3 cell_size, strain_rate;  ///< of a periodic cell [m], [1/s]
  SphereVirial* virials;
  double* viscous;  ///< energy lost in the dampers of the contacts a body owns, by slot [J]
};

/// Relative motion of four pairs, B against A.
struct PairMotion {
  Lanes3 normal;        ///< from A to B
  Lanes distance, gap;  ///< of centres; [m]
  Lanes3 velocity, spin_a, spin_b;
  Lanes approach;
};

/// Four bodies' columns out of four bodies' rows.
EPAFI_LANES Lanes3 columns(Lanes a, Lanes b, Lanes c, Lanes d) {
  transpose(a, b, c, d);
  return {a, b, c};
}

/// The flow of a deforming cell comes on top.
EPAFI_LANES void add_flow(PairMotion& m, const Lanes3& d, const Vec3& strain_rate) {
  const Lanes3 flow{strain_rate.x() * d.x, strain_rate.y() * d.y, strain_rate.z() * d.z};
  m.velocity = m.velocity + flow;
  m.approach = m.approach - flow.dot(m.normal);
}

EPAFI_LANES PairMotion motion_of_spheres(const SphereGroup& g, const SphereState* s, const Lanes3& d, Lanes distance,
                                         bool damped) {
  const SphereState &a0 = s[g.a[0]], &a1 = s[g.a[1]], &a2 = s[g.a[2]], &a3 = s[g.a[3]];
  const SphereState &b0 = s[g.b[0]], &b1 = s[g.b[1]], &b2 = s[g.b[2]], &b3 = s[g.b[3]];
  PairMotion m;
  m.distance = distance, m.gap = distance - g.radius_sum;
  const LaneMask apart = distance > Lanes{};
  const Lanes inverse = 1.0 / select(apart, distance, lanes(1.0));
  m.normal = Lanes3{inverse * d.x, inverse * d.y, select(apart, inverse * d.z, lanes(1.0))};
  m.velocity = columns(b0.velocity - a0.velocity, b1.velocity - a1.velocity, b2.velocity - a2.velocity,
                       b3.velocity - a3.velocity);
  const Lanes3 later = damped ? columns(b0.predicted - a0.predicted, b1.predicted - a1.predicted,
                                        b2.predicted - a2.predicted, b3.predicted - a3.predicted)
                              : m.velocity;
  m.approach = -later.dot(m.normal);
  m.spin_a = columns(a0.spin, a1.spin, a2.spin, a3.spin), m.spin_b = columns(b0.spin, b1.spin, b2.spin, b3.spin);
  return m;
}

EPAFI_LANES PairMotion motion_at_plane(const SphereGroup& g, const SphereState* s, const SpherePlane& plane,
                                       const Lanes3& x) {
  const SphereState &a0 = s[g.a[0]], &a1 = s[g.a[1]], &a2 = s[g.a[2]], &a3 = s[g.a[3]];
  PairMotion m;
  const Lanes3 out{lanes(plane.normal.x()), lanes(plane.normal.y()), lanes(plane.normal.z())};
  const Lanes3 from{x.x - plane.point.x(), x.y - plane.point.y(), x.z - plane.point.z()};
  m.gap = out.dot(from) - g.radius_sum;
  m.distance = g.radius_sum;
  m.normal = -out;
  const Lanes3 v = columns(a0.velocity, a1.velocity, a2.velocity, a3.velocity),
               later = columns(a0.predicted, a1.predicted, a2.predicted, a3.predicted);
  m.velocity = -v;
  m.approach = later.dot(m.normal);
  m.spin_a = columns(a0.spin, a1.spin, a2.spin, a3.spin), m.spin_b = Lanes3{};
  return m;
}

/// Load of the spring after the step, its energy, and what it lost.
struct SpringStep {
  Lanes3 load;
  Lanes stored, lost;
};

/// laws/smooth/spring.h: the old load turns with the plane, shrinks with the stiffness, follows the slip and stays
/// below `limit`. Divisions and roots that no lane needs are left out.
EPAFI_LANES SpringStep pull(const SphereGroup& g, const PairMotion& m, LaneMask touching, Lanes stiffness, Lanes limit,
                            double dt) {
  const Lanes3& n = m.normal;
  const Lanes3 old{g.load_x, g.load_y, g.load_z};
  const Lanes before = old.dot(old);
  const Lanes3 spin = m.spin_a + m.spin_b;
  const Lanes twist = 0.5 * dt * n.dot(spin);
  Lanes3 load = old + twist * n.cross(old);
  load = load - n.dot(load) * n;
  const Lanes after = load.dot(load);
  const LaneMask turns = after > Lanes{};
  load = select(turns, sqrt(before / select(turns, after, lanes(1.0))), Lanes{}) * load;
  const Lanes opening = m.velocity.dot(n);
  const Lanes3 turning = (m.distance * g.share) * m.spin_a + (m.distance * (1.0 - g.share)) * m.spin_b;
  const Lanes3 displacement = dt * (m.velocity - opening * n - turning.cross(n));
  const Lanes3 start = load;
  const LaneMask softer = touching & (stiffness < g.stiffness);
  if (any(softer)) load = select(softer, stiffness / select(softer, g.stiffness, lanes(1.0)), lanes(1.0)) * load;
  load = load + stiffness * displacement;
  const Lanes square = load.dot(load);
  const LaneMask slides = touching & (square > limit * limit);
  if (any(slides)) load = select(slides, limit / sqrt(select(slides, square, lanes(1.0))), lanes(1.0)) * load;
  const Lanes energy = keep(touching, 0.5 * load.dot(load) / select(touching, stiffness, lanes(1.0)));
  const Lanes work = keep(touching, 0.5 * (start + load).dot(displacement));
  return {{keep(touching, load.x), keep(touching, load.y), keep(touching, load.z)}, energy, work - (energy - g.energy)};
}

/// Adds a group's forces to its bodies: push along the normal, the spring's load across. d: from A to B.
template <bool wall, bool across, bool periodic>
EPAFI_LANES void add_to_bodies(const SphereGroup& g, const SphereLoop& loop, const PairMotion& m, const Lanes3& d,
                               const SpringStep& spring, Lanes push, Lanes stored) {
  SphereSum* sums = loop.sums;
  Lanes f0 = spring.load.x - push * m.normal.x, f1 = spring.load.y - push * m.normal.y,
        f2 = spring.load.z - push * m.normal.z, f3 = stored;
  const Lanes3 moment = m.normal.cross(spring.load);
  const Lanes arm_a = m.distance * g.share, arm_b = m.distance * (1.0 - g.share);
  Lanes t0 = arm_a * moment.x, t1 = arm_a * moment.y, t2 = arm_a * moment.z, t3 = spring.lost;
  Lanes v0 = f0, v1 = f1, v2 = f2, v3{};
  transpose(f0, f1, f2, f3), transpose(t0, t1, t2, t3);
  const Lanes force[4] = {f0, f1, f2, f3}, torque[4] = {t0, t1, t2, t3};
  if constexpr (wall) {
    for (int k = 0; k < lane_count; ++k) sums[g.a[k]].force += force[k], sums[g.a[k]].torque += torque[k];
    return;
  }
  if constexpr (periodic) {
    v0 *= d.x, v1 *= d.y, v2 *= d.z;
    transpose(v0, v1, v2, v3);
    const Lanes virial[4] = {v0, v1, v2, v3};
    for (int k = 0; k < lane_count; ++k) loop.virials[g.a[k]].sum += virial[k];
  }
  Lanes u0 = arm_b * moment.x, u1 = arm_b * moment.y, u2 = arm_b * moment.z, u3{};
  transpose(u0, u1, u2, u3);
  const Lanes torque_b[4] = {u0, u1, u2, u3}, no_energy{-1.0, -1.0, -1.0, 0.0};  // the owner keeps the energy
  // lane by lane, A and B: the order of a body's sum must not depend on which contacts share a group
  for (int k = 0; k < lane_count; ++k) {
    sums[g.a[k]].force += force[k], sums[g.a[k]].torque += torque[k];
    SphereSum& other = across ? loop.records[g.record + static_cast<std::uint32_t>(k)] : sums[g.b[k]];
    if constexpr (across)
      other = SphereSum{no_energy * force[k], torque_b[k]};
    else
      other.force += no_energy * force[k], other.torque += torque_b[k];
  }
}

/// One group: reads the bodies, moves the springs on, adds to sums (of B: to records where it lies in another block).
/// image: in a periodic cell, null otherwise.
template <class Normal, class Tangential, bool wall, bool across, bool periodic>
EPAFI_LANES void evaluate(SphereGroup& g, const SphereLaw<Normal, Tangential>& law, const SphereLoop& loop,
                          const SphereImages* image, std::size_t& touching_count) {
  const SphereState* s = loop.states;
  const double dt = loop.dt;
  Lanes3 d;
  PairMotion m;
  LaneMask touching;
  if constexpr (wall) {
    d = columns(s[g.a[0]].position, s[g.a[1]].position, s[g.a[2]].position, s[g.a[3]].position);
    m = motion_at_plane(g, s, loop.planes[g.plane], d);
    touching = (m.gap < Lanes{}) & (g.radius_sum > Lanes{});
    if (!g.loaded && !any(touching)) return;
  } else {
    d = columns(s[g.b[0]].position - s[g.a[0]].position, s[g.b[1]].position - s[g.a[1]].position,
                s[g.b[2]].position - s[g.a[2]].position, s[g.b[3]].position - s[g.a[3]].position);
    if constexpr (periodic)
      d = d + Lanes3{loop.cell_size.x() * image->x, loop.cell_size.y() * image->y, loop.cell_size.z() * image->z};
    const Lanes distance = sqrt(d.dot(d));
    touching = distance < g.radius_sum;
    if (!g.loaded && !any(touching)) return;
    m = motion_of_spheres(g, s, d, distance, loop.damped);
    if constexpr (periodic) add_flow(m, d, loop.strain_rate);
  }
  KinematicsOf<Lanes> at;
  at.overlap = keep(touching, -m.gap), at.approach_velocity = keep(touching, m.approach);
  at.effective_mass = g.mass, at.effective_radius = g.radius;
  const ResponseOf<Lanes> r = Normal::respond(law.normal, at);
  SpringStep spring{};
  if constexpr (Tangential::is_present)
    spring = pull(g, m, touching, Tangential::stiffness(law.tangential, r.stiffness),
                  Tangential::friction(law.tangential) * r.force, dt);
  const Lanes viscous = keep(touching, (r.force - r.elastic_force) * at.approach_velocity);
  if (loop.damped) {
    const Lanes damper = 0.5 * dt * (g.viscous + viscous);
    for (int k = 0; k < lane_count; ++k) loop.viscous[g.a[k]] += damper[k];
  }
  if (dt > 0.0 || !g.loaded) {  // no time passes: what is remembered stays as it is
    g.load_x = spring.load.x, g.load_y = spring.load.y, g.load_z = spring.load.z;
    if constexpr (Tangential::is_present)
      g.stiffness = keep(touching, Tangential::stiffness(law.tangential, r.stiffness));
    g.energy = spring.stored, g.viscous = viscous, g.normal_force = select(touching, r.force, lanes(-1.0));
    g.loaded = any(touching);
  }
  const Lanes stored = keep(touching, r.energy) + g.energy;
  touching_count -= static_cast<std::size_t>(touching[0] + touching[1] + touching[2] + touching[3]);
  add_to_bodies<wall, across, periodic>(g, loop, m, d, spring, keep(touching, r.force), stored);
}

}  // namespace epafi
