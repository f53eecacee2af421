/// @file periodic_scene.h  What a periodic cell asks of a scene, and its events.
#pragma once
#include "scenes/assemble.h"

namespace epafi {

/// Adds the events of the cell. Throws SceneError where the cell is too small for its bodies, or a wall would not
/// repeat or deform with it.
void add_cell(Assembly& assembly);

}  // namespace epafi
