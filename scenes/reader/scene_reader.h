/// @file scene_reader.h  From a scene file to a validated Scene, or to every problem of the file at once.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "engine/error.h"
#include "engine/registry.h"
#include "scenes/scene.h"

namespace epafi {

/// The lists of variants that a scene may name. Passed in, so that the reader knows no list of its own.
struct Registry {
  std::vector<Entry> shapes;
  std::vector<Entry> normal_laws;
  std::vector<Entry> tangential_laws;
  std::vector<Entry> rolling_laws;
  std::vector<Entry> solvers;
  std::vector<Entry> broad_phases;
  std::vector<Entry> schemes;         ///< of both methods
  std::vector<std::string> smooth_schemes;  ///< names of those that work with forces; the first is the default
  std::vector<std::string> nonsmooth_schemes;
  std::vector<Entry> measures;
};

struct ReadResult {
  std::optional<Scene> scene;      ///< empty when there is an error
  std::vector<Problem> problems;   ///< errors and warnings in the order of the file
};

/// Reads `path` with the overrides "KEY.PATH=VALUE" on top. Never throws for what a user can do wrong.
ReadResult read_scene(const std::string& path, const std::vector<std::string>& overrides, const Registry& registry);

/// The same from text; `file` names it in messages and relative paths start from its folder.
ReadResult read_scene_text(const std::string& text, const std::string& file, const std::vector<std::string>& overrides,
                           const Registry& registry);

}  // namespace epafi
