/// @file new_scene.h  `epafi new KIND`: a commented scene to start from.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace epafi {

/// hopper, stack, impact, pile
const std::vector<std::string>& starter_kinds();

/// The text of a scene that reads without a problem; an unknown kind throws SceneError with the nearest.
std::string starter_scene(std::string_view kind);

}  // namespace epafi
