/// @file law_potential.h  Whether the force of the scene's smooth law has a potential between all bodies that meet.
/// Springs at points of contact have one where the points stay or fade in: at spheres, and on planes, where they are
/// corners or the points of round shapes. Where polyhedra or cylinders meet each other points come and go with faces
/// and edges at a finite depth, and with them their energy: elastic ones gain or lose up to 0.15 of it in a second.
/// `overlap-volume` follows a potential.
#pragma once
#include "scenes/assemble.h"

namespace epafi {

/// What to write where the law has no potential between some bodies that move; "" where it has one.
std::string way_to_a_potential(const Assembly& assembly);

/// Throws a SceneError where such bodies are nearly elastic, so that no loss hides the error.
void refuse_missing_potential(const Assembly& assembly);

}  // namespace epafi
