/// @file contact_problem.h  The friction-contact problem of one step, in body space and matrix-free.
///   v = v_free + M^-1 H r,   u = H^T v + w,   K*_mu contains u~, orthogonal to r in K_mu   (Moreau 1988; Jean 1999)
/// r: impulses on B, u: velocities of B against A, both in contact frames (n, t1, t2). w is the velocity required by
/// restitution or allowed by an open gap, and the slip's lag. With q = H^T v_free + w and W = H^T M^-1 H this is u = W
/// r + q. Memory and work are linear in contacts; assembled.h gives M, H and W as sparse matrices.
#pragma once
#include <vector>

#include "engine/state/contacts.h"
#include "engine/state/frame.h"
#include "engine/state/incidence.h"
#include "engine/step/pipeline.h"
#include "laws/nonsmooth/coloring.h"
#include "laws/nonsmooth/lane_groups.h"

namespace epafi {

/// One impulse per contact in its frame [N s].
using Impulses = std::vector<Vec3>;

/// Velocities of all bodies; `angular` is empty in worlds without rotation.
struct BodyVelocities {
  std::vector<Vec3> linear;   ///< [m/s]
  std::vector<Vec3> angular;  ///< world axes [rad/s]
};

/// A body that moves along one line only (a servo wall). The equations treat it as a body that rotates about `axis`
/// with the same arm = direction x axis for all contacts. Since axis x arm = direction, its angular velocity is speed *
/// axis, and the usual masses and inertias describe it.
struct Guide {
  Slot slot;
  Vec3 direction, axis;  ///< unit, perpendicular
  Vec3 arm() const { return direction.cross(axis); }
  double speed(const BodyVelocities& v) const { return v.angular[slot].dot(axis); }
};

struct ContactProblem {
  bool rotates = false;

  // bodies, by slot; fixed and driven ones have inverse mass and inertia 0
  std::vector<double> inverse_mass;   ///< [1/kg]
  std::vector<BodyId> id;             ///< colours of sweeps depend on them
  std::vector<Mat3> inverse_inertia;  ///< world axes [1/(kg m^2)]; empty without rotation
  BodyVelocities free;                ///< v_free: with gravity and external forces, without contacts

  // contacts, in canonical order
  UnwrittenStream<Slot> a, b;
  std::vector<ContactFrame> frame;
  std::vector<Vec3> arm_a, arm_b;    ///< from the centres to the contact point [m]; empty without rotation
  UnwrittenStream<double> friction;  ///< mu >= 0
  UnwrittenStream<double> offset;    ///< w_N [m/s]: the contact demands u_N = (H^T v)_N + w_N >= 0
  std::vector<Vec3> lag;             ///< w_T [m/s], (0, t1, t2): offset of the slip velocity; empty: 0
  UnwrittenStream<double> mobility;  ///< W_NN of the contact itself [1/kg]; 0 where neither body can move
  std::vector<Mat3> diagonal;        ///< W_ii [1/kg], after load_diagonal(); 0 where the mobility is 0
  Incidence incidence;
  std::vector<Guide> guides;  ///< servo walls; their worlds rotate

  std::size_t size() const { return a.size(); }
  bool is_free(Slot s) const { return inverse_mass[s] > 0.0; }

  /// Loads bodies with v_free = v + dt * (acceleration without contact), plus pushes.
  void load_bodies(const World& world, double dt, const Pushes* pushes = nullptr);
  /// Makes driven body s free along the unit vector `direction`: its speed there is free_speed [m/s] + mobility [1/kg]
  /// * J for impulses J. driven: its other velocity [m/s]. Call it after load_bodies, before load_contacts.
  void guide(Slot s, const Vec3& direction, const Vec3& driven, double free_speed, double mobility);
  /// Loads geometry and mobilities of the contacts; sets friction and offset to 0. Call it after load_bodies.
  void load_contacts(const World& world, const ContactSet& contacts);
  /// Computes W_ii, which solvers need. A step whose start is the solution omits it (a tenth of the step of a pyramid
  /// at rest).
  void load_diagonal();
  /// W_ii of one contact [1/kg], loaded or not.
  Mat3 diagonal_of(std::size_t i) const;
  /// Applies impulse r [N s] at contact i: v += M^-1 H_i r.
  void push(BodyVelocities& v, std::size_t i, const Vec3& r) const;
  /// Excludes a contact: no impulse acts there.
  void leave_out(std::size_t i) {
    mobility[i] = 0.0;
    if (!diagonal.empty()) diagonal[i].setZero();
  }

  /// (H^T v)_i: velocity of B against A at contact i, in its frame.
  Vec3 relative_velocity(std::size_t i, const BodyVelocities& v) const {
    Vec3 u = v.linear[b[i]] - v.linear[a[i]];
    if (rotates) u += v.angular[b[i]].cross(arm_b[i]) - v.angular[a[i]].cross(arm_a[i]);
    return to_frame(i, u);
  }
  /// q_i = (H^T v_free + w)_i; 0 if no impulse acts (neither body can move, or the contact is excluded).
  Vec3 free_relative_velocity(std::size_t i) const {
    if (mobility[i] <= 0.0) return Vec3::Zero();
    return with_offset(i, relative_velocity(i, free));
  }
  /// Transforms an impulse on B from the frame of contact i to world axes.
  Vec3 to_world(std::size_t i, const Vec3& r) const {
    return frame[i].normal * r.x() + frame[i].tangent1 * r.y() + frame[i].tangent2 * r.z();
  }
  Vec3 to_frame(std::size_t i, const Vec3& x) const {
    return {frame[i].normal.dot(x), frame[i].tangent1.dot(x), frame[i].tangent2.dot(x)};
  }
  /// (H r)_s: impulse [N s] and moment [N m s] on body s, gathered in a fixed order.
  struct BodyImpulse {
    Vec3 linear = Vec3::Zero(), angular = Vec3::Zero();
  };
  BodyImpulse impulse_on(Slot s, const Impulses& r) const;
  /// v = v_free + M^-1 H r. moments: if given and bodies rotate, receives the moments of r on the bodies [N m s].
  void velocities(const Impulses& r, BodyVelocities& out, std::vector<Vec3>* moments = nullptr) const;
  /// u_i = (H^T v)_i + w_i of a relative velocity (H^T v)_i.
  Vec3 with_offset(std::size_t i, Vec3 relative) const {
    relative.x() += offset[i];
    if (!lag.empty()) relative += lag[i];
    return relative;
  }
  /// u = H^T v + w at every contact.
  void relative_velocities(const BodyVelocities& v, std::vector<Vec3>& u) const;
  /// 1 / mean of the normal diagonals [kg]: the scale between velocities and impulses, 1 without contacts.
  double mean_effective_mass() const;

  /// Orders of sweeps over the contacts, computed at the first call of a step. Not thread-safe.
  const Coloring& coloring() const;
  const LaneGroups& lane_groups() const;

 private:
  mutable Coloring coloring_;
  mutable LaneGroups lane_groups_;
  mutable bool is_colored_ = false, is_grouped_ = false;  ///< since the contacts were loaded
};

}  // namespace epafi
