/// @file rolling_contact.h  Wheels on rails within the step: for every region that the search has found, a normal model
/// gives the patch of its approach, a tangential model the creep forces of the body's own velocities there.
///
/// Steady rolling: the tractions are those that the creepages of this moment would settle to. A patch of 12 mm is
/// rolled through in half a millisecond at 20 m/s; motions that are not slow against that are beyond the laws. The
/// rolling speed is the mean of forward and circumferential speed; below `slowest` creepages are taken over that, so
/// that a standing wheel slips as through a damper. A wheel that rolls backwards has its patch turned round.
///
/// Energies: creep forces dissipate force times slip (trapezoid over the step); the contact stores 2/5 N delta, exact
/// where the gap is a parabola.
#pragma once
#include <memory>
#include <string>

#include "engine/railway/rolling_regions.h"
#include "engine/step/pipeline.h"
#include "engine/units/registry.h"
#include "laws/material.h"

namespace epafi {

struct RollingSetup {
  std::string normal = "semi-hertz", tangential = "fastsim";
  int along = 24, across = 16;  ///< cells of a patch
  double friction_limit = 1.0;  ///< A of mu = mu0 ((1 - A) exp(-B w) + A), w the slip velocity (Polach 2005)
  double friction_decay = 0.0;  ///< B [s/m]
  double slowest = 0.05;        ///< [m/s], > 0
  MaterialTable materials;
};

/// Keys of [contact.wheel_rail], with the names of all models.
std::vector<Field> rolling_fields();

/// On top of `below`, which sees all other contacts. `regions` must outlive it.
std::unique_ptr<ContactModel> make_rolling_contact(const RollingSetup& setup, const RollingRegions& regions,
                                                   std::unique_ptr<ContactModel> below);

/// What a step on this pair of models can bear: stiffness of a contact [N/m] and damping by creepage [N s/m] at this
/// load [N], wheel radius [m] and speed [m/s].
struct RollingLimits {
  double stiffness = 0.0, damping = 0.0;
};
RollingLimits rolling_limits(const RollingSetup& setup, const MaterialPair& pair, double load, double radius,
                             double speed);

}  // namespace epafi
