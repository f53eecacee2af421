/// @file sphere_kernel.h  Hertz-like contact of spheres with a friction spring, four contacts at a time. Eight such
/// groups go through gap, motion, law, spring and sums together: each of these is short, so that the processor works at
/// several groups at once (one pass over all five took 1.5 times as long: 500 dependent instructions). The formulas are
/// those of the law parts (respond, stiffness, limit) and of laws/smooth/spring.h; the result equals the generic loop
/// to rounding (tests/physics/test_fused_spheres.cpp).
#pragma once
#include "laws/contact_law.h"
#include "laws/smooth/fused/sphere_blocks.h"

namespace epafi {

template <class Normal, class Tangential>
struct SphereLaw {
  typename Normal::Parameters normal{};
  typename Tangential::Parameters tangential{};
};

/// What the groups of a block read and write.
struct SphereArrays {
  const SpherePlane* planes;
  const SphereState* states;
  SphereSum *sums, *records;
  double* viscous;  ///< energy lost in the dampers of the contacts a body owns, by slot [J]
  double dt;
  bool damped;
  Vec3 cell_size, strain_rate;  ///< of a periodic cell [m], [1/s]
  SphereVirial* virials;        ///< by slot, in a periodic cell
};

/// Up to eight groups on their way through the loop; only those that touch or have touched.
struct SphereTile {
  static constexpr std::size_t size = 8;
  std::size_t count = 0;
  SphereGroup* group[size];
  LaneMask touching[size];
  Lanes distance[size];  ///< of centres [m]
  Lanes3 normal[size];   ///< from A to B; of walls: into the wall
  Lanes overlap[size], approach[size];
  Lanes3 displacement[size];                       ///< slip of the step [m]
  Lanes twist[size];                               ///< about the normal in the step [rad]
  Lanes force[size], viscous[size], energy[size];  ///< [N], [W], [J]
  Lanes stiffness[size], limit[size];              ///< of the spring [N/m], [N]
  Lanes3 load[size];                               ///< of the spring [N]
  Lanes slipped[size], damped[size];               ///< lost by the spring and by the damper in the step [J]
};

/// Four bodies' columns out of four bodies' rows.
EPAFI_LANES Lanes3 columns(Lanes a, Lanes b, Lanes c, Lanes d) {
  transpose(a, b, c, d);
  return {a, b, c};
}

/// Takes a group into the tile where some lane touches or did so. normal: the line of centres, not of length 1 yet.
/// image: which ones B are, in a periodic cell.
template <bool wall, bool periodic>
EPAFI_LANES void find_touching(SphereTile& t, SphereGroup& g, const SphereImages* image, const SphereArrays& with) {
  const std::size_t k = t.count;
  const SphereState* s = with.states;
  if constexpr (wall) {
    const SpherePlane& plane = with.planes[g.plane];
    const Lanes3 out{lanes(plane.normal.x()), lanes(plane.normal.y()), lanes(plane.normal.z())};
    const Lanes3 x = columns(s[g.a[0]].position, s[g.a[1]].position, s[g.a[2]].position, s[g.a[3]].position);
    const Lanes3 from{x.x - plane.point.x(), x.y - plane.point.y(), x.z - plane.point.z()};
    const Lanes gap = out.dot(from) - g.radius_sum;
    t.touching[k] = (gap < Lanes{}) & (g.radius_sum > Lanes{});
    t.distance[k] = g.radius_sum, t.normal[k] = -out, t.overlap[k] = keep(t.touching[k], -gap);
  } else {
    Lanes3 d = columns(s[g.b[0]].position - s[g.a[0]].position, s[g.b[1]].position - s[g.a[1]].position,
                       s[g.b[2]].position - s[g.a[2]].position, s[g.b[3]].position - s[g.a[3]].position);
    if constexpr (periodic)
      d = d + Lanes3{with.cell_size.x() * image->x, with.cell_size.y() * image->y, with.cell_size.z() * image->z};
    const Lanes distance = sqrt(d.dot(d));
    t.touching[k] = distance < g.radius_sum;
    t.distance[k] = distance, t.normal[k] = d, t.overlap[k] = keep(t.touching[k], -(distance - g.radius_sum));
  }
  t.group[k] = &g;
  t.count += g.loaded || any(t.touching[k]);
}

template <bool wall, bool periodic>
EPAFI_LANES void find_motion(SphereTile& t, std::size_t k, const SphereArrays& with) {
  const SphereGroup& g = *t.group[k];
  const SphereState* s = with.states;
  const SphereState &a0 = s[g.a[0]], &a1 = s[g.a[1]], &a2 = s[g.a[2]], &a3 = s[g.a[3]];
  const SphereState &b0 = s[g.b[0]], &b1 = s[g.b[1]], &b2 = s[g.b[2]], &b3 = s[g.b[3]];
  Lanes3 velocity, later;
  const Lanes3 spin_a = columns(a0.spin, a1.spin, a2.spin, a3.spin);
  Lanes3 spin_b{};
  if constexpr (wall) {
    velocity = -columns(a0.velocity, a1.velocity, a2.velocity, a3.velocity);
    later = -columns(a0.predicted, a1.predicted, a2.predicted, a3.predicted);
  } else {
    const LaneMask apart = t.distance[k] > Lanes{};
    const Lanes inverse = 1.0 / select(apart, t.distance[k], lanes(1.0));
    const Lanes3 d = t.normal[k];
    t.normal[k] = Lanes3{inverse * d.x, inverse * d.y, select(apart, inverse * d.z, lanes(1.0))};
    velocity = columns(b0.velocity - a0.velocity, b1.velocity - a1.velocity, b2.velocity - a2.velocity,
                       b3.velocity - a3.velocity);
    later = with.damped ? columns(b0.predicted - a0.predicted, b1.predicted - a1.predicted,
                                  b2.predicted - a2.predicted, b3.predicted - a3.predicted)
                        : velocity;
    if constexpr (periodic) {  // the flow of a deforming cell comes on top
      const Vec3& rate = with.strain_rate;
      const Lanes3 flow{rate.x() * d.x, rate.y() * d.y, rate.z() * d.z};
      velocity = velocity + flow, later = later + flow;
    }
    spin_b = columns(b0.spin, b1.spin, b2.spin, b3.spin);
  }
  const Lanes3& n = t.normal[k];
  t.approach[k] = keep(t.touching[k], -later.dot(n));
  t.twist[k] = 0.5 * with.dt * n.dot(spin_a + spin_b);
  const Lanes3 turning = (t.distance[k] * g.share) * spin_a + (t.distance[k] * (1.0 - g.share)) * spin_b;
  t.displacement[k] = with.dt * (velocity - velocity.dot(n) * n - turning.cross(n));
}

template <class Normal, class Tangential>
EPAFI_LANES void find_response(SphereTile& t, std::size_t k, const SphereLaw<Normal, Tangential>& law) {
  KinematicsOf<Lanes> at;
  at.overlap = t.overlap[k], at.approach_velocity = t.approach[k];
  at.effective_mass = t.group[k]->mass, at.effective_radius = t.group[k]->radius;
  const ResponseOf<Lanes> r = Normal::respond(law.normal, at);
  t.force[k] = r.force, t.energy[k] = keep(t.touching[k], r.energy);
  t.viscous[k] = keep(t.touching[k], (r.force - r.elastic_force) * at.approach_velocity);
  if constexpr (Tangential::is_present)
    t.stiffness[k] = Tangential::stiffness(law.tangential, r.stiffness),
    t.limit[k] = Tangential::friction(law.tangential) * r.force;
}

/// laws/smooth/spring.h: the old load turns with the plane, shrinks with the stiffness, follows the slip and stays
/// below the limit. Divisions and roots that no lane needs are left out.
EPAFI_LANES void pull(SphereTile& t, std::size_t k, double dt) {
  SphereGroup& g = *t.group[k];
  const Lanes3 &n = t.normal[k], &displacement = t.displacement[k];
  const LaneMask touching = t.touching[k];
  const Lanes stiffness = t.stiffness[k], limit = t.limit[k];
  const Lanes3 old{g.load_x, g.load_y, g.load_z};
  const Lanes before = old.dot(old);
  Lanes3 load = old + t.twist[k] * n.cross(old);
  load = load - n.dot(load) * n;
  const Lanes after = load.dot(load);
  const LaneMask turns = after > Lanes{};
  load = select(turns, sqrt(before / select(turns, after, lanes(1.0))), Lanes{}) * load;
  const Lanes3 start = load;
  const LaneMask softer = touching & (stiffness < g.stiffness);
  if (any(softer)) load = select(softer, stiffness / select(softer, g.stiffness, lanes(1.0)), lanes(1.0)) * load;
  load = load + stiffness * displacement;
  const Lanes square = load.dot(load);
  const LaneMask slides = touching & (square > limit * limit);
  if (any(slides)) load = select(slides, limit / sqrt(select(slides, square, lanes(1.0))), lanes(1.0)) * load;
  const Lanes energy = keep(touching, 0.5 * load.dot(load) / select(touching, stiffness, lanes(1.0)));
  const Lanes work = keep(touching, 0.5 * (start + load).dot(displacement));
  t.load[k] = {keep(touching, load.x), keep(touching, load.y), keep(touching, load.z)};
  t.slipped[k] = work - (energy - g.energy);
  if (dt > 0.0 || !g.loaded) {  // no time passes: what is remembered stays as it is
    g.load_x = t.load[k].x, g.load_y = t.load[k].y, g.load_z = t.load[k].z;
    g.stiffness = keep(touching, stiffness), g.energy = energy;
  }
  t.energy[k] += g.energy;
}

/// What the damper lost, and what the group remembers beside its springs.
EPAFI_LANES void remember(SphereTile& t, std::size_t k, double dt) {
  SphereGroup& g = *t.group[k];
  t.damped[k] = 0.5 * dt * (g.viscous + t.viscous[k]);
  if (!(dt > 0.0 || !g.loaded)) return;
  g.viscous = t.viscous[k], g.normal_force = select(t.touching[k], t.force[k], lanes(-1.0));
  g.loaded = any(t.touching[k]);
}

/// Adds to sums; of B to records where it lies in another block.
template <bool wall, bool across, bool periodic>
EPAFI_LANES void add_forces(const SphereTile& t, std::size_t k, const SphereArrays& with) {
  const SphereGroup& g = *t.group[k];
  SphereSum* sums = with.sums;
  const Lanes3 &n = t.normal[k], &load = t.load[k];
  const Lanes push = keep(t.touching[k], t.force[k]);
  Lanes f0 = load.x - push * n.x, f1 = load.y - push * n.y, f2 = load.z - push * n.z, f3 = t.energy[k];
  const Lanes3 moment = n.cross(load);
  const Lanes arm_a = t.distance[k] * g.share, arm_b = t.distance[k] * (1.0 - g.share);
  Lanes t0 = arm_a * moment.x, t1 = arm_a * moment.y, t2 = arm_a * moment.z, t3 = t.slipped[k];
  const Lanes arm = t.distance[k];
  Lanes v0 = arm * n.x * f0, v1 = arm * n.y * f1, v2 = arm * n.z * f2, v3{};
  transpose(f0, f1, f2, f3), transpose(t0, t1, t2, t3);
  const Lanes force[4] = {f0, f1, f2, f3}, torque[4] = {t0, t1, t2, t3};
  if (with.damped)
    for (int l = 0; l < lane_count; ++l) with.viscous[g.a[l]] += t.damped[k][l];
  if constexpr (wall) {
    for (int l = 0; l < lane_count; ++l) sums[g.a[l]].force += force[l], sums[g.a[l]].torque += torque[l];
    return;
  }
  if constexpr (periodic) {
    transpose(v0, v1, v2, v3);
    const Lanes virial[4] = {v0, v1, v2, v3};
    for (int l = 0; l < lane_count; ++l) with.virials[g.a[l]].sum += virial[l];
  }
  Lanes u0 = arm_b * moment.x, u1 = arm_b * moment.y, u2 = arm_b * moment.z, u3{};
  transpose(u0, u1, u2, u3);
  const Lanes torque_b[4] = {u0, u1, u2, u3}, no_energy{-1.0, -1.0, -1.0, 0.0};  // the owner keeps the energy
  // lane by lane, A and B: the order of a body's sum must not depend on which contacts share a group
  for (int l = 0; l < lane_count; ++l) {
    sums[g.a[l]].force += force[l], sums[g.a[l]].torque += torque[l];
    SphereSum& other = across ? with.records[g.record + static_cast<std::uint32_t>(l)] : sums[g.b[l]];
    if constexpr (across)
      other = SphereSum{no_energy * force[l], torque_b[l]};
    else
      other.force += no_energy * force[l], other.torque += torque_b[l];
  }
}

/// Reads the bodies of the groups, moves their springs on, adds their forces; the number of lanes that touch.
/// law(g): of a group. image: of the first group, in a periodic cell.
template <class Normal, class Tangential, bool wall, bool across, bool periodic, class LawOf>
EPAFI_LANES std::size_t evaluate(SphereGroup* g, SphereGroup* end, const SphereImages* image, const LawOf& law,
                                 const SphereArrays& with) {
  SphereTile t;
  std::size_t touching = 0;
  if constexpr (!Tangential::is_present)
    for (std::size_t k = 0; k < SphereTile::size; ++k) t.load[k] = Lanes3{}, t.slipped[k] = Lanes{};
  while (g < end) {
    for (t.count = 0; g < end && t.count < SphereTile::size; ++g, image += periodic)
      find_touching<wall, periodic>(t, *g, image, with);
    for (std::size_t k = 0; k < t.count; ++k) find_motion<wall, periodic>(t, k, with);
    for (std::size_t k = 0; k < t.count; ++k) find_response<Normal, Tangential>(t, k, law(*t.group[k]));
    if constexpr (Tangential::is_present)
      for (std::size_t k = 0; k < t.count; ++k) pull(t, k, with.dt);
    for (std::size_t k = 0; k < t.count; ++k) remember(t, k, with.dt);
    for (std::size_t k = 0; k < t.count; ++k) add_forces<wall, across, periodic>(t, k, with);
    LaneMask counts{};
    for (std::size_t k = 0; k < t.count; ++k) counts -= t.touching[k];
    touching += static_cast<std::size_t>(counts[0] + counts[1] + counts[2] + counts[3]);
  }
  return touching;
}

}  // namespace epafi
