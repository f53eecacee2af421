/// @file rolling.h  Wheels on rails and springs in a scene: from their tables to the stages, and what a time step must
/// resolve.
#pragma once
#include "laws/springs/spring_forces.h"
#include "laws/wheel_rail/rolling_contact.h"
#include "scenes/assemble.h"

namespace epafi {

RollingSetup rolling_setup(const Scene& scene);
/// Puts the search for contact regions over the narrow phase and the laws of rolling contact over the contact model.
void add_rolling(Assembly& assembly);
std::vector<SpringElement> springs_of(const Assembly& assembly);
/// What each spring pulls its body with now, by its stretch alone, along the axes of its far end [N].
std::vector<Vec3> spring_loads(const Assembly& assembly);
/// Puts springs over the contact model; bodies must be there. Frames follow the track if the scene has one only, else
/// x.
void add_springs(Assembly& assembly);
/// By which share the energy of bodies on springs swings within their periods under velocity Verlet and Moreau-Jean,
/// (omega dt)^2 / 4: it comes back.
double swing_on_springs(const Assembly& assembly);
/// What wheels on rails and springs allow; infinite where there are none.
TimeStep railway_step(const Assembly& assembly);

/// "; contact.wheel_rail.normal = "semi-hertz" takes the whole gap", by the reason that a model gives for not holding;
/// empty where no other model does better.
std::string model_remedy(const std::string& reason);

}  // namespace epafi
