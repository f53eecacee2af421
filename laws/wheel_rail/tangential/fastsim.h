/// @file fastsim.h  The simplified theory of rolling contact (Kalker 1982): traction grows with rigid slip along a
/// strip, as on a bed of springs, until it meets Coulomb's bound. Flexibilities make it exact for small creepage on an
/// ellipse. Fails for large spin on the parabolic bound (+46 % at phi a = 0.04): flagged by the caller.
#pragma once
#include "laws/wheel_rail/tangential/kalker_table.h"
#include "laws/wheel_rail/tangential/strips.h"

namespace epafi {

/// Displacement per traction, L [m/Pa]. Kalker's three values give the right force for each creepage alone, but turn
/// the direction of slip where everything slides; one value keeps it. `blended` goes from three to one as the patch
/// slides.
enum class FlexibilityRule { three, one, blended };

struct Flexibility {
  double longitudinal, lateral, spin;  ///< L1, L2, L3
};

/// L1 = 8 a / (3 c11 G), L2 = 8 a / (3 c22 G), L3 = pi a sqrt(a/b) / (4 c23 G)  (Kalker 1982, eq. 19).
Flexibility kalker_flexibility(const RollingCase& c, const KalkerCoefficients& k, FlexibilityRule rule);

/// `store` keeps the tractions and slips by cell.
StripSolution fastsim(const StripPatch& patch, const Flexibility& flexibility, double friction,
                      const Creepage& creepage, bool store);

}  // namespace epafi
