/// @file shape_text.h  A shape in the words of a scene file: its name, or the table that makes it again.
#pragma once
#include <string>

#include "scenes/scene.h"

namespace epafi {

/// "pebble", or "{ box = { size = [1, 1, 1] } }" where it was written in place.
std::string shape_text(const ShapeSpec& shape);

}  // namespace epafi
