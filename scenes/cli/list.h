/// @file list.h  `epafi list`: what a scene may name, from the same entries the reader uses.
#pragma once
#include <string>
#include <string_view>

#include "scenes/reader/registry.h"

namespace epafi {

/// Words for `epafi list KIND`: shapes, laws, solvers, broad_phases, schemes, measures, patch_models, scenes, pairs.
const std::vector<std::string>& list_kinds();

/// Name, one line, and each parameter with symbol, unit, default and range; of one kind, or of all where it is empty.
/// An unknown kind throws SceneError with the nearest.
std::string list_text(const Registry& registry, std::string_view kind = {});

/// "1e-6", "[0, 0, -9.81]", "auto"
std::string format_value(const Value& value);

}  // namespace epafi
