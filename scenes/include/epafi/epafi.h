/// @file epafi.h  The library in one header: read a scene, make it ready, step it, look at it.
///
///   auto assembly = epafi::load("stack.toml", {"params.n=20"});
///   for (int k = 0; k < 100; ++k) assembly->simulation->advance();
///   std::puts(epafi::state_hash(assembly->simulation->world).c_str());
#pragma once
#include "engine/step/simulation.h"
#include "scenes/assemble.h"
#include "scenes/carry_over.h"
#include "scenes/full_registry.h"
#include "scenes/reader/scene_reader.h"
#include "scenes/session.h"

namespace epafi {

/// Common end of load and load_text: assembles the scene and enters the simulation.
inline std::unique_ptr<Assembly> start(ReadResult read) {
  if (!read.scene) throw SceneError(read.problems);
  auto assembly = assemble(std::move(*read.scene));
  (void)enter_simulation(*assembly);
  return assembly;
}

/// A scene file made ready and started: forces, ledger and observers at time 0. Throws SceneError with every problem of
/// the file. overrides: "KEY.PATH=VALUE", as --set takes them.
inline std::unique_ptr<Assembly> load(const std::string& path, const std::vector<std::string>& overrides = {}) {
  return start(read_scene(path, overrides, full_registry()));
}

/// The same from a scene in memory; files it names are looked for beside `file`, which also names it in messages.
inline std::unique_ptr<Assembly> load_text(const std::string& scene, const std::vector<std::string>& overrides = {},
                                           const std::string& file = "scene.toml") {
  return start(read_scene_text(scene, file, overrides, full_registry()));
}

}  // namespace epafi
