/// @file periodic_scene.h  Requirements of a periodic cell on a scene, and its events.
#pragma once
#include "scenes/assemble.h"

namespace epafi {

/// Adds the events of the cell. Throws SceneError where the cell is too small for its bodies, or a wall would not
/// repeat or deform with it.
void add_cell(Assembly& assembly);

}  // namespace epafi
