/// @file critical_step.h  The time step that resolves the shortest impact, with the reason (case B02: velocity Verlet
/// has errors of 2.6e-3 in the restitution at 10 steps per Hertz contact, 4.3e-4 at 20). Stability:
/// scenes/step_estimate.h.
#pragma once
#include <string>

#include "laws/smooth/make_smooth_contact.h"

namespace epafi {

/// Part of the contact time that `time_step = "auto"` takes.
inline constexpr double auto_step_part = 0.1;
/// The same for contacts of a servo wall, which rebounds until all its work is dissipated or stored: the ledger's error
/// of it is (pi/20)^2/6 = 0.4 % (critical_step.cpp), with other errors of a column at that step up to 1 %.
inline constexpr double pressed_step_part = 0.05;

/// The hardest contact a pair of materials is expected to see.
struct ExpectedContact {
  double effective_mass = 0.0;    ///< m* [kg], of the lightest bodies
  double effective_radius = 0.0;  ///< R* [m], of the smallest bodies; unused by the linear law
  double speed = 0.0;             ///< impact speed [m/s], > 0 where the law is Hertzian
  double moved_mass = 0.0;        ///< effective mass if it differs from the law's m*: servo walls [kg]
  double part = auto_step_part;   ///< of the contact time
};

/// One impact of two bodies by the normal law alone.
struct ImpactEstimate {
  double contact_time = 0.0;     ///< from first touch to the end of force [s]
  double largest_overlap = 0.0;  ///< [m]
  double largest_force = 0.0;    ///< [N]
  double restitution = 0.0;      ///< [-]
};

struct StepLimit {
  ImpactEstimate impact;
  double auto_step = 0.0;  ///< smaller of that part of the contact time and half of m*/c [s]
  std::string reason;      ///< one line with numbers and units
};

/// t_c = 2.868 (m*^2 / (R* E*^2 v))^(1/5) of an elastic Hertz impact [s] (Johnson 1985, eq. 11.24)
double hertz_contact_time(double effective_mass, double effective_radius, double effective_modulus, double speed);

/// sqrt(2 g h): impact speed after a fall of h [m/s].
double fall_speed(double gravity, double height);

/// Integrates one impact of the pair by the law of the set-up (Runge-Kutta 4, 4000 steps of the elastic contact time).
ImpactEstimate estimate_impact(const SmoothSetup& setup, const MaterialPair& pair, const ExpectedContact& contact);

/// Time step for one pair of materials; the caller takes the smallest over its pairs. The set-up must pass
/// check_smooth.
StepLimit critical_step(const SmoothSetup& setup, const MaterialPair& pair, const ExpectedContact& contact);

}  // namespace epafi
