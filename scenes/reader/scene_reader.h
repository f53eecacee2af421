/// @file scene_reader.h  From a scene file to a validated Scene, or to every problem of the file at once.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/units/error.h"
#include "scenes/reader/registry.h"
#include "scenes/reader/stages.h"
#include "scenes/scene.h"

namespace epafi {

struct ReadResult {
  std::optional<Scene> scene;     ///< empty when there is an error
  std::vector<Problem> problems;  ///< errors and warnings in the order of the file
};

/// Which stage of a scene is read, and how a run that goes on has changed it.
struct ReadOptions {
  std::size_t stage = 0;
  std::vector<InsertedStage> inserted{};
  std::string start_run{};  ///< in place of [start] from: the run goes on in time with this scene
};

/// Reads `path` with the overrides "KEY.PATH=VALUE" on top. Never throws for what a user can do wrong.
ReadResult read_scene(const std::string& path, const std::vector<std::string>& overrides, const Registry& registry,
                      const ReadOptions& options = {});

/// The same from text; `file` names it in messages and relative paths start from its folder.
ReadResult read_scene_text(const std::string& text, const std::string& file, const std::vector<std::string>& overrides,
                           const Registry& registry, const ReadOptions& options = {});

}  // namespace epafi
