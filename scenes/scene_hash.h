/// @file scene_hash.h  Whether two scenes are the same run.
#pragma once
#include <string>

#include "scenes/scene.h"

namespace epafi {

/// Hash of everything that decides the run: scene text with includes, overrides, files that it names.
std::string scene_hash(const Scene& scene);

/// The hash in the files of a run is that of the scene, or was so in an older program.
bool has_hash(const Scene& scene, const std::string& hash);

}  // namespace epafi
