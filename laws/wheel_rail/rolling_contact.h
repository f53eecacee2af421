/// @file rolling_contact.h  Contact of wheels on rails in a step: for every region of the search, a normal model
/// computes the patch from the approach, a tangential model the creep forces from the velocities.
///
/// Steady rolling: tractions are the stationary ones of the present creepages. At 20 m/s a patch of 12 mm is passed in
/// 0.6 ms; faster motions are beyond the laws. The rolling speed is the mean of forward and circumferential speed, at
/// least `slowest` in creepages, so that a standing wheel slips as through a damper. The patch of a wheel that rolls
/// backwards is reversed.
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

/// Adds wheel-rail contact to `below`, which handles all other contacts. `regions` must outlive it.
std::unique_ptr<ContactModel> make_rolling_contact(const RollingSetup& setup, const RollingRegions& regions,
                                                   std::unique_ptr<ContactModel> below);

/// Stiffness of a contact [N/m] and damping by creepage [N s/m] at this load [N], wheel radius [m] and speed [m/s], for
/// the stable time step.
struct RollingLimits {
  double stiffness = 0.0, damping = 0.0;
};
RollingLimits rolling_limits(const RollingSetup& setup, const MaterialPair& pair, double load, double radius,
                             double speed);

}  // namespace epafi
