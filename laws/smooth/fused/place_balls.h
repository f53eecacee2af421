/// @file place_balls.h  States of the balls of one body and what they felt, a vector a register: body by body by Eigen
/// they were a fifth of a step of clumps. The bits are Eigen's.
#pragma once
#include <span>

#include "engine/state/body_ball.h"
#include "engine/state/state_column.h"
#include "laws/smooth/fused/sphere_sum.h"

namespace epafi {

/// A body, and where its balls' states go.
struct BallsOfBody {
  const BodyState& body;
  const Quat* orientation;              ///< null: as authored
  Vec3 spin;                            ///< [rad/s]
  Vec3 inverse_inertia;                 ///< [1/(kg m^2)]; zero: of a held body
  bool is_late;                         ///< velocities at the time of the detection are others
  Vec3 twist;                           ///< then: torque times the time in between [N m s]
  Vec3 strain_rate;                     ///< of the cell [1/s]
  std::span<const std::uint32_t> used;  ///< its balls
  const BodyBall* balls;                ///< all, as the next ones
  Vec3* offsets;
  BodyState* states;
  Lanes* late_spins;  ///< the harmonic mean of the inverse moments is the fourth; or null
};
void place_balls(const BallsOfBody& balls);

/// Sums (and moments, or null) of balls, 0 again then, to force and torque about the centres of their bodies.
struct FeltByBalls {
  std::span<const std::uint32_t> used;
  std::size_t begin;      ///< the sums begin with those of this ball
  const BodyBall* balls;  ///< all, as the next ones
  const Vec3* offsets;    ///< null: the world does not rotate
  SphereSum* sums;
  Lanes* moments;
  double* loads;  ///< six numbers a ball [N], [N m]
};
void collect_balls(const FeltByBalls& felt);

}  // namespace epafi
