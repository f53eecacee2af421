/// @file rolling.h  Wheels on rails and springs of a scene: builds their stages, and gives the time step that they
/// need.
#pragma once
#include "laws/springs/spring_forces.h"
#include "laws/wheel_rail/rolling_contact.h"
#include "scenes/assemble.h"

namespace epafi {

RollingSetup rolling_setup(const Scene& scene);
/// Adds the search for contact regions to the narrow phase, and the laws of rolling contact to the contact model.
void add_rolling(Assembly& assembly);
std::vector<SpringElement> springs_of(const Assembly& assembly);
/// Present force of each spring on its body, without dashpot, along the axes of its far end [N].
std::vector<Vec3> spring_loads(const Assembly& assembly);
/// Adds springs to the contact model; bodies must exist. Frames follow the track if the scene has one only, else x.
void add_springs(Assembly& assembly);
/// Relative oscillation of the energy of bodies on springs within a period, under velocity Verlet and Moreau-Jean:
/// (omega dt)^2 / 4.
double swing_on_springs(const Assembly& assembly);
/// Largest time step for wheels on rails and springs; infinite without them.
TimeStep railway_step(const Assembly& assembly);

/// "; contact.wheel_rail.normal = "semi-hertz" takes the whole gap", by the reason that a model gives for not holding;
/// empty where no other model does better.
std::string model_remedy(const std::string& reason);

}  // namespace epafi
