/// @file contact_law.h  What a smooth law sees of a contact, and what it offers.
#pragma once
#include <concepts>

#include "engine/registry.h"
#include "engine/types.h"

namespace epafi {

/// One contact at one instant, in SI. overlap > 0 where bodies interpenetrate.
struct ContactKinematics {
  double overlap = 0.0;            ///< delta = -gap [m]
  double approach_velocity = 0.0;  ///< d(delta)/dt, > 0 while approaching [m/s]
  double effective_mass = 0.0;     ///< m* [kg]; the mass of the free body against a fixed one
  double effective_radius = 0.0;   ///< R* [m]; NaN where the law did not ask for curvature
};

}  // namespace epafi
