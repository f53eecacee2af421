/// @file critical_step.h  How large a time step smooth contact allows, and why.
/// Two limits: the shortest impact must be resolved (case B02: velocity Verlet errs by 2.6e-3 in the restitution at 10
/// steps per Hertz contact, 4.3e-4 at 20), and a packing's stiffest mode must stay stable, dt < 2/omega.
#pragma once
#include <string>

#include "laws/smooth/make_smooth_contact.h"

namespace epafi {

/// Part of the contact time that `time_step = "auto"` takes.
inline constexpr double auto_step_part = 0.1;

/// The hardest contact a pair of materials is expected to see.
struct ExpectedContact {
  double effective_mass = 0.0;    ///< m* [kg], of the lightest bodies
  double mass = 0.0;              ///< of the lightest body [kg]
  double effective_radius = 0.0;  ///< R* [m], of the smallest bodies; unused by the linear law
  double speed = 0.0;             ///< impact speed [m/s], > 0 where the law is Hertzian
  int coordination = 8;           ///< contacts of a body; 8 is high for a dense packing of equal spheres
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
  double stable_step = 0.0;  ///< 2/omega of the stiffest mode at the largest overlap [s]
  double auto_step = 0.0;    ///< min of auto_step_part contact times, half the stable step, half of m*/c [s]
  std::string reason;        ///< one line with numbers and units
};

/// t_c = 2.868 (m*^2 / (R* E*^2 v))^(1/5) of an elastic Hertz impact [s] (Johnson 1985, eq. 11.24)
double hertz_contact_time(double effective_mass, double effective_radius, double effective_modulus, double speed);

/// sqrt(2 g h): impact speed after a fall of h [m/s].
double fall_speed(double gravity, double height);

/// 2/omega_max [s] of bodies of mass m with Z contacts of stiffness k_n and k_t each: omega^2 = 2 K / m.
/// Z <= 2: K = Z max(k_n, 7/2 k_t), exact for the chain (case B02: sqrt(m/k_n)) and for a solid sphere sliding at one
/// contact against a fixed body to a factor sqrt(2) on the safe side. Beyond: contacts spread evenly over all
/// directions, K = Z/3 max(k_n + 2 k_t, 5 k_t), translation and spin of solid spheres, neighbours in antiphase; an
/// estimate, not a bound.
/// A dashpot c [N s/m] in every contact, gamma = 2 (K/k) c / m: velocity Verlet with velocities predicted by the last
/// force has the root -1 at omega^2 dt^2 + 4 gamma dt = 4, hence dt = 2/(gamma + sqrt(gamma^2 + omega^2)). Beyond it
/// forces of a packing alternate from step to step, bounded because contacts do not pull, while positions look at rest.
/// K/k is Z/2 there: of 4000 jammed spheres some groups alternated at half the limit that Z/3 gives.
double stable_step(double normal_stiffness, double tangential_stiffness, double mass, int coordination,
                   double dashpot = 0.0);

/// Integrates one impact of the pair by the law of the set-up (Runge-Kutta 4, 4000 steps of the elastic contact time).
ImpactEstimate estimate_impact(const SmoothSetup& setup, const MaterialPair& pair, const ExpectedContact& contact);

/// Both limits for one pair of materials; the caller takes the smallest over its pairs. The set-up must pass
/// check_smooth.
StepLimit critical_step(const SmoothSetup& setup, const MaterialPair& pair, const ExpectedContact& contact);

}  // namespace epafi
