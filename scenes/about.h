/// @file about.h  What a scene says to those who draw it: names, springs, camera.
#pragma once
#include "scenes/assemble.h"
#include "viz_export/view/settings.h"

namespace epafi {

[[nodiscard]] RunAbout about_of(const Assembly& assembly);

}  // namespace epafi
