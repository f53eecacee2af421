/// @file spring_file.h  The springs of a run as tables of a scene that starts from its bodies.csv.
#pragma once
#include <filesystem>

#include "scenes/assemble.h"

namespace epafi {

/// [[spring]] tables with what each spring carries now as its preload; bodies by the names that bodies.csv gives them.
/// "" where the scene has no springs. A frame begins anew where the body is; axes along which nothing pulls any more
/// but a damper keep no preload.
std::string springs_text(const Assembly& assembly);

/// Writes springs.toml beside bodies.csv from the checkpoint of a run's folder. Returns a note for the user, "" where
/// the run has no springs.
std::string export_springs(const std::filesystem::path& folder);

}  // namespace epafi
