#include "laws/nonsmooth/contact_problem.h"

#include <algorithm>

#include "engine/threads/order_free_sum.h"
#include "engine/threads/parallel_order.h"
#include "engine/units/error.h"

namespace epafi {

namespace {

/// Adds the columns of S^T J S, S x = arm cross x, J symmetric: change of the velocity at `arm` by rotation.
void add_turning(const Mat3& j, const Vec3& arm, Vec3& c0, Vec3& c1, Vec3& c2) {
  const double x = arm.x(), y = arm.y(), z = arm.z();
  const Vec3 n0 = z * j.col(1) - y * j.col(2), n1 = x * j.col(2) - z * j.col(0), n2 = y * j.col(0) - x * j.col(1);
  const double xy = z * n1.y() - y * n1.z(), xz = z * n2.y() - y * n2.z(), yz = x * n2.z() - z * n2.x();
  c0 += Vec3(z * n0.y() - y * n0.z(), xy, xz);
  c1 += Vec3(xy, x * n1.z() - z * n1.x(), yz);
  c2 += Vec3(xz, yz, y * n2.x() - x * n2.y());
}

/// n.(W_ii n) = 1/m_a + 1/m_b + sum over both bodies of (arm x n).I^-1 (arm x n).
double normal_mobility(const ContactProblem& p, std::size_t i) {
  const Slot a = p.a[i], b = p.b[i];
  double mobility = p.inverse_mass[a] + p.inverse_mass[b];
  if (!p.rotates) return mobility;
  for (const auto& [slot, arm] : {std::pair(a, &p.arm_a[i]), std::pair(b, &p.arm_b[i])}) {
    const Vec3 lever = arm->cross(p.frame[i].normal);
    mobility += lever.dot(p.inverse_inertia[slot] * lever);
  }
  return mobility;
}

/// W_ii = (1/m_a + 1/m_b) 1 + sum over both bodies of (arm x d_j).I^-1 (arm x d_k) over the axes d of the frame.
Mat3 diagonal_block(const ContactProblem& p, std::size_t i) {
  const Slot a = p.a[i], b = p.b[i];
  const double mass = p.inverse_mass[a] + p.inverse_mass[b];
  if (!p.rotates) return mass * Mat3::Identity();
  Vec3 c0(mass, 0, 0), c1(0, mass, 0), c2(0, 0, mass);  // world axes
  add_turning(p.inverse_inertia[a], p.arm_a[i], c0, c1, c2);
  add_turning(p.inverse_inertia[b], p.arm_b[i], c0, c1, c2);
  const auto times = [&](const Vec3& d) { return Vec3(d.x() * c0 + d.y() * c1 + d.z() * c2); };
  const auto& [n, t1, t2] = p.frame[i];
  const Vec3 at_n = times(n), at_t1 = times(t1);
  const double n1 = t1.dot(at_n), n2 = t2.dot(at_n), t12 = t2.dot(at_t1);
  Mat3 block;
  block << n.dot(at_n), n1, n2, n1, t1.dot(at_t1), t12, n2, t12, t2.dot(times(t2));
  return block;
}

}  // namespace

void ContactProblem::load_bodies(const World& world, double dt, const Pushes* pushes) {
  rotates = world.rotates();
  guides.clear();
  const std::size_t n = world.size();
  parallel_copy(world.inverse_mass, inverse_mass);
  parallel_copy(world.id, id);
  renew(free.linear, n);
  renew(free.angular, rotates ? n : 0);
  renew(inverse_inertia, rotates ? n : 0);
  parallel_for(n, [&](std::size_t k) {
    const auto s = static_cast<Slot>(k);
    free.linear[k] = world.velocity[k] + dt * world.free_acceleration(s);
    if (pushes) free.linear[k] += world.inverse_mass[k] * pushes->linear[k];
    if (!rotates) return;
    free.angular[k] = world.angular_velocity[k];
    if (pushes && world.is_movable(s)) free.angular[k] += world.apply_inverse_inertia(s, pushes->angular[k]);
    if (world.columns().external_torque && world.is_movable(s))
      free.angular[k] += dt * world.apply_inverse_inertia(s, world.external_torque[k]);
    const Vec3 j = world.inverse_inertia_of(s);
    if (j.x() == j.y() && j.y() == j.z()) {  // spheres, cubes and fixed bodies: the axes do not matter
      inverse_inertia[k] = j.x() * Mat3::Identity();
    } else {
      const Mat3 rotation = world.orientation[k].toRotationMatrix();
      inverse_inertia[k] = rotation * j.asDiagonal() * rotation.transpose();
    }
  });
}

void ContactProblem::guide(Slot s, const Vec3& direction, const Vec3& driven, double free_speed, double mobility) {
  EPAFI_REQUIRE(rotates, "a guided body takes the place of a rotation");
  constexpr double aside = 1e-9;  // of the mobility: solvers take the inverse of masses. Thrown away after each step
  const Vec3 axis = contact_frame(direction).tangent1;
  guides.push_back({s, direction, axis});
  inverse_mass[s] = aside * mobility;
  inverse_inertia[s] = mobility * ((1.0 - aside) * axis * axis.transpose() + aside * Mat3::Identity());
  free.linear[s] = driven;
  free.angular[s] = free_speed * axis;
}

void ContactProblem::load_contacts(const World& world, const ContactSet& contacts) {
  const std::size_t n = contacts.size();
  parallel_copy(contacts.a, a);
  parallel_copy(contacts.b, b);
  renew(frame, n);
  renew(mobility, n);
  renew(arm_a, rotates ? n : 0);
  renew(arm_b, rotates ? n : 0);
  diagonal.clear();
  parallel_fill(friction, n, 0.0);
  parallel_fill(offset, n, 0.0);
  lag.clear();
  parallel_for(n, [&](std::size_t i) {
    frame[i] = contact_frame(contacts.normal[i]);
    if (rotates) {
      arm_a[i] = contacts.arm[i];
      arm_b[i] = contacts.arm_b(i, world);
    }
    for (const Guide& g : guides) {
      if (a[i] == g.slot) arm_a[i] = g.arm();
      if (b[i] == g.slot) arm_b[i] = g.arm();
    }
    mobility[i] = normal_mobility(*this, i);
  });
  incidence.build(contacts, world.size());
  is_colored_ = is_grouped_ = false;
}

void ContactProblem::load_diagonal() {
  if (diagonal.size() == size()) return;
  renew(diagonal, size());
  parallel_for(size(), [&](std::size_t i) {
    if (mobility[i] > 0.0)
      diagonal[i] = diagonal_block(*this, i);
    else
      diagonal[i].setZero();
  });
}

Mat3 ContactProblem::diagonal_of(std::size_t i) const { return diagonal_block(*this, i); }

void ContactProblem::push(BodyVelocities& v, std::size_t i, const Vec3& r) const {
  const Vec3 p = to_world(i, r);
  v.linear[a[i]] -= inverse_mass[a[i]] * p;
  v.linear[b[i]] += inverse_mass[b[i]] * p;
  if (!rotates) return;
  v.angular[a[i]] -= inverse_inertia[a[i]] * arm_a[i].cross(p);
  v.angular[b[i]] += inverse_inertia[b[i]] * arm_b[i].cross(p);
}

ContactProblem::BodyImpulse ContactProblem::impulse_on(Slot s, const Impulses& r) const {
  BodyImpulse sum;
  incidence.for_each(s, [&](std::uint32_t i, double as_a) {
    const Vec3 p = -as_a * to_world(i, r[i]);  // r acts on B, -r on A
    sum.linear += p;
    if (rotates) sum.angular += (as_a > 0.0 ? arm_a[i] : arm_b[i]).cross(p);
  });
  return sum;
}

void ContactProblem::velocities(const Impulses& r, BodyVelocities& out, std::vector<Vec3>* moments) const {
  EPAFI_REQUIRE(r.size() == size(), "one impulse per contact");
  renew(out.linear, free.linear.size());
  renew(out.angular, free.angular.size());
  if (moments) renew(*moments, free.angular.size());
  parallel_for(free.linear.size(), [&](std::size_t k) {
    const auto s = static_cast<Slot>(k);
    const BodyImpulse sum = is_free(s) ? impulse_on(s, r) : BodyImpulse{};
    out.linear[k] = free.linear[k] + inverse_mass[k] * sum.linear;
    if (!rotates) return;
    out.angular[k] = free.angular[k] + inverse_inertia[k] * sum.angular;
    if (moments) (*moments)[k] = sum.angular;
  });
}

void ContactProblem::relative_velocities(const BodyVelocities& v, std::vector<Vec3>& u) const {
  renew(u, size());
  parallel_for(size(), [&](std::size_t i) { u[i] = with_offset(i, relative_velocity(i, v)); });
}

const Coloring& ContactProblem::coloring() const {
  if (!is_colored_) coloring_.update(a, b, {inverse_mass, id});
  is_colored_ = true;
  return coloring_;
}

const LaneGroups& ContactProblem::lane_groups() const {
  if (!is_grouped_) lane_groups_.form(coloring(), static_cast<Slot>(inverse_mass.size()));
  is_grouped_ = true;
  return lane_groups_;
}

double ContactProblem::mean_effective_mass() const {
  const auto counted = [&](std::size_t i) { return std::size_t{mobility[i] > 0.0}; };
  const auto count = static_cast<double>(block_sum<std::size_t>(size(), counted));
  const double sum = order_free_sum(size(), [&](std::size_t i) { return std::max(mobility[i], 0.0); });
  return count > 0.0 ? count / sum : 1.0;
}

}  // namespace epafi
