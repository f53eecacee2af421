/// @file spring.h  An incremental spring in the contact plane with a largest load: friction (force) and rolling
/// (moment). Stiffness follows the overlap. When it falls, the load falls with it: otherwise a closed cycle of shear
/// and unloading would create T^2/2 (1/k_t(d2) - 1/k_t(d1)) (Walton and Braun 1986; case A13).
#pragma once
#include <cmath>

#include "engine/state/state_visitor.h"
#include "laws/contact_law.h"

namespace epafi {

/// History of a contact: 32 bytes.
struct Spring {
  Vec3 load = Vec3::Zero();  ///< on A: T [N] or M [N m], in the contact plane
  double stiffness = 0.0;    ///< [N/m] or [N m/rad]
};

/// [J]
inline double energy_of(const Spring& s) { return s.stiffness > 0.0 ? 0.5 * s.load.squaredNorm() / s.stiffness : 0.0; }
/// The same with bodies A and B exchanged.
inline void exchange(Spring& spring) { spring.load = -spring.load; }

template <>
inline constexpr bool is_plain<Spring> = true;  // four doubles; Eigen's copy is not trivial by name only

/// A spring as passes over tiles of contacts remember it: 32 bytes.
struct alignas(32) TileSpring {
  Lanes load;  ///< x y z on A [N] or [N m], 1/stiffness [m/N] or [rad/(N m)]; 0: not loaded
};

/// The load after the contact plane has turned to normal n and the pair has spun by `twist` [rad] about it.
/// Its length is kept: projection alone would let it fade by half the square of the angle every step.
inline Vec3 turn_load(const Vec3& load, const Vec3& n, double twist) {
  const double before = load.squaredNorm();
  if (before == 0.0) return load;
  Vec3 turned = load + twist * n.cross(load);
  turned -= n.dot(turned) * n;
  const double after = turned.squaredNorm();
  return after > 0.0 ? Vec3(std::sqrt(before / after) * turned) : Vec3(0, 0, 0);
}

/// The nearest load of at most that length.
inline Vec3 within(const Vec3& load, double limit) {
  const double square = load.squaredNorm();
  return square > limit * limit ? Vec3(limit / std::sqrt(square) * load) : load;
}

/// The spring after a displacement [m or rad] of B against A; `load` is the turned load of `old`.
inline Spring extend(const Spring& old, const Vec3& load, double stiffness, const Vec3& displacement, double limit) {
  Spring now{load, stiffness};
  if (stiffness < old.stiffness) now.load *= stiffness / old.stiffness;
  now.load = within(now.load + stiffness * displacement, limit);
  return now;
}

/// One step of a spring of that stiffness and largest load.
inline FrictionResponse pull_spring(const SlipStep& step, double stiffness, double limit, const Spring& before,
                                    Spring& now) {
  const Vec3 load = turn_load(before.load, step.normal, step.twist);
  now = extend(before, load, stiffness, step.displacement, limit);
  return {now.load, energy_of(now), 0.5 * (load + now.load).dot(step.displacement)};
}

}  // namespace epafi
