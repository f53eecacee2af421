#include "laws/nonsmooth/contact_problem.h"

#include "engine/error.h"
#include "engine/parallel.h"

namespace epafi {

namespace {

/// W_ii = (1/m_a + 1/m_b) 1 + sum over both bodies of (arm x d_j).I^-1 (arm x d_k) over the axes d of the frame.
Mat3 diagonal_block(const ContactProblem& p, std::size_t i) {
  Mat3 block = (p.inverse_mass[p.a[i]] + p.inverse_mass[p.b[i]]) * Mat3::Identity();
  if (!p.rotates) return block;
  Mat3 axes;
  axes << p.frame[i].normal, p.frame[i].tangent1, p.frame[i].tangent2;
  const auto add = [&](Slot body, const Vec3& arm) {
    Mat3 lever;
    for (int k = 0; k < 3; ++k) lever.col(k) = arm.cross(axes.col(k));
    block += lever.transpose() * (p.inverse_inertia[body] * lever);
  };
  add(p.a[i], p.arm_a[i]);
  add(p.b[i], p.arm_b[i]);
  return 0.5 * (block + block.transpose());
}

}  // namespace

void ContactProblem::load_bodies(const World& world, double dt) {
  rotates = world.rotates();
  const std::size_t n = world.size();
  inverse_mass = world.inverse_mass;
  free.linear.resize(n), free.angular.resize(rotates ? n : 0), inverse_inertia.resize(rotates ? n : 0);
  parallel_for(n, [&](std::size_t k) {
    const auto s = static_cast<Slot>(k);
    free.linear[k] = world.velocity[k] + dt * world.free_acceleration(s);
    if (!rotates) return;
    free.angular[k] = world.angular_velocity[k];
    const Vec3& j = world.inverse_inertia[k];
    if (j.x() == j.y() && j.y() == j.z()) {  // spheres, cubes and fixed bodies: the axes do not matter
      inverse_inertia[k] = j.x() * Mat3::Identity();
    } else {
      const Mat3 rotation = world.orientation[k].toRotationMatrix();
      inverse_inertia[k] = rotation * j.asDiagonal() * rotation.transpose();
    }
  });
}

void ContactProblem::load_contacts(const World& world, const ContactSet& contacts) {
  const std::size_t n = contacts.size();
  a = contacts.a, b = contacts.b;
  frame.resize(n), diagonal.resize(n), arm_a.resize(rotates ? n : 0), arm_b.resize(rotates ? n : 0);
  friction.assign(n, 0.0), offset.assign(n, 0.0), lag.clear();
  parallel_for(n, [&](std::size_t i) {
    frame[i] = contact_frame(contacts.normal[i]);
    if (rotates) arm_a[i] = contacts.arm[i], arm_b[i] = contacts.arm_b(i, world);
    diagonal[i] = diagonal_block(*this, i);
  });
  incidence.build(contacts, world.size());
}

Vec3 ContactProblem::relative_velocity(std::size_t i, const BodyVelocities& v) const {
  Vec3 u = v.linear[b[i]] - v.linear[a[i]];
  if (rotates) u += v.angular[b[i]].cross(arm_b[i]) - v.angular[a[i]].cross(arm_a[i]);
  return to_frame(i, u);
}

Vec3 ContactProblem::free_relative_velocity(std::size_t i) const {
  if (!is_free(a[i]) && !is_free(b[i])) return Vec3::Zero();
  return with_offset(i, relative_velocity(i, free));
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
  out.linear.resize(free.linear.size()), out.angular.resize(free.angular.size());
  if (moments) moments->resize(free.angular.size());
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
  u.resize(size());
  parallel_for(size(), [&](std::size_t i) { u[i] = with_offset(i, relative_velocity(i, v)); });
}

double ContactProblem::mean_effective_mass() const {
  double sum = 0.0;
  std::size_t count = 0;
  for (const Mat3& block : diagonal)
    if (block(0, 0) > 0.0) sum += block(0, 0), ++count;
  return count > 0 ? static_cast<double>(count) / sum : 1.0;
}

}  // namespace epafi
