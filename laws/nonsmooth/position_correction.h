/// @file position_correction.h  Corrects overlap by moving bodies without changing their velocities, so that no kinetic
/// energy is created (split impulses; Guendelman, Bridson and Fedkiw 2003; Catto 2005). Displacements d = M^-1 H_N s, s
/// >= 0, with
///   d_N >= share * (overlap - slop)  where the overlap is beyond the slop,   d_N >= -max(gap, 0)  elsewhere.
/// A few normal sweeps solve this frictionless problem; the next step continues. The change of potential energy is
/// returned for the ledger. Limit: a tall jammed pile is corrected as slowly as the sweeps converge.
#pragma once
#include "laws/nonsmooth/lane_sweep.h"
#include "laws/nonsmooth/normal_rule.h"

namespace epafi {

struct CorrectionSettings {
  double share = 0.2;       ///< beta in [0, 1], of the overlap beyond the slop, per step; 0 is off
  double slop = 1e-4;       ///< relative to the smaller lever arm of the contact (centre to contact point)
  double band = 0.01;       ///< of the slop: nothing is done until an overlap exceeds slop (1 + band)
  double largest = 0.05;    ///< largest displacement of one step, relative to the same arm
  double tolerance = 1e-3;  ///< sweeps stop when they change less than this part of the demanded displacement
  int sweeps = 20;          ///< at most
};

class PositionCorrection {
 public:
  explicit PositionCorrection(const CorrectionSettings& settings) : settings_(settings) {}

  /// Moves the bodies of `world`; gaps: predicted for the next detection from the new velocities [m]. Returns the
  /// increase of potential energy of gravity and external forces [J].
  double apply(const ContactProblem& problem, const ContactSet& contacts, std::span<const double> gaps, World& world);

 private:
  bool demand(const ContactSet& contacts, std::span<const double> gaps, const World& world);
  template <class S>
  double move(S& sweep, const ContactProblem& problem, World& world);

  CorrectionSettings settings_;
  UnwrittenStream<double> demand_;  ///< minus the demanded normal displacement of each contact [m]
  BodyVelocities moved_;            ///< displacements take the place of velocities; zero at first
  Impulses nothing_;
  LaneSweep<true, NormalRule> with_rotation_;
  LaneSweep<false, NormalRule> without_rotation_;
};

}  // namespace epafi
