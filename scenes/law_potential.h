/// @file law_potential.h  Whether the force of the scene's smooth law has a potential between all bodies that meet.
/// Contact springs have one if points appear at zero depth: on spheres, and on planes, where they are corners or points
/// of round shapes. Between polyhedra or cylinders points appear and vanish at a finite depth, and with them their
/// energy: elastic bodies gain or lose up to 0.15 of it in a second. `overlap-volume` has a potential.
#pragma once
#include "scenes/assemble.h"

namespace epafi {

/// Advice if the law has no potential between some moving bodies; else "".
std::string way_to_a_potential(const Assembly& assembly);

/// Throws a SceneError if such bodies are nearly elastic, since losses would not hide the error.
void refuse_missing_potential(const Assembly& assembly);

}  // namespace epafi
